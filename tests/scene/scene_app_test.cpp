// Scenes on the command line: convert, render, sample and shapes as a user's script calls them.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/process.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/field/formula.h"

namespace sdfgrid::test {
namespace {

using nlohmann::json;

class SceneApp : public ::testing::Test {
 protected:
  Folder folder_;
  std::string scene_ = folder_.write("scene.yaml",
                                     "sdfgrid: 1\n"
                                     "scene:\n"
                                     "  - difference:\n"
                                     "      - box: {size: [2, 2, 2]}\n"
                                     "      - sphere: {radius: 1.2}\n");
};

TEST_F(SceneApp, BecomesAGrid) {
  const std::string grid = folder_.path("scene.vdb");
  const Outcome outcome = run({"convert", scene_, "-o", grid, "--dim", "40", "--json"});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  const json result = json::parse(outcome.out);
  EXPECT_EQ(result["method"], "field");
  EXPECT_GT(result["active_voxels"], 1000);
  EXPECT_EQ(run({"info", grid, "--quiet"}).exit, 0);
}

TEST_F(SceneApp, ItsMaterialsBecomePaint) {
  const std::string two = folder_.write("two.yaml", R"(sdfgrid: 1
materials: {red: {diffuse: [0.7, 0.05, 0.05]}, blue: {diffuse: [0.05, 0.1, 0.6]}}
scene: [{sphere: {}, material: red}, {sphere: {}, at: [3, 0, 0], material: blue}]
)");
  const std::string grid = folder_.path("two.vdb");
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, {"--dense"}, {"--tolerance", "5%"}}) {
    std::vector<std::string> words = {"convert", two, "-o", grid, "--force", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words);
    ASSERT_EQ(outcome.exit, 0) << outcome.error;
    EXPECT_EQ(json::parse(outcome.out)["materials"], (json{{"1", "red"}, {"2", "blue"}}));
    const json info = json::parse(run({"info", grid, "--json"}).out);
    EXPECT_GT(info["paint"]["1"], 100) << info;
    EXPECT_GT(info["paint"]["2"], 100) << info;
    EXPECT_EQ(info["metadata"]["sdfgrid:material-2"], "0.05 0.1 0.6 0.12 28 blue");
  }
  const Outcome outcome =
      run({"convert", two, "-o", folder_.path("two.npy"), "--dim", "20", "--json"});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  EXPECT_NE(json::parse(outcome.out)["warnings"].dump().find("holds no paint"), std::string::npos);
}

// What a grid of the scene does not know, the grid that is made does not say, and that is told.
TEST_F(SceneApp, TellsWhatBandItsGridsCannotFill) {
  ASSERT_EQ(run({"convert", scene_, "-o", folder_.path("a.vdb"), "--dim", "60"}).exit, 0);
  const std::string holds =
      folder_.write("holds.yaml", "sdfgrid: 1\nscene:\n  - grid: {file: a.vdb}\n");
  const auto warnings = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"convert", holds,   "-o", folder_.path("b.vdb"),
                                      "--force", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.exit, 0) << outcome.error;
    return json::parse(outcome.out)["warnings"].dump();
  };
  const std::string told = warnings({"--dim", "60", "--width", "8"});
  EXPECT_NE(told.find("holds.yaml: line 3: the band of"), std::string::npos) << told;
  const std::size_t width = told.find("a --width of ");
  ASSERT_NE(width, std::string::npos) << told;
  const std::string possible = told.substr(width + 13, told.find(',', width) - width - 13);
  EXPECT_EQ(warnings({"--dim", "60", "--width", possible}), "[]");
  EXPECT_NE(warnings({"--dim", "20"}).find("a --voxel of"), std::string::npos);
  EXPECT_NE(warnings({"--dim", "20", "--dense"}).find("convert its mesh"), std::string::npos);
}

TEST_F(SceneApp, BecomesAPicture) {
  const Outcome outcome =
      run({"render", scene_, "-o", folder_.path("scene.png"), "--size", "64x64", "--json"});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  const json result = json::parse(outcome.out);
  EXPECT_EQ(result["rays"], 64 * 64);
  EXPECT_GT(result["hits"], 400);
  EXPECT_LT(result["hits"], 64 * 64);
}

// A floor without end leaves the others what they are to rays: objects that are met one by one.
TEST_F(SceneApp, AFloorWithoutEndCostsLittle) {
  std::string balls;
  for (int i = 0; i < 64; ++i) {
    balls += "  - {sphere: {radius: 0.1}, at: [" + std::to_string(i % 8) + ", 0.5, " +
             std::to_string(i / 8) + "]}\n";
  }
  const std::string start =
      "sdfgrid: 1\n"
      "camera: {eye: [3, 9, 14], target: [3.5, 0, 3.5], up: [0, 1, 0]}\n"
      "scene:\n";
  const auto steps = [&](const std::string& scene) {
    const Outcome outcome =
        run({"render", folder_.write("floor.yaml", scene), "-o", folder_.path("floor.png"),
             "--size", "96x96", "--samples", "1", "--force", "--json"});
    EXPECT_EQ(outcome.exit, 0) << outcome.error;
    return json::parse(outcome.out)["steps_mean"].get<double>();
  };
  EXPECT_LT(steps(start + "  - plane: {normal: [0, 1, 0]}\n" + balls), steps(start + balls) + 4);
}

TEST_F(SceneApp, IsSampledForNumpy) {
  const std::string out = folder_.path("samples.npy");
  const Outcome outcome = run({"sample", scene_, "-o", out, "--random", "50"});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  EXPECT_GT(std::filesystem::file_size(out), 50U * 4U * 4U);
}

TEST_F(SceneApp, RefusesBrokenStructureWithItsLine) {
  const std::string bad = folder_.write("bad.yaml", "sdfgrid: 1\nscene:\n  - sphere: {radius: 1\n");
  const Outcome outcome = run({"convert", bad, "-o", folder_.path("bad.vdb")});
  EXPECT_EQ(outcome.exit, 4) << outcome.error;
  EXPECT_NE(outcome.error.find("bad.yaml"), std::string::npos) << outcome.error;
  EXPECT_NE(outcome.error.find("line"), std::string::npos) << outcome.error;
}

TEST_F(SceneApp, RefusesASceneWithNothingInIt) {
  const std::string apart = folder_.write("apart.yaml",
                                          "sdfgrid: 1\n"
                                          "scene:\n"
                                          "  - intersection:\n"
                                          "      - sphere: {radius: 1}\n"
                                          "      - {sphere: {radius: 1}, at: [1.5, 1.5, 0]}\n");
  const Outcome outcome = run({"convert", apart, "-o", folder_.path("apart.vdb")});
  EXPECT_EQ(outcome.exit, 4) << outcome.out;
  EXPECT_NE(outcome.error.find("apart.yaml"), std::string::npos) << outcome.error;
  EXPECT_EQ(folder_.files(), (std::vector<std::string>{"apart.yaml", "scene.yaml"}));
}

TEST_F(SceneApp, ShapesListsEveryOp) {
  const Outcome outcome = run({"shapes"});
  ASSERT_EQ(outcome.exit, 0);
  for (const OpEntry& op : op_list()) {
    EXPECT_NE(outcome.out.find(op.info->name), std::string::npos) << op.info->name;
  }
}

TEST_F(SceneApp, ShapesListsTheFunctionsOfFormulas) {
  const Outcome outcome = run({"shapes", "formula"});
  ASSERT_EQ(outcome.exit, 0);
  for (const FormulaFunction& f : formula_functions()) {
    const std::string call = std::string(f.name) + "(" + f.arguments + ")";
    EXPECT_NE(outcome.out.find(call), std::string::npos) << call;
    EXPECT_NE(outcome.out.find(f.text), std::string::npos) << call;
  }
}

// What the program says of its ops is what stands in docs/shapes.md (scripts/shapes writes it).
TEST_F(SceneApp, ShapesAreTheDocumentedOnes) {
  std::ifstream in(SDFGRID_SOURCE_DIR "/docs/shapes.md");
  if (!in) GTEST_SKIP() << "there is no docs/shapes.md";
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::size_t from = text.find("## Shapes\n");
  ASSERT_NE(from, std::string::npos);
  EXPECT_EQ(text.substr(from), run({"shapes", "--markdown"}).out);
}

}  // namespace
}  // namespace sdfgrid::test
