// apps/sdfgrid/interrupt.h: Ctrl-C, answered in time whatever the program is doing.
#pragma once

#include <csignal>
#include <functional>
#include <mutex>
#include <thread>

#include "sdfgrid/core/job.h"

namespace sdfgrid::cli {

// While it lives, SIGINT, SIGTERM and SIGHUP cancel a Job instead of ending the program: the
// library then unwinds at its next checkpoint. Some calls have none (a file being read or written
// by another library), so 100 ms after the first signal, or at once at the second, this ends the
// program itself, removing temporary output files. Make it before any other thread: they must
// inherit its mask.
class InterruptWatch {
 public:
  // `last_words` is called on the watch's own thread, just before it ends the program; what it does
  // must not wait for a lock that the interrupted work may hold (stdio, say).
  InterruptWatch(const Job& job, std::function<void()> last_words);
  ~InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  // From here on the program ends by itself: the watch will not. Does not return if the watch is
  // ending it already.
  void stand_down();

 private:
  void watch();
  void end_program();

  const Job& job_;
  std::function<void()> last_words_;
  sigset_t signals_{};
  std::mutex ending_;  // held by whoever ends the program
  bool stood_down_ = false;
  std::thread thread_;
};

}  // namespace sdfgrid::cli
