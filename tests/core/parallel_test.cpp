// Loops over threads: every item once, progress to the end, and out at once when cancelled.
#include "sdfgrid/core/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <string>
#include <vector>

#include "sdfgrid/core/error.h"

namespace sdfgrid {
namespace {

TEST(Parallel, VisitsEveryItemOnceAndReportsItsStep) {
  std::mutex mutex;
  std::vector<double> fractions;
  const Job job([&](std::string_view step, double fraction) {
    EXPECT_EQ(step, "count");
    const std::lock_guard lock(mutex);
    fractions.push_back(fraction);
  });
  std::vector<std::atomic<int>> visits(1000);
  parallel_for("count", visits.size(), 7, job, [&](std::size_t begin, std::size_t end) {
    EXPECT_LE(end - begin, 7U);
    for (std::size_t i = begin; i < end; ++i) ++visits[i];
  });
  for (const auto& count : visits) EXPECT_EQ(count, 1);
  ASSERT_GE(fractions.size(), visits.size() / 7);
  EXPECT_EQ(*std::max_element(fractions.begin(), fractions.end()), 1.0);
  for (const double fraction : fractions) EXPECT_GT(fraction, 0.0);
}

TEST(Parallel, StopsWhenItIsCancelled) {
  const Job job;
  std::atomic<std::size_t> done{0};
  const auto run = [&] {
    parallel_for(100000, 1, job, [&](std::size_t, std::size_t) {
      if (++done == 10) job.cancel();
    });
  };
  EXPECT_THROW(run(), Error);
  EXPECT_LT(done, 100000U);
}

}  // namespace
}  // namespace sdfgrid
