// core/job.h: progress and cancellation of a long call. The library never prints: it reports
// fractions here and asks here whether to go on.
#pragma once

#include <atomic>
#include <functional>
#include <string_view>

namespace sdfgrid {

class Job {
 public:
  // Called from any worker thread, now and then; `fraction` in [0, 1] within the named step.
  using Progress = std::function<void(std::string_view step, double fraction)>;

  Job() = default;
  explicit Job(Progress progress) : progress_(std::move(progress)) {}

  // May be called from a signal handler.
  void cancel() const { cancelled_.store(true, std::memory_order_relaxed); }
  [[nodiscard]] bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

  // Throws Error{cancelled} once cancel() was called: inside a parallel loop this unwinds it.
  void checkpoint() const;

  void report(std::string_view step, double fraction) const {
    if (progress_) progress_(step, fraction);
  }

 private:
  Progress progress_;
  mutable std::atomic<bool> cancelled_{false};
};

}  // namespace sdfgrid
