#include "command.h"

#include "progress.h"

namespace sdfgrid::cli {

void Context::print_line(const std::string& line) {
  if (json_) return;
  progress_.clear();
  std::fputs((line + "\n").c_str(), stdout);
}

void Context::warn(const std::string& text) {
  warnings_.push_back(text);
  progress_.say("warning: " + text);
}

void Stopwatch::lap(const std::string& name) {
  const auto now = Clock::now();
  const double seconds = std::chrono::duration<double>(now - last_).count();
  steps_[name] = steps_.value(name, 0.0) + seconds;
  last_ = now;
}

Json Stopwatch::seconds() const {
  Json all = steps_;
  all["total"] = std::chrono::duration<double>(Clock::now() - start_).count();
  return all;
}

}  // namespace sdfgrid::cli
