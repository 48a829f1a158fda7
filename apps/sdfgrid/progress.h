// apps/sdfgrid/progress.h: what a user sees of a long call on standard error: a bar on a terminal,
// a line now and then in a log, nothing when asked to be quiet.
#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

namespace sdfgrid::cli {

class Progress {
 public:
  enum class Style { bar, lines, none };
  // The bar if standard error is a terminal that can draw it, else lines.
  [[nodiscard]] static Style style_for_stderr();

  explicit Progress(Style style) : style_(style) {}
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Called from any thread, as often as the work likes.
  void report(std::string_view step, double fraction);

  // One line on standard error, the bar out of its way; dropped if quiet.
  void say(const std::string& line);

  // Takes the bar off the terminal.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  void draw_bar(std::string_view step, int percent);
  void print_line(std::string_view step, int percent, Clock::time_point now);
  void erase_bar();

  const Style style_;
  // What lets most reports pass without the mutex: the step last shown, and when to show it again.
  std::atomic<const char*> shown_step_{nullptr};
  std::atomic<Clock::rep> next_{0};
  std::mutex mutex_;
  bool bar_drawn_ = false;
  std::map<std::string, Clock::time_point, std::less<>> last_line_;  // of each step
};

}  // namespace sdfgrid::cli
