#include "interrupt.h"

#include <pthread.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <ctime>
#include <utility>

#include "command.h"
#include "sdfgrid/core/atomic_file.h"

namespace sdfgrid::cli {
namespace {

// The promise is 250 ms; the rest is for removing files and for the kernel to take memory back.
constexpr timespec kGrace{0, 100'000'000};

// Wakes the watching thread when the work is done; no one else sends it.
constexpr int kWake = SIGUSR1;

// Those that would have ended the program: one started with SIGHUP ignored (nohup) stays deaf to
// it.
sigset_t ending_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, kWake);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    ::sigaction(signal, nullptr, &action);
    if (action.sa_handler != SIG_IGN) sigaddset(&signals, signal);
  }
  return signals;
}

}  // namespace

InterruptWatch::InterruptWatch(const Job& job, std::function<void()> last_words)
    : job_(job), last_words_(std::move(last_words)), signals_(ending_signals()) {
  ::pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  thread_ = std::thread([this] { watch(); });
}

InterruptWatch::~InterruptWatch() {
  stand_down();
  ::pthread_kill(thread_.native_handle(), kWake);
  thread_.join();
}

void InterruptWatch::stand_down() {
  const std::lock_guard lock(ending_);
  stood_down_ = true;
}

void InterruptWatch::watch() {
  int signal = kWake;
  while (signal == kWake) {
    if (::sigwait(&signals_, &signal) != 0) return;
    const std::lock_guard lock(ending_);
    if (stood_down_) return;
  }
  job_.cancel();
  ::sigtimedwait(&signals_, nullptr, &kGrace);
  end_program();
}

void InterruptWatch::end_program() {
  const std::lock_guard lock(ending_);
  if (stood_down_) return;
  remove_temporaries();
  last_words_();
  ::_exit(static_cast<int>(Exit::interrupted));
}

}  // namespace sdfgrid::cli
