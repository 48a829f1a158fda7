#include "sdfgrid/core/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <thread>

namespace sdfgrid {

void parallel_for(std::size_t size, std::size_t grain, const Job& job,
                  const std::function<void(std::size_t begin, std::size_t end)>& body) {
  job.checkpoint();
  // Isolated: a thread that waits for an inner loop must not take a range of an outer one
  // meanwhile, or what the ranges hold in memory would pile up beyond one for each thread.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, size, std::max<std::size_t>(grain, 1)),
        [&](const tbb::blocked_range<std::size_t>& range) {
          job.checkpoint();
          body(range.begin(), range.end());
        },
        tbb::simple_partitioner());
  });
}

void parallel_for(std::string_view step, std::size_t size, std::size_t grain, const Job& job,
                  const std::function<void(std::size_t begin, std::size_t end)>& body) {
  std::atomic<std::size_t> done{0};
  parallel_for(size, grain, job, [&](std::size_t begin, std::size_t end) {
    body(begin, end);
    const std::size_t so_far = done += end - begin;
    job.report(step, static_cast<double>(so_far) / static_cast<double>(size));
  });
}

ThreadLimit::ThreadLimit(int threads) {
  const auto wanted = threads > 0 ? static_cast<std::size_t>(threads)
                                  : std::max(1U, std::thread::hardware_concurrency());
  control_ = new tbb::global_control(tbb::global_control::max_allowed_parallelism, wanted);
}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(control_); }

int thread_count() {
  return static_cast<int>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

}  // namespace sdfgrid
