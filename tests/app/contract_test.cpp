// Exit codes, streams and output files of a subcommand, as other people's scripts rely on them.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "app/process.h"

namespace sdfgrid::test {
namespace {

using nlohmann::json;
using Names = std::vector<std::string>;

std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

class Contract : public ::testing::Test {
 protected:
  Folder folder_;
  std::string cube_ = folder_.write("cube.off", cube_off());
  std::string grid_ = folder_.path("cube.vdb");
};

TEST_F(Contract, ConvertsAndSaysSo) {
  const Outcome outcome = run({"convert", cube_, "-o", grid_, "--dim", "32"});
  EXPECT_EQ(outcome.exit, 0) << outcome.error;
  EXPECT_NE(outcome.out.find(grid_), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.error.find("voxelize"), std::string::npos) << "progress: " << outcome.error;
  EXPECT_EQ(folder_.files(), (Names{"cube.off", "cube.vdb"}));
}

TEST_F(Contract, JsonIsOneObjectAndNothingElse) {
  const Outcome outcome = run({"convert", cube_, "-o", grid_, "--dim", "32", "--json", "--quiet"});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  EXPECT_EQ(outcome.error, "");
  EXPECT_EQ(lines(outcome.out), 1U) << outcome.out;
  const json result = json::parse(outcome.out);
  for (const char* key : {"method", "sign", "voxel", "dims", "active_voxels", "bricks", "bytes",
                          "seconds", "warnings"}) {
    EXPECT_TRUE(result.contains(key)) << key;
  }
  for (const char* key : {"read", "voxelize", "transform", "write", "total"}) {
    EXPECT_TRUE(result["seconds"].contains(key)) << key;
  }
  EXPECT_EQ(result["method"], "exact");
  EXPECT_NEAR(result["voxel"].get<double>(), 1.0 / 32, 1e-12);
}

TEST_F(Contract, QuietLeavesOnlyTheResult) {
  const Outcome outcome = run({"convert", cube_, "-o", grid_, "--dim", "32", "--quiet"});
  EXPECT_EQ(outcome.exit, 0);
  EXPECT_EQ(outcome.error, "");
  EXPECT_NE(outcome.out, "");
}

TEST_F(Contract, MissingInputIsRefused) {
  const std::string missing = folder_.path("missing.off");
  const Outcome outcome = run({"convert", missing, "-o", grid_, "--json"});
  EXPECT_EQ(outcome.exit, 4);
  EXPECT_NE(outcome.error.find("error: " + missing), std::string::npos) << outcome.error;
  const json result = json::parse(outcome.out);
  EXPECT_EQ(result["exit"], 4);
  EXPECT_NE(result["error"].get<std::string>().find(missing), std::string::npos);
  EXPECT_EQ(folder_.files(), Names{"cube.off"});
}

TEST_F(Contract, MalformedInputIsRefusedAndLeavesNoFile) {
  const std::string broken = folder_.write("broken.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n");
  const Outcome outcome = run({"convert", broken, "-o", grid_});
  EXPECT_EQ(outcome.exit, 4);
  EXPECT_NE(outcome.error.find(broken), std::string::npos) << outcome.error;
  EXPECT_EQ(folder_.files(), (Names{"broken.off", "cube.off"}));
}

TEST_F(Contract, ExistingOutputNeedsForce) {
  std::ofstream(grid_) << "precious";
  const Outcome refused = run({"convert", cube_, "-o", grid_, "--dim", "32"});
  EXPECT_EQ(refused.exit, 2);
  EXPECT_NE(refused.error.find("--force"), std::string::npos) << refused.error;
  EXPECT_EQ(read_file(grid_), "precious");
  EXPECT_EQ(run({"convert", cube_, "-o", grid_, "--dim", "32", "--force"}).exit, 0);
  EXPECT_NE(read_file(grid_), "precious");
}

TEST_F(Contract, AnOutputThatIsNoPlainFileIsRefusedEvenByForce) {
  const std::string pipe = folder_.path("pipe.vdb");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(run({"convert", cube_, "-o", pipe, "--dim", "8", "--force"}).exit, 2);
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

// Who keeps results on another disk by a link means the file there.
TEST_F(Contract, ForceWritesThroughALinkAndKeepsPermissions) {
  namespace fs = std::filesystem;
  fs::create_directory(folder_.path("disk"));
  const std::string real = folder_.path("disk/real.vdb");
  std::ofstream(real) << "precious";
  fs::permissions(real, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("disk/real.vdb", grid_);
  const std::vector<std::string> convert = {"convert", cube_, "-o", grid_, "--dim", "8"};
  EXPECT_EQ(run(convert).exit, 2);
  EXPECT_EQ(read_file(real), "precious");
  std::vector<std::string> forced = convert;
  forced.push_back("--force");
  ASSERT_EQ(run(forced).exit, 0);
  EXPECT_TRUE(fs::is_symlink(grid_));
  EXPECT_GT(fs::file_size(real), 1000U);
  EXPECT_EQ(fs::status(real).permissions(), fs::perms::owner_read | fs::perms::owner_write);

  fs::remove(real);  // a link that leads nowhere exists, too
  EXPECT_EQ(run(convert).exit, 2);
  EXPECT_FALSE(fs::exists(real));
  ASSERT_EQ(run(forced).exit, 0);
  EXPECT_TRUE(fs::is_symlink(grid_));
  EXPECT_TRUE(fs::exists(real));

  fs::remove(grid_);
  fs::create_symlink("cube.vdb", grid_);  // itself
  EXPECT_EQ(run(forced).exit, 1);
}

// What would have no effect is a mistake of the caller's, named.
TEST_F(Contract, OptionsWithoutEffectAreRefused) {
  const std::string scene =
      folder_.write("s.yaml", "sdfgrid: 1\nscene:\n  - sphere: {radius: 1}\n");
  ASSERT_EQ(run({"convert", cube_, "-o", grid_, "--dim", "8"}).exit, 0);
  const std::string out = folder_.path("out.vdb");
  const std::string npy = folder_.path("out.npy");
  const std::string png = folder_.path("out.png");
  const std::vector<std::vector<std::string>> calls = {
      {"convert", scene, "-o", out, "--dim", "8", "--method", "fmm"},
      {"convert", scene, "-o", out, "--dim", "8", "--sign", "winding"},
      {"convert", scene, "-o", out, "--dim", "8", "--iso", "1"},
      {"convert", cube_, "-o", out, "--dim", "8", "--iso", "1"},
      {"convert", cube_, "-o", out, "--dim", "8", "--below"},
      {"convert", cube_, "-o", out, "--dim", "8", "--largest"},
      {"convert", cube_, "-o", out, "--dim", "8", "--spacing", "1,1,1"},
      {"convert", cube_, "-o", out, "--dim", "8", "--raw-dims", "2,2,2"},
      {"convert", cube_, "-o", out, "--dim", "8", "--time", "1"},
      {"convert", cube_, "-o", out, "--tolerance", "0.1", "--method", "fmm"},
      {"compare", grid_, cube_, "--iso", "1"},
      {"compare", grid_, grid_, "--largest"},
      {"render", grid_, "-o", png, "--size", "8x8", "--dim", "64"},
      {"render", scene, "-o", png, "--size", "8x8", "--below"},
      {"sample", cube_, "-o", npy, "--random", "9", "--time", "1"},
      {"sample", cube_, "-o", npy, "--points", cube_, "--near-surface"},
      {"info", cube_, "--spacing", "1,1,1"},
  };
  for (const std::vector<std::string>& call : calls) {
    const Outcome outcome = run(call);
    std::string named = call.back().starts_with("--") ? call.back() : call[call.size() - 2];
    EXPECT_EQ(outcome.exit, 2) << call[0] << ' ' << named;
    EXPECT_NE(outcome.error.find(named), std::string::npos) << outcome.error;
  }
  EXPECT_EQ(folder_.files(), (Names{"cube.off", "cube.vdb", "s.yaml"}));
}

// A .vdb holds no voxels below 1.45e-5 units; other files do.
TEST_F(Contract, TinyVoxelsAreRefusedWhereTheOutputCannotHoldThem) {
  const std::string tiny = folder_.write("tiny.off",
                                         "OFF\n4 4 0\n0 0 0\n1e-6 0 0\n0 1e-6 0\n0 0 1e-6\n"
                                         "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
  EXPECT_EQ(run({"convert", tiny, "-o", grid_, "--dim", "8"}).exit, 2);
  EXPECT_EQ(run({"convert", tiny, "-o", folder_.path("t.nrrd"), "--dim", "8"}).exit, 0);
  EXPECT_EQ(run({"convert", tiny, "-o", folder_.path("t.npy"), "--dim", "8"}).exit, 0);
  const Outcome search = run({"convert", tiny, "-o", grid_, "--tolerance", "5%"});
  EXPECT_EQ(search.exit, 2);
  EXPECT_EQ(search.error.find("voxelize"), std::string::npos) << "before any work";
}

TEST_F(Contract, MissingFolderIsFoundBeforeAnyWork) {
  const Outcome outcome = run({"convert", cube_, "-o", folder_.path("no/where.vdb")});
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.error.find("create it first"), std::string::npos) << outcome.error;
  EXPECT_EQ(outcome.error.find("voxelize"), std::string::npos) << outcome.error;
}

// Not even root can make a file in /proc.
TEST_F(Contract, AFolderThatCannotBeWrittenFails) {
  const Outcome outcome = run({"convert", cube_, "-o", "/proc/cube.vdb", "--dim", "8"});
  EXPECT_EQ(outcome.exit, 1) << outcome.error;
  EXPECT_NE(outcome.error.find("/proc/cube.vdb"), std::string::npos) << outcome.error;
}

TEST_F(Contract, WrongExtensionIsUsage) {
  const Outcome outcome = run({"convert", cube_, "-o", folder_.path("cube.vbd")});
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.error.find(".vdb"), std::string::npos) << outcome.error;
}

TEST_F(Contract, MissedToleranceIsThree) {
  ASSERT_EQ(run({"convert", cube_, "-o", grid_, "--dim", "32"}).exit, 0);
  const Outcome within = run({"compare", grid_, cube_, "--samples", "1000", "--tolerance", "1"});
  EXPECT_EQ(within.exit, 0) << within.error;
  const Outcome missed =
      run({"compare", grid_, cube_, "--samples", "1000", "--tolerance", "1e-12", "--json"});
  EXPECT_EQ(missed.exit, 3) << missed.error;
  EXPECT_GT(json::parse(missed.out)["max_error"].get<double>(), 1e-12);
}

TEST_F(Contract, ThreadsDoNotChangeTheFile) {
  const std::string other = folder_.path("other.vdb");
  ASSERT_EQ(run({"convert", cube_, "-o", grid_, "--dim", "64", "--threads", "1"}).exit, 0);
  ASSERT_EQ(run({"convert", cube_, "-o", other, "--dim", "64", "--threads", "3"}).exit, 0);
  EXPECT_EQ(read_file(grid_), read_file(other));
}

TEST_F(Contract, AReaderThatLeavesDoesNotStopTheWork) {
  const std::string command =
      std::string(SDFGRID_BINARY) + " convert " + cube_ + " -o " + grid_ + " --dim 32 2>&1 | true";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(run({"compare", grid_, cube_, "--samples", "100"}).exit, 0);
}

TEST_F(Contract, AFullDiskUnderTheResultIsAFailure) {
  const std::string command = std::string(SDFGRID_BINARY) + " convert " + cube_ + " -o " + grid_ +
                              " --dim 32 --quiet >/dev/full";
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
}

// A limit on the size of files stands for a disk that fills up in the middle of one: every library
// that writes a file must notice, and nothing may be left of it.
TEST_F(Contract, AFullDiskUnderTheOutputIsAFailureAndLeavesNoFile) {
  const std::string binary = SDFGRID_BINARY;
  ASSERT_EQ(run({"convert", cube_, "-o", grid_, "--dim", "64"}).exit, 0);
  const std::string before = read_file(grid_);
  const std::vector<std::string> commands = {
      "convert " + cube_ + " -o " + grid_ + " --dim 200 --force",
      "render " + grid_ + " -o " + folder_.path("cube.png") + " --size 500x500",
      "render " + grid_ + " -o " + folder_.path("cube.exr") + " --size 500x500"};
  const std::vector<std::string> files = folder_.files();
  for (const std::string& command : commands) {
    const int status = std::system(
        ("ulimit -f 40; " + binary + " " + command + " --quiet >/dev/null 2>&1").c_str());
    ASSERT_TRUE(WIFEXITED(status)) << command;
    EXPECT_EQ(WEXITSTATUS(status), 1) << command;
    EXPECT_EQ(folder_.files(), files) << command;
  }
  EXPECT_EQ(read_file(grid_), before);
}

}  // namespace
}  // namespace sdfgrid::test
