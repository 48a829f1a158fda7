// sdfgrid sculpt as a user's script calls it: DESIGN's keys and exit codes, sessions over several
// runs.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "app/process.h"

namespace sdfgrid::test {
namespace {

using nlohmann::json;

class SculptApp : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run({"convert", cube_, "-o", grid_, "--dim", "32", "--quiet"}).exit, 0);
  }
  Folder folder_;
  std::string cube_ = folder_.write("cube.off", cube_off());
  std::string grid_ = folder_.path("cube.vdb");
  std::string out_ = folder_.path("carved.vdb");
  std::string strokes_ = folder_.write(
      "strokes.yaml",
      "sdfgrid-strokes: 1\n"
      "strokes:\n"
      "  - {op: difference, brush: {sphere: {radius: 0.2}}, path: [[0, 0, 1], [1, 1, 1]]}\n"
      "  - {op: union, brush: {box: {size: [0.2, 0.2, 0.2]}}, path: [[0.5, 0.5, 0]]}\n");
};

TEST_F(SculptApp, SaysWhatItDid) {
  const Outcome outcome = run({"sculpt", grid_, "--strokes", strokes_, "-o", out_, "--json"});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  const json result = json::parse(outcome.out);
  EXPECT_EQ(result["strokes"], 2);
  EXPECT_GT(result["dabs"], 2);
  EXPECT_GT(result["bricks_touched"], 0);
  EXPECT_GT(result["dabs_per_second"], 0.0);
  for (const char* step : {"load", "edit", "write", "total"}) {
    EXPECT_TRUE(result["seconds"].contains(step)) << step;
  }
  // What was cut away is away: the carved cube is not the cube.
  EXPECT_EQ(run({"compare", out_, cube_, "--tolerance", "0.02", "--quiet"}).exit, 3);
  EXPECT_EQ(run({"sculpt", grid_, "--strokes", strokes_, "-o", out_}).exit, 2);  // needs --force
}

TEST_F(SculptApp, RefusesAStrokeFileWithItsPlace) {
  const std::string bad = folder_.write("bad.yaml",
                                        "sdfgrid-strokes: 1\nstrokes:\n  - {op: unoin, brush: "
                                        "{sphere: {radius: 0.2}}, path: [[0, 0, 1]]}\n");
  const Outcome outcome = run({"sculpt", grid_, "--strokes", bad, "-o", out_});
  EXPECT_EQ(outcome.exit, 4) << outcome.error;
  EXPECT_NE(outcome.error.find("bad.yaml"), std::string::npos) << outcome.error;
  EXPECT_NE(outcome.error.find('3'), std::string::npos) << outcome.error;
  EXPECT_NE(outcome.error.find("union"), std::string::npos) << outcome.error;
}

TEST_F(SculptApp, UndoneStrokesLeaveTheGridThatWas) {
  const std::string session = folder_.path("session");
  ASSERT_EQ(run({"sculpt", grid_, "--strokes", strokes_, "--session", session}).exit, 0);
  ASSERT_EQ(run({"sculpt", "--session", session, "--undo", "2"}).exit, 0);
  ASSERT_EQ(run({"sculpt", "--session", session, "--export", out_}).exit, 0);
  EXPECT_EQ(run({"compare", out_, grid_, "--tolerance", "0", "--quiet"}).exit, 0);
  ASSERT_EQ(run({"sculpt", "--session", session, "--redo", "2"}).exit, 0);
  ASSERT_EQ(run({"sculpt", "--session", session, "--export", out_, "--force"}).exit, 0);
  EXPECT_EQ(run({"compare", out_, grid_, "--tolerance", "0.02", "--quiet"}).exit, 3);
}

TEST_F(SculptApp, UndoTakesCountsOfOneAndMore) {
  const std::string session = folder_.path("session");
  ASSERT_EQ(run({"sculpt", grid_, "--strokes", strokes_, "--session", session}).exit, 0);
  for (const std::string option : {"--undo", "--redo"}) {
    for (const char* wrong : {"-1", "0", "1.5", "two", "-18446744073709551615"}) {
      const Outcome refused = run({"sculpt", "--session", session, option, wrong});
      EXPECT_EQ(refused.exit, 2) << option << " " << wrong;
      EXPECT_NE(refused.error.find(option), std::string::npos) << refused.error;
    }
  }
  const Outcome log = run({"sculpt", "--session", session, "--log", "--json"});
  EXPECT_EQ(json::parse(log.out)["standing"], 2) << log.error;
}

// Whoever comes first makes the session; the other one must not write over it.
TEST_F(SculptApp, OneOfTwoProcessesMakesTheSession) {
  for (int round = 0; round < 4; ++round) {
    const std::string session = folder_.path("session" + std::to_string(round));
    const std::vector<std::string> words = {"sculpt",    grid_,   "--strokes", strokes_,
                                            "--session", session, "--quiet"};
    Process a(words);
    Process b(words);
    const Outcome of_a = a.wait();
    const Outcome of_b = b.wait();
    EXPECT_NE(of_a.exit == 0, of_b.exit == 0) << of_a.error << of_b.error;
    const Outcome& refused = of_a.exit == 0 ? of_b : of_a;
    EXPECT_TRUE(refused.exit == 1 || refused.exit == 2) << refused.exit;
    EXPECT_NE(refused.error.find("session"), std::string::npos) << refused.error;
    const Outcome log = run({"sculpt", "--session", session, "--log", "--json"});
    EXPECT_EQ(json::parse(log.out)["standing"], 2) << log.error;
  }
}

TEST_F(SculptApp, WritesNoOutputIntoTheSession) {
  namespace fs = std::filesystem;
  const std::string session = folder_.path("session");
  ASSERT_EQ(run({"sculpt", grid_, "--strokes", strokes_, "--session", session}).exit, 0);
  fs::create_directory(folder_.path("other"));
  fs::create_directory_symlink(session, folder_.path("other/link"));
  fs::create_symlink(session + "/base.vdb", folder_.path("file.vdb"));
  for (const std::string& out :
       {session + "/base.vdb", session + "/new.vdb", session + "/stamps/../new.vdb",
        folder_.path("other/link/base.vdb"), folder_.path("other/../session/base.vdb"),
        folder_.path("file.vdb")}) {
    for (const char* option : {"--export", "-o"}) {
      const Outcome refused = run({"sculpt", "--session", session, option, out, "--force"});
      EXPECT_EQ(refused.exit, 2) << out << refused.error;
      EXPECT_NE(refused.error.find("for the session alone"), std::string::npos) << refused.error;
    }
  }
  EXPECT_EQ(run({"sculpt", "--session", session, "--export", folder_.path("other/a.vdb")}).exit, 0);
}

TEST_F(SculptApp, AFirstStrokeThatIsRefusedMakesNoSession) {
  const std::string session = folder_.path("session");
  const std::string bad =
      folder_.write("bad.yaml",
                    "sdfgrid-strokes: 1\nstrokes:\n"
                    "  - {op: flatten, brush: {sphere: {radius: 0.1}}, path: [[0, 0, 9]]}\n");
  const Outcome refused = run({"sculpt", grid_, "--strokes", bad, "--session", session});
  EXPECT_EQ(refused.exit, 4) << refused.error;
  EXPECT_NE(refused.error.find("bad.yaml: line 3: stroke 1"), std::string::npos) << refused.error;
  EXPECT_FALSE(std::filesystem::exists(session));
  EXPECT_EQ(run({"sculpt", grid_, "--strokes", strokes_, "--session", session}).exit, 0);
}

TEST_F(SculptApp, SaysHowManyStrokesWereUndone) {
  const std::string session = folder_.path("session");
  ASSERT_EQ(run({"sculpt", grid_, "--strokes", strokes_, "--session", session}).exit, 0);
  const auto change = [&](const std::string& option, const std::string& count, const char* key) {
    const Outcome outcome = run({"sculpt", "--session", session, option, count, "--json"});
    EXPECT_EQ(outcome.exit, 0) << outcome.error;
    const json result = json::parse(outcome.out);
    for (const char* step : {"load", "edit", "write", "total"}) {
      EXPECT_TRUE(result["seconds"].contains(step)) << step;
    }
    return std::make_pair(result[key].get<int>(), result["warnings"].dump());
  };
  EXPECT_EQ(change("--undo", "1", "undone"), std::make_pair(1, std::string("[]")));
  const auto [undone, only] = change("--undo", "100", "undone");
  EXPECT_EQ(undone, 1);
  EXPECT_NE(only.find("only 1 of 100 strokes was undone"), std::string::npos) << only;
  const auto [more, nothing] = change("--undo", "1", "undone");
  EXPECT_EQ(more, 0);
  EXPECT_NE(nothing.find("no stroke to be undone"), std::string::npos) << nothing;
  EXPECT_EQ(change("--redo", "5", "redone").first, 2);
  const Outcome said = run({"sculpt", "--session", session, "--undo", "7"});
  EXPECT_NE(said.out.find("2 of 7 strokes undone"), std::string::npos) << said.out;
}

TEST_F(SculptApp, ASessionKeepsItsRedistance) {
  const std::string session = folder_.path("session");
  ASSERT_EQ(run({"sculpt", grid_, "--strokes", strokes_, "--session", session}).exit, 0);
  const Outcome refused =
      run({"sculpt", "--session", session, "--strokes", strokes_, "--redistance", "off"});
  EXPECT_EQ(refused.exit, 2) << refused.error;
  EXPECT_NE(refused.error.find("--redistance local"), std::string::npos) << refused.error;
  const Outcome same = run({"sculpt", "--session", session, "--log", "--redistance", "local"});
  EXPECT_EQ(same.exit, 0) << same.error;
}

// Damage and newer versions are bad inputs, with the record's number; looking changes nothing.
TEST_F(SculptApp, ADamagedSessionIsRefusedAndLeftAsItIs) {
  const std::string session = folder_.path("session");
  ASSERT_EQ(run({"sculpt", grid_, "--strokes", strokes_, "--session", session}).exit, 0);
  std::ifstream in(session + "/journal", std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(in), {});
  bytes[bytes.size() - 5] ^= 1;
  std::ofstream(session + "/journal", std::ios::binary) << bytes;
  for (const char* option : {"--log", "--resume"}) {
    const Outcome refused = run({"sculpt", "--session", session, option});
    EXPECT_EQ(refused.exit, 4) << refused.error;
    EXPECT_NE(refused.error.find("record 2"), std::string::npos) << refused.error;
  }
  std::ifstream again(session + "/journal", std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(again), {}), bytes);
  const Outcome saved = run({"sculpt", "--session", session, "--resume", "--salvage", "--json"});
  EXPECT_EQ(saved.exit, 0) << saved.error;
  EXPECT_EQ(json::parse(saved.out)["standing"], 1);
}

// Whatever stands before: of a second file, too, what was done before a crash is not done again.
TEST_F(SculptApp, ResumeLeavesOutWhatTheSessionEndsWith) {
  const std::string session = folder_.path("session");
  const auto stroke = [](double x) {
    return "  - {op: difference, brush: {sphere: {radius: 0.1}}, path: [[" + std::to_string(x) +
           ", 0, 1]]}\n";
  };
  const auto write_strokes = [&](const std::vector<double>& places) {
    std::string text = "sdfgrid-strokes: 1\nstrokes:\n";
    for (const double x : places) text += stroke(x);
    return folder_.write("more.yaml", text);
  };
  const auto resume = [&](const std::vector<double>& places) {
    const Outcome outcome = run({"sculpt", "--session", session, "--resume", "--strokes",
                                 write_strokes(places), "--json", "--quiet"});
    EXPECT_EQ(outcome.exit, 0) << outcome.error;
    return json::parse(outcome.out);
  };
  const auto expect = [](const json& result, int left_out, int done, int standing) {
    EXPECT_EQ(result["left_out"], left_out);
    EXPECT_EQ(result["strokes"], done);
    EXPECT_EQ(result["standing"], standing);
  };
  ASSERT_EQ(run({"sculpt", grid_, "--strokes", strokes_, "--session", session}).exit, 0);
  expect(resume({0.1, 0.2}), 0, 2, 4);             // none of the second file yet
  expect(resume({0.1, 0.2}), 2, 0, 4);             // all of it
  expect(resume({0.1, 0.2, 0.3}), 2, 1, 5);        // its beginning
  expect(resume({0.2, 0.1}), 0, 2, 7);             // another order
  expect(resume({0.1, 0.2, 0.1, 0.4}), 1, 3, 10);  // ... 0.2 0.1: only 0.1 is its first
  expect(resume({0.4, 0.4, 0.5}), 1, 2, 12);       // a stroke that is there twice
  ASSERT_EQ(run({"sculpt", "--session", session, "--undo", "1"}).exit, 0);
  expect(resume({0.4, 0.4, 0.5}), 2, 1, 12);  // what was undone does not stand
}

// Of many strokes it says how far it is, and goes on upwards.
TEST_F(SculptApp, ShowsProgressOverManyStrokes) {
  std::string text = "sdfgrid-strokes: 1\nstrokes:\n";
  for (int i = 0; i < 500; ++i) {
    text += "  - {op: difference, brush: {sphere: {radius: 0.05}}, path: [[" +
            std::to_string(0.002 * i) + ", 0.3, 1]]}\n";
  }
  const std::string many = folder_.write("many.yaml", text);
  const Outcome outcome = run({"sculpt", grid_, "--strokes", many, "-o", out_});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  double last = -1;
  int lines = 0;
  for (std::size_t at = outcome.error.find("sculpt "); at != std::string::npos;
       at = outcome.error.find("sculpt ", at + 1)) {
    const double percent = std::stod(outcome.error.substr(at + 7));
    EXPECT_GE(percent, last);
    last = percent;
    ++lines;
  }
  EXPECT_GT(lines, 0) << outcome.error;
}

TEST_F(SculptApp, StampsAndPaintReachTheFile) {
  const std::string dots = folder_.write(
      "dots.yaml",
      "sdfgrid-strokes: 1\nstrokes:\n"
      "  - {op: stamp, brush: {scale: {by: 0.3, of: {grid: {file: cube.vdb}}}}, path: [[0.9, 0.9, "
      "0.9]]}\n"
      "  - {op: paint, material: 3, brush: {sphere: {radius: 0.3}}, path: [[0, 0, 0]]}\n");
  const std::string session = folder_.path("session");
  ASSERT_EQ(run({"sculpt", grid_, "--strokes", dots, "--session", session}).exit, 0);
  // Begun again with the same file, there is nothing left to do.
  const Outcome again = run(
      {"sculpt", "--session", session, "--resume", "--strokes", dots, "--export", out_, "--json"});
  ASSERT_EQ(again.exit, 0) << again.error;
  EXPECT_EQ(json::parse(again.out)["strokes"], 0);
  EXPECT_EQ(json::parse(again.out)["standing"], 2);
  const json info = json::parse(run({"info", out_, "--json"}).out);
  EXPECT_GT(info["paint"]["3"], 100);
  EXPECT_GT(info["bounds"][1][0], 1.1);  // the small cube on the corner
  const Outcome dense = run({"convert", out_, "-o", folder_.path("dense.npy")});
  EXPECT_EQ(dense.exit, 0);
  EXPECT_NE(dense.error.find("holds no paint"), std::string::npos) << dense.error;
  const std::string picture = folder_.path("picture.exr");
  EXPECT_EQ(run({"render", out_, "-o", picture, "--size", "32x32", "--aov", "id"}).exit, 0);
}

// In a session an unknown word is an error, once, before any stroke is made; else a warning.
TEST_F(SculptApp, SessionsRefuseUnknownWordsOnceAndBeforeAnything) {
  const std::string typo = folder_.write(
      "typo.yaml",
      "sdfgrid-strokes: 1\nstrokes:\n"
      "  - {op: union, brush: {sphere: {radius: 0.2}}, path: [[0, 0, 1]], strength: 0.5}\n"
      "  - {op: union, brush: {sphere: {radius: 0.2}}, path: [[0, 0, 1]], smoth: 0.1}\n");
  EXPECT_EQ(run({"sculpt", grid_, "--strokes", typo, "-o", out_}).exit, 0);
  const std::string session = folder_.path("session");
  const std::vector<std::vector<std::string>> commands = {
      {"sculpt", grid_, "--strokes", typo, "--session", session},
      {"sculpt", "--session", session, "--strokes", typo}};
  for (const auto& command : commands) {
    const Outcome refused = run(command);
    EXPECT_EQ(refused.exit, 4) << refused.error;
    const std::size_t at = refused.error.find("'smoth'");
    EXPECT_NE(at, std::string::npos) << refused.error;
    EXPECT_EQ(refused.error.find("'smoth'", at + 1), std::string::npos) << refused.error;
    EXPECT_NE(refused.error.find("typo.yaml: line 4"), std::string::npos) << refused.error;
    EXPECT_NE(refused.error.find("did you mean 'smooth'"), std::string::npos) << refused.error;
    if (&command != &commands.front()) continue;
    EXPECT_FALSE(std::filesystem::exists(session));
    ASSERT_EQ(run({"sculpt", grid_, "--strokes", strokes_, "--session", session}).exit, 0);
  }
  const Outcome log = run({"sculpt", "--session", session, "--log", "--json"});
  EXPECT_EQ(json::parse(log.out)["standing"], 2) << log.error;
}

TEST_F(SculptApp, CountsOneStrokeAsOne) {
  const std::string session = folder_.path("session");
  const std::string one =
      folder_.write("one.yaml",
                    "sdfgrid-strokes: 1\nstrokes:\n"
                    "  - {op: union, brush: {sphere: {radius: 0.2}}, path: [[0, 0, 1]]}\n");
  const Outcome made = run({"sculpt", grid_, "--strokes", one, "--session", session});
  EXPECT_NE(made.out.find("1 stroke, 1 dab, "), std::string::npos) << made.out;
  EXPECT_NE(made.out.find(": 1 stroke stands, 0 can be redone"), std::string::npos) << made.out;
}

// Whatever else than a grid or a stroke file is named is told what it is and what to do.
TEST_F(SculptApp, FilesOfOtherKindsAreToldWhatToDo) {
  const std::string session = folder_.path("session");
  ASSERT_EQ(run({"sculpt", grid_, "--strokes", strokes_, "--session", session}).exit, 0);
  const std::string scene = folder_.write("ball.yaml", "sdfgrid: 1\nscene: {sphere: {}}\n");
  const auto told = [&](const std::vector<std::string>& words, const std::string& what) {
    const Outcome refused = run(words);
    EXPECT_EQ(refused.exit, 4) << refused.error;
    EXPECT_NE(refused.error.find(what), std::string::npos) << refused.error;
  };
  const auto sculpt = [&](const std::string& in, const std::string& by) {
    return std::vector<std::string>{"sculpt", in, "--strokes", by, "-o", out_};
  };
  told(sculpt(cube_, strokes_), "it is a mesh, no grid; make a grid of it by `sdfgrid convert");
  told(sculpt(scene, strokes_), "it is a scene, no grid; make a grid of it by `sdfgrid convert");
  told(sculpt(strokes_, strokes_), "it is a stroke file, no grid; apply it to a grid by");
  told(sculpt(session, strokes_), "it is the folder of a session, no grid; go on with it by");
  told(sculpt(grid_, scene), "it is a scene, no stroke file; give a text that begins with");
  told(sculpt(grid_, grid_), "{op: stamp, brush: {grid: {file: cube.vdb}}}");
  told(sculpt(grid_, folder_.path("none.yaml")), "none.yaml: it cannot be read; check the path");
  for (const char* command : {"convert", "render", "sample"}) {
    const std::string out = folder_.path(std::string(command) == "render" ? "o.png" : "o.npy");
    told({command, session, "-o", out}, "it is the folder of a session, which is not taken here");
    told({command, strokes_, "-o", out}, "it is a stroke file, which is not taken here; apply it");
  }
  const std::string swapped =
      folder_.write("swapped.yaml",
                    "sdfgrid-strokes: 1\nstrokes:\n"
                    "  - {op: stamp, brush: {scene: {file: cube.vdb}}, path: [[0, 0, 1]]}\n");
  told(sculpt(grid_, swapped), "it is a grid; write {grid: {file: cube.vdb}}");
}

TEST_F(SculptApp, InfoKnowsSessionsAndStrokeFiles) {
  const std::string session = folder_.path("session");
  ASSERT_EQ(run({"sculpt", grid_, "--strokes", strokes_, "--session", session}).exit, 0);
  ASSERT_EQ(run({"sculpt", "--session", session, "--undo", "1"}).exit, 0);
  const json of_session = json::parse(run({"info", session, "--json"}).out);
  EXPECT_EQ(of_session["kind"], "session");
  EXPECT_EQ(of_session["strokes"], 1);
  EXPECT_EQ(of_session["redoable"], 1);
  EXPECT_EQ(of_session["records"], 3);
  EXPECT_EQ(of_session["redistance"], "local");
  const std::string said = run({"info", session}).out;
  EXPECT_NE(said.find("1 stroke stands, 1 can be redone"), std::string::npos) << said;
  EXPECT_NE(said.find("sdfgrid sculpt --session " + session), std::string::npos) << said;

  const json of_file = json::parse(run({"info", strokes_, "--json"}).out);
  EXPECT_EQ(of_file["kind"], "strokes");
  EXPECT_EQ(of_file["strokes"], 2);
  EXPECT_EQ(of_file["ops"], (json{{"difference", 1}, {"union", 1}}));
  EXPECT_EQ(of_file["bounds"], (json{{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}}));
  EXPECT_EQ(of_file["list"].size(), 2U);

  std::ofstream(session + "/journal", std::ios::app) << "4 12 torn";
  const json torn = json::parse(run({"info", session, "--json"}).out);
  EXPECT_EQ(torn["strokes"], 1);
  EXPECT_NE(torn["warnings"].dump().find("not complete"), std::string::npos) << torn;
  EXPECT_EQ(run({"info", folder_.path("nothing")}).exit, 4);
}

// Brushes that are fields, blends, pressure, re-distancing: the same file from the kernels of the
// oldest machine and from those of this one.
TEST_F(SculptApp, GivesTheSameBytesOnEveryInstructionSet) {
  const std::string strokes = folder_.write(
      "many.yaml",
      "sdfgrid-strokes: 1\n"
      "strokes:\n"
      "  - {op: difference, brush: {sphere: {radius: 0.2}}, path: [[0, 0, 1], [1, 0.9, 1, 0.5]]}\n"
      "  - {op: union, brush: {torus: {major: 0.25, minor: 0.11}}, path: [[0.5, 0.5, 0.03]]}\n"
      "  - {op: union, brush: {bend: {angle: 40, of: {box: {size: [0.3, 0.2, 0.5]}}}}, "
      "path: [[0.1, 0.5, 0.6]], smooth: 0.06}\n"
      "  - {op: difference, brush: {ellipsoid: {radii: [0.2, 0.1, 0.3]}}, path: [[0.8, 0.4, 0.9]], "
      "mirror: [{x: 0.5}]}\n"
      "  - {op: smooth, brush: {sphere: {radius: 0.3}}, path: [[0.1, 0.5, 0.6]]}\n");
  const auto carve = [&](const std::string& name) {
    const Outcome outcome =
        run({"sculpt", grid_, "--strokes", strokes, "-o", folder_.path(name), "--quiet"});
    EXPECT_EQ(outcome.exit, 0) << outcome.error;
    std::ifstream file(folder_.path(name), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string here = carve("here.vdb");
  ASSERT_EQ(setenv("SDFGRID_ISA", "baseline", 1), 0);
  const std::string oldest = carve("oldest.vdb");
  ASSERT_EQ(unsetenv("SDFGRID_ISA"), 0);
  EXPECT_GT(here.size(), 1000U);
  EXPECT_TRUE(here == oldest);
}

}  // namespace
}  // namespace sdfgrid::test
