#include "sdfgrid/progress.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>
#include <vector>

namespace sdfgrid::cli {
namespace {

using Style = Progress::Style;

// What standard error gets while `use` has a Progress of this style.
template <class Use>
std::string shown(Style style, Use use) {
  ::testing::internal::CaptureStderr();
  {
    Progress progress(style);
    use(progress);
  }
  return ::testing::internal::GetCapturedStderr();
}

TEST(Progress, ALineForEachStepAndThenOneASecond) {
  EXPECT_EQ(shown(Style::lines,
                  [](Progress& progress) {
                    for (int i = 0; i < 1000; ++i) {
                      progress.report("read", 0.0);
                      progress.report("write", 0.5);
                    }
                  }),
            "read 0 %\nwrite 50 %\n");
}

TEST(Progress, LinesGoOnAfterASecond) {
  EXPECT_EQ(shown(Style::lines,
                  [](Progress& progress) {
                    progress.report("read", 0.25);
                    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
                    progress.report("read", 0.75);
                  }),
            "read 25 %\nread 75 %\n");
}

TEST(Progress, TheBarIsTakenAwayForALineAndAtTheEnd) {
  const std::string text = shown(Style::bar, [](Progress& progress) {
    progress.report("read", 0.5);
    progress.say("warning: so-so");
  });
  EXPECT_EQ(text, "\r[################                ]  50 % read\x1b[K\r\x1b[Kwarning: so-so\n");
  EXPECT_TRUE(shown(Style::bar, [](Progress& progress) {
                progress.report("read", 1.5);
              }).ends_with("] 100 % read\x1b[K\r\x1b[K"));
}

TEST(Progress, QuietIsQuiet) {
  EXPECT_EQ(shown(Style::none,
                  [](Progress& progress) {
                    progress.report("read", 0.5);
                    progress.say("warning: so-so");
                  }),
            "");
}

TEST(Progress, ThreadsDoNotTearLines) {
  const std::string text = shown(Style::lines, [](Progress& progress) {
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&] {
        for (int i = 0; i < 1000; ++i) progress.report("work", 0.5);
      });
    }
    for (std::thread& thread : threads) thread.join();
  });
  EXPECT_EQ(text, "work 50 %\n");
}

}  // namespace
}  // namespace sdfgrid::cli
