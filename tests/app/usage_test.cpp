// What the binary answers to help, to mistakes and to no words at all.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/process.h"

namespace sdfgrid::test {
namespace {

void expect_usage(const std::vector<std::string>& words, const std::string& said) {
  const Outcome outcome = run(words);
  EXPECT_EQ(outcome.exit, 2) << outcome.error;
  EXPECT_EQ(outcome.out, "");
  EXPECT_NE(outcome.error.find(said), std::string::npos)
      << "wanted: " << said << "\nsaid: " << outcome.error;
}

TEST(Usage, NoWordsAtAll) { expect_usage({}, "sdfgrid --help"); }

TEST(Usage, AMistypedCommandIsAnsweredWithTheNearest) {
  expect_usage({"convret", "a.off"}, "did you mean 'convert'?");
  expect_usage({"rendr"}, "did you mean 'render'?");
}

TEST(Usage, AWordNearNothingIsAnsweredWithTheList) {
  const Outcome outcome = run({"xyzzyplugh"});
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_EQ(outcome.error.find("did you mean"), std::string::npos) << outcome.error;
  EXPECT_NE(outcome.error.find("convert"), std::string::npos) << outcome.error;
}

TEST(Usage, AMistypedOptionIsAnsweredWithTheNearest) {
  expect_usage({"convert", "a.off", "-o", "a.vdb", "--dmi", "64"}, "did you mean '--dim'?");
  expect_usage({"convert", "a.off", "-o", "a.vdb", "--thread=2"}, "did you mean '--threads'?");
  expect_usage({"--vrsion"}, "did you mean '--version'?");
}

// CLI11 would complain of the missing --output only, which the user thinks is there.
TEST(Usage, TheMistypedOptionIsNamedAndNotWhatFollowsFromIt) {
  expect_usage({"convert", "a.off", "--ouput", "a.vdb"}, "did you mean '--output'?");
}

TEST(Usage, AMistypedChoiceIsAnsweredWithTheNearest) {
  expect_usage({"convert", "a.off", "-o", "a.vdb", "--sign", "windign"}, "did you mean 'winding'?");
}

TEST(Usage, AMissingArgumentIsNamed) {
  expect_usage({"convert"}, "IN");
  expect_usage({"convert", "a.off"}, "--output");
}

TEST(Usage, ValuesOutOfRange) {
  expect_usage({"convert", "a.off", "-o", "a.vdb", "--dim", "0"}, "--dim");
  expect_usage({"convert", "a.off", "-o", "a.vdb", "--dim", "many"}, "--dim");
  expect_usage({"convert", "a.off", "-o", "a.vdb", "--voxel", "-1"}, "--voxel");
  expect_usage({"convert", "a.off", "-o", "a.vdb", "--threads", "-1"}, "--threads");
}

TEST(Usage, JsonAnswersMistakesToo) {
  const Outcome outcome = run({"convert", "--json", "--dmi", "3"});
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["exit"], 2);
}

TEST(Usage, HelpIsAResult) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--help"}, {"convert", "--help"}, {"render", "-h"}}) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.exit, 0);
    EXPECT_NE(outcome.out.find("Usage: sdfgrid"), std::string::npos) << outcome.out;
    EXPECT_EQ(outcome.error, "");
  }
}

TEST(Usage, EveryCommandTakesTheCommonOptions) {
  std::istringstream table(run({"--help-table"}).out);
  int commands = 0;
  for (std::string line; std::getline(table, line);) {
    if (!line.starts_with("| `")) continue;
    ++commands;
    const std::string name = line.substr(3, line.find(' ', 3) - 3);
    const std::string help = run({name, "--help"}).out;
    for (const char* option : {"--threads", "--json", "--quiet", "--help"}) {
      EXPECT_NE(help.find(option), std::string::npos) << name << ' ' << option;
    }
  }
  EXPECT_GE(commands, 3);
}

TEST(Usage, VersionNamesTheLicenceOfTheBinary) {
  const Outcome outcome = run({"--version"});
  EXPECT_EQ(outcome.exit, 0);
  EXPECT_TRUE(outcome.out.starts_with("sdfgrid ")) << outcome.out;
  EXPECT_NE(outcome.out.find("Apache-2.0"), std::string::npos) << outcome.out;
}

// The README's table stands between two markers and is the one that the binary prints.
TEST(Usage, TheReadmeHasTheBinarysTable) {
  std::ifstream in(SDFGRID_SOURCE_DIR "/README.md");
  if (!in) GTEST_SKIP() << "there is no README.md";
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::string begin = "<!-- commands -->\n";
  const std::size_t from = text.find(begin);
  const std::size_t to = text.find("<!-- /commands -->");
  ASSERT_NE(from, std::string::npos) << "README.md has no line " << begin;
  ASSERT_NE(to, std::string::npos) << "README.md has no line <!-- /commands -->";
  EXPECT_EQ(text.substr(from + begin.size(), to - from - begin.size()), run({"--help-table"}).out);
}

}  // namespace
}  // namespace sdfgrid::test
