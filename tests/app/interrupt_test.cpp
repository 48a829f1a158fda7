// Ctrl-C: the program ends with 130 in time, and no file is left or changed.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/process.h"

namespace sdfgrid::test {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using Names = std::vector<std::string>;

// What the program promises, and what a busy machine may add before it lets either of us run.
constexpr milliseconds kPromise(250);
constexpr milliseconds kScheduling(1500);

bool wait_for(const std::function<bool()>& condition) {
  const auto give_up = Clock::now() + std::chrono::seconds(60);
  while (!condition()) {
    if (Clock::now() > give_up) return false;
    std::this_thread::sleep_for(milliseconds(2));
  }
  return true;
}

class Interrupt : public ::testing::Test {
 protected:
  // A conversion of seconds, in the middle of which we are sure to be when it says so.
  std::vector<std::string> long_conversion() {
    return {"convert", cube_, "-o", grid_, "--dim", "1000", "--force", "--json", "--threads", "1"};
  }
  static bool voxelizes(const Process& process) {
    return process.error_so_far().find("voxelize") != std::string::npos;
  }
  bool writes() const {
    for (const std::string& name : folder_.files()) {
      if (name.find("partial") != std::string::npos) return true;
    }
    return false;
  }
  void expect_interrupted(Process& process, Clock::time_point sent) {
    const Outcome outcome = process.wait();
    EXPECT_LT(Clock::now() - sent, kPromise + kScheduling);
    EXPECT_EQ(outcome.exit, 130) << outcome.error;
    EXPECT_NE(outcome.error.find("interrupted"), std::string::npos) << outcome.error;
    EXPECT_EQ(nlohmann::json::parse(outcome.out)["exit"], 130) << outcome.out;
    EXPECT_EQ(folder_.files(), expected_files_);
  }

  Folder folder_;
  std::string cube_ = folder_.write("cube.off", cube_off());
  std::string grid_ = folder_.path("cube.vdb");
  Names expected_files_ = {"cube.off"};
};

TEST_F(Interrupt, WhileItComputes) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    Process process(long_conversion());
    ASSERT_TRUE(wait_for([&] { return voxelizes(process); }));
    const auto sent = Clock::now();
    process.send(signal);
    expect_interrupted(process, sent);
  }
}

// OpenVDB writes without asking whether to go on: the program ends over its head.
TEST_F(Interrupt, WhileItWrites) {
  Process process(long_conversion());
  ASSERT_TRUE(wait_for([&] { return writes(); }));
  const auto sent = Clock::now();
  process.send(SIGINT);
  expect_interrupted(process, sent);
}

TEST_F(Interrupt, LeavesAnOlderFileAsItWas) {
  std::ofstream(grid_) << "precious";
  expected_files_ = {"cube.off", "cube.vdb"};
  Process process(long_conversion());
  ASSERT_TRUE(wait_for([&] { return writes(); }));
  const auto sent = Clock::now();
  process.send(SIGINT);
  expect_interrupted(process, sent);
  std::ifstream in(grid_);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "precious");
}

TEST_F(Interrupt, TwiceEndsItAtOnce) {
  Process process(long_conversion());
  ASSERT_TRUE(wait_for([&] { return writes(); }));
  const auto sent = Clock::now();
  process.send(SIGINT);
  std::this_thread::sleep_for(milliseconds(10));
  process.send(SIGINT);
  expect_interrupted(process, sent);
}

}  // namespace
}  // namespace sdfgrid::test
