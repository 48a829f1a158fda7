#include "progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace sdfgrid::cli {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kBarInterval(100);
constexpr milliseconds kLineInterval(1000);
constexpr int kBarWidth = 32;

void write_stderr(const std::string& text) {
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace

Progress::Style Progress::style_for_stderr() {
  const char* terminal = std::getenv("TERM");
  const bool can_draw = terminal != nullptr && std::string_view(terminal) != "dumb";
  return ::isatty(STDERR_FILENO) == 1 && can_draw ? Style::bar : Style::lines;
}

void Progress::report(std::string_view step, double fraction) {
  if (style_ == Style::none) return;
  const auto now = Clock::now();
  const bool due = now.time_since_epoch().count() >= next_.load(std::memory_order_relaxed);
  const bool new_step = shown_step_.load(std::memory_order_relaxed) != step.data();
  if (!due && !new_step) return;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) return;  // another thread is showing something: this report is not missed
  shown_step_.store(step.data(), std::memory_order_relaxed);
  const auto interval = style_ == Style::bar ? kBarInterval : kLineInterval;
  next_.store((now + interval).time_since_epoch().count(), std::memory_order_relaxed);
  const int percent = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * 100.0);
  if (style_ == Style::bar) {
    draw_bar(step, percent);
  } else {
    print_line(step, percent, now);
  }
}

void Progress::draw_bar(std::string_view step, int percent) {
  const auto filled = static_cast<std::size_t>(percent * kBarWidth / 100);
  const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, ' ');
  write_stderr(fmt::format("\r[{}] {:3} % {}\x1b[K", bar, percent, step));
  bar_drawn_ = true;
}

void Progress::print_line(std::string_view step, int percent, Clock::time_point now) {
  const auto last = last_line_.find(step);
  // Steps may take turns: each is held to its own interval.
  if (last != last_line_.end() && now - last->second < kLineInterval) return;
  last_line_.insert_or_assign(std::string(step), now);
  write_stderr(fmt::format("{} {} %\n", step, percent));
}

void Progress::erase_bar() {
  if (bar_drawn_) write_stderr("\r\x1b[K");
  bar_drawn_ = false;
}

void Progress::say(const std::string& line) {
  if (style_ == Style::none) return;
  const std::lock_guard lock(mutex_);
  erase_bar();
  write_stderr(line + "\n");
}

void Progress::clear() {
  const std::lock_guard lock(mutex_);
  erase_bar();
}

}  // namespace sdfgrid::cli
