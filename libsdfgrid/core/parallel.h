// core/parallel.h: the only door to threads. TBB stands behind it, in parallel.cpp alone, so that
// nothing else in the project knows which scheduler runs it.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "sdfgrid/core/job.h"

namespace sdfgrid {

// Runs body(begin, end) over disjoint ranges that cover [0, size), at most `grain` items each
// (grain >= 1), on the current thread limit. Checks `job` before every range: once it is cancelled,
// or a body throws, no further range starts and the exception leaves this call. May be nested.
// Which thread takes which range is not defined: a body that writes only to its own items gives the
// same result at any number of threads.
void parallel_for(std::size_t size, std::size_t grain, const Job& job,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

// The same, and reports after each range how much is done of the step that `step` names (a literal:
// who shows progress keeps the pointer).
void parallel_for(std::string_view step, std::size_t size, std::size_t grain, const Job& job,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

// Holds the number of threads that parallel_for uses while it lives; 0 means all cores.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  void* control_;
};

// The number of threads that parallel_for uses now.
[[nodiscard]] int thread_count();

}  // namespace sdfgrid
