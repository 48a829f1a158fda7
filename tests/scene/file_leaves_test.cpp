// Files as leaves of scenes: what stands around them is where it says, as around a shape.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <random>
#include <string>
#include <utility>

#include "app/process.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/mesh/read.h"
#include "sdfgrid/scene/build.h"
#include "sdfgrid/scene/scene.h"
#include "sdfgrid/trace/grid_sampler.h"

namespace sdfgrid {
namespace {

// A cube from a file, with what is made of it.
class SceneOfCube : public testing::Test {
 protected:
  SceneModel reaching(const std::string& scene, const SceneReach& reach) {
    const std::string path = folder_.write("s.yaml", "sdfgrid: 1\nscene: " + scene + "\n");
    return build_scene(read_scene(path).scene, path, 0, Job(), reach);
  }
  Field field(const std::string& scene) { return reaching(scene, {}).field; }
  std::string refusal(const std::string& scene) {
    try {
      (void)field(scene);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return error.what();
    }
    return "";
  }

  void write_cube(double width) {
    ConvertOptions options;
    options.dim = 48;
    options.band = {width, width};
    write_grid(convert_mesh(read_mesh(cube_, Job()).soup, options, Job()).grid,
               folder_.path("cube.vdb"));
  }

  test::Folder folder_;
  std::string cube_ = folder_.write("cube.off", test::cube_off());
  std::string mesh_ = "{mesh: {file: cube.off, dim: 48}}";
};

TEST_F(SceneOfCube, OffsetsAndShellsAreWhereTheySay) {
  for (const double by : {-0.4, -0.05, 0.05, 0.6}) {
    const Field grown = field(fmt::format("{{offset: {{by: {}, of: {}}}}}", by, mesh_));
    const auto face = static_cast<float>(1 + by);
    EXPECT_NEAR(grown({face, 0.5F, 0.5F}), 0, 1e-5) << by;
    EXPECT_GT(grown({face + 0.01F, 0.5F, 0.5F}), 0.004) << by;
    EXPECT_LT(grown({face - 0.01F, 0.5F, 0.5F}), -0.004) << by;
  }
  // Not the box around it: rounded at an edge.
  const Field grown = field("{offset: {by: 0.5, of: " + mesh_ + "}}");
  EXPECT_GT(grown({1.45F, 1.45F, 0.5F}), 0);
  EXPECT_NEAR(grown({1.35355F, 1.35355F, 0.5F}), 0, 0.01);
  const Field shell =
      field("{shell: {thickness: 0.2, of: {mesh: {file: cube.off, dim: 48}, scale: 2}}}");
  for (const float wall : {1.9F, 2.1F}) EXPECT_NEAR(shell({wall, 1, 1}), 0, 1e-5);
  EXPECT_LT(shell({2, 1, 1}), -0.02);
  EXPECT_GT(shell({1.8F, 1, 1}), 0.01);
}

// What changes nothing, or only where a file is and how large, may stand between; and what gives a
// name to a group.
TEST_F(SceneOfCube, OffsetsAndShellsAreWhereTheySayThroughWhatDoesNotBend) {
  const std::pair<std::string, double> around[] = {
      {"{union: [MESH]}", 1},
      {"{union: [{union: [MESH], name: group}], at: [0, 0, 0], rotate: [0, 0, 0], scale: 1}", 1},
      {"{mirror: {planes: [0, 0, 0], of: MESH}}", 1},
      {"{linear: {matrix: [1, 0, 0, 0, 1, 0, 0, 0, 1], of: MESH}}", 1},
      {"{translate: {by: [0, 0, 0], of: {rotate: {by: [0, 0, 0], of: MESH}}}}", 1},
      {"{intersection: [{translate: {by: [-1, 0, 0], of: {translate: {by: [1, 0, 0], of: "
       "MESH}}}}]}",
       1},
      {"{scale: {by: 2, of: {union: [{mesh: {file: cube.off, dim: 48}, scale: 0.75}]}}}", 1.5},
      {"{rotate: {by: [90, 0, 0], of: {translate: {by: [0, 0, -1], of: MESH}}}}", 1},
  };
  for (const auto& [scene, edge] : around) {
    std::string text = scene;
    for (auto at = text.find("MESH"); at != std::string::npos; at = text.find("MESH")) {
      text.replace(at, 4, mesh_);
    }
    SCOPED_TRACE(text);
    for (const double by : {-0.2, 0.3}) {
      const Field grown = field(fmt::format("{{offset: {{by: {}, of: {}}}}}", by, text));
      const auto face = static_cast<float>(edge + by);
      const float middle = 0.4F * static_cast<float>(edge);
      EXPECT_NEAR(grown({face, middle, middle}), 0, 2e-5) << by;
      EXPECT_NEAR(grown({middle, face, middle}), 0, 2e-5) << by;
    }
    const Field shell = field("{shell: {thickness: 0.2, of: " + text + "}}");
    for (const double wall : {edge - 0.1, edge + 0.1}) {
      EXPECT_NEAR(shell({static_cast<float>(wall), 0.5F, 0.5F}), 0, 2e-5) << wall;
    }
  }
}

TEST_F(SceneOfCube, UnionsOfFilesGrowExactly) {
  const Field grown = field("{offset: {by: 0.3, of: {union: [" + mesh_ +
                            ", {sphere: {radius: 0.5}, at: [3, 0, 0]}, {mesh: {file: cube.off, "
                            "dim: 48}, at: [0, 0, 3]}]}}}");
  EXPECT_NEAR(grown({1.3F, 0.5F, 0.5F}), 0, 2e-5);
  EXPECT_NEAR(grown({0.5F, 0.5F, 4.3F}), 0, 2e-5);
  EXPECT_NEAR(grown({3, 0.8F, 0}), 0, 2e-5);
  EXPECT_LT(grown({0.5F, 0.5F, 0.5F}), -0.4);
}

// What is made of the mesh and of a box in its place, at points around: the same but for samples.
// (Not so where an op blends by values inside, as smooth intersections do: those of files are
// bounds, up to 1.7 times too small.)
TEST_F(SceneOfCube, StandsUnderOpsThatLookBeyondIt) {
  const std::string box = "{box: {size: [1, 1, 1]}, at: [0.5, 0.5, 0.5]}";
  const std::string ball = "{sphere: {radius: 0.5}, at: [2.2, 0.5, 0.5]}";
  std::string many = "{smooth_union: {k: 0.4, of: [";
  for (int i = 0; i < 17; ++i) {
    many += fmt::format("{{sphere: {{radius: 0.2}}, at: [{}, 1.4, 0.5]}}, ", 0.1 * i - 0.3);
  }
  const std::pair<std::string, std::string> around[] = {
      {"{smooth_union: {k: 1.6, of: [", ", " + ball + "]}}"},
      {many, "]}}"},
      {"{smooth_difference: {k: 0.8, of: [{box: {size: [3, 3, 3]}}, ", "]}}"},
      {"{repeat: {cell: [4, 4, 0], of: ", "}}"}};
  std::mt19937 random(9);
  std::uniform_real_distribution<float> at(-1, 2);
  for (const auto& [before, after] : around) {
    SCOPED_TRACE(before);
    const Field of_mesh = field(before + mesh_ + after);
    const Field of_box = field(before + box + after);
    int beside = 0;
    for (int i = 0; i < 4000; ++i) {
      const glm::vec3 p(at(random), at(random), at(random));
      const float d = of_box(p);
      if (std::fabs(d) < 0.03F) {
        ++beside;
        ASSERT_NEAR(of_mesh(p), d, 0.03) << p.x << " " << p.y << " " << p.z;
      } else {
        ASSERT_EQ(of_mesh(p) < 0, d < 0) << p.x << " " << p.y << " " << p.z << ": " << d;
      }
    }
    EXPECT_GT(beside, 20);
  }
  const Field smooth = field("{smooth_union: {k: 1.6, of: [" + mesh_ + ", " + ball + "]}}");
  const Box bounds = smooth.bounds();  // not those of the band, which is 1.6 wide
  EXPECT_TRUE(bounds.lo.x > -0.5 && bounds.hi.x < 3.2) << bounds.lo.x << " " << bounds.hi.x;
}

// An offset wider than copies are from the walls of their cells is around the copies, not the
// walls.
TEST_F(SceneOfCube, OffsetsOfRepeatedFilesLeaveTheWallsAlone) {
  const std::string centered = "{mesh: {file: cube.off, dim: 48}, at: [-0.5, -0.5, -0.5]}";
  const Field row =
      field("{offset: {by: 0.15, of: {repeat: {cell: [1.2, 1.2, 0], of: " + centered + "}}}}");
  EXPECT_LT(row({0.6F, 0, 0}), 0);  // where two meet
  for (const float z : {0.8F, 1.5F, 20.0F}) {
    for (const float wall : {0.6F, 1.8F, -3.0F}) {
      EXPECT_GT(row({wall, 0.2F, z}), 0) << wall << " " << z;
      EXPECT_GT(row({0.1F, wall, z}), 0) << wall << " " << z;
    }
  }
  EXPECT_NEAR(row({0.1F, 0.1F, 0.65F}), 0, 0.05);  // a bound reaches further
}

// Of grids with samples everywhere, and of bands of two widths: 1-Lipschitz, and no point below a
// level is outside of its bounds.
TEST_F(SceneOfCube, GridsOfAllKindsAreBounds) {
  ConvertOptions narrow;
  narrow.dim = 24;
  ConvertOptions wide = narrow;
  wide.band = {2, 9};
  ConvertOptions dense = narrow;
  dense.band = {40, 40};
  const TriangleSoup soup = read_mesh(cube_, Job()).soup;
  std::mt19937 random(10);
  std::uniform_real_distribution<double> at(-0.6, 1.6);
  std::uniform_real_distribution<double> near(-0.05, 0.05);
  const auto point = [&] { return glm::dvec3(at(random), at(random), at(random)); };
  for (const ConvertOptions& options : {narrow, wide, dense}) {
    const auto sampler = make_sampler(convert_mesh(soup, options, Job()).grid, Job());
    for (int i = 0; i < 30000; ++i) {
      const glm::dvec3 p = point();
      const glm::dvec3 q = i % 2 == 0 ? point() : p + glm::dvec3(near(random), near(random), 0);
      ASSERT_LE(std::fabs(sampler->value(p) - sampler->value(q)), glm::length(p - q) + 1e-6);
      for (const double level : {0.0, 0.04, 0.08, 0.11, 0.2}) {
        if (sampler->value(p) >= level) continue;
        const Box box = sampler->bounds(level);
        ASSERT_EQ(glm::clamp(p, box.lo, box.hi), p) << level;
      }
    }
  }
}

// With line, file and the width that is enough: converted with that, they are taken.
TEST_F(SceneOfCube, GridsWithTooNarrowABandAreRefused) {
  write_cube(3);
  EXPECT_EQ(refusal("{offset: {by: 0.03, of: {grid: {file: cube.vdb}}}}"), "");
  for (const char* scene : {"{offset: {by: 0.5, of: {grid: {file: cube.vdb}}}}",
                            "{shell: {thickness: 0.3, of: {grid: {file: cube.vdb}, scale: 2}}}",
                            "{offset: {by: -0.2, of: {grid: {file: cube.vdb}}}}"}) {
    write_cube(3);
    const std::string message = refusal(scene);
    EXPECT_NE(message.find("s.yaml: line 2: "), std::string::npos) << message;
    EXPECT_NE(message.find("cube.vdb"), std::string::npos) << message;
    const std::size_t width = message.find("--width ");
    ASSERT_NE(width, std::string::npos) << message;
    write_cube(std::stod(message.substr(width + 8)));
    EXPECT_EQ(refusal(scene), "");
  }
}

// By how much the level `by` of a cube's field misses points that far from its faces, at 0 and at
// `edge`: nothing within a band, where values say where the surface is, and something beyond it,
// where they are but bounds.
double missed_by(const Field& field, double by, float edge) {
  const Field level = make_field("offset", {{"by", by}}, {field});
  const auto near = static_cast<float>(-by);
  const auto far = static_cast<float>(edge + by);
  float most = 0;
  for (const float u : {0.45F * edge, 0.5F * edge}) {
    for (const glm::vec3 p : {glm::vec3(near, u, u), glm::vec3(u, far, 0.5F * edge)}) {
      most = std::fmax(most, std::fabs(level(p)));
    }
  }
  return double(most);
}
constexpr double kThere = 1e-5;

// Who looks at values beyond the surface gets meshes that have them.
TEST_F(SceneOfCube, MeshesReachAsFarAsIsAsked) {
  const Field narrow = reaching(mesh_, {}).field;
  EXPECT_LT(missed_by(narrow, -0.06, 1), kThere);  // 3 voxels, 0.0625
  const SceneModel wide = reaching(mesh_, {0.4, 0.2});
  EXPECT_TRUE(wide.short_bands.empty());
  for (const double by : {-0.4, -0.1, 0.1, 0.2}) {
    EXPECT_LT(missed_by(wide.field, by, 1), kThere) << by;
    EXPECT_GT(missed_by(narrow, by, 1), 0.01) << by;
  }
}

// And is told of grids that have not: how far they reach, and what width would do.
TEST_F(SceneOfCube, GridsSayHowFarTheyReach) {
  write_cube(3);
  const std::string grid = "{grid: {file: cube.vdb}, scale: 2}";
  constexpr double kBand = 2 * 3 / 48.0;
  const SceneReach reaches[] = {{0.5, 0.3}, {0.15, 0.3}, {0, 0.3}, {0.5, 0}};
  const double shares[] = {kBand / 0.5, kBand / 0.3, kBand / 0.3, kBand / 0.5};
  for (int i = 0; i < 4; ++i) {
    SCOPED_TRACE(i);
    const SceneModel model = reaching(grid, reaches[i]);
    ASSERT_EQ(model.short_bands.size(), 1U);
    const ShortBand& band = model.short_bands[0];
    EXPECT_EQ(band.line, 2);
    EXPECT_TRUE(band.file.ends_with("cube.vdb"));
    EXPECT_NEAR(band.share, shares[i], 0.001);
    for (const double level : {-reaches[i].inside, reaches[i].outside}) {
      if (std::fabs(level) < kBand) continue;
      EXPECT_LT(missed_by(model.field, std::copysign(0.99 * kBand, level), 2), kThere) << level;
      EXPECT_GT(missed_by(model.field, level, 2), 0.01) << level;
    }
    const auto short_at = [&](double share) {
      const SceneReach part{share * reaches[i].inside, share * reaches[i].outside};
      return reaching(grid, part).short_bands.size();
    };
    EXPECT_EQ(short_at(0.99 * band.share), 0U);
    EXPECT_EQ(short_at(1.01 * band.share), 1U);
  }
  write_cube(reaching(grid, reaches[0]).short_bands[0].width);
  const SceneModel wide = reaching(grid, reaches[0]);
  EXPECT_TRUE(wide.short_bands.empty());
  for (const double by : {-0.5, 0.3}) EXPECT_LT(missed_by(wide.field, by, 2), kThere) << by;
}

TEST_F(SceneOfCube, FilesUnderTheWrongWordAreToldTheRightOne) {
  write_cube(3);
  (void)folder_.write("ball.yaml", "sdfgrid: 1\nscene: {sphere: {}}\n");
  (void)folder_.write("dabs.yaml", "sdfgrid-strokes: 1\nstrokes: []\n");
  const std::pair<std::string, std::string> wrong[] = {
      {"{grid: {file: cube.off}}", "cube.off: it is a mesh; write {mesh: {file: cube.off}}"},
      {"{mesh: {file: cube.vdb}}", "cube.vdb: it is a grid; write {grid: {file: cube.vdb}}"},
      {"{grid: {file: ball.yaml}}", "ball.yaml: it is a scene, no grid; make a grid of it by"},
      {"{mesh: {file: ball.yaml}}", "ball.yaml: it is a scene, no mesh; make a grid of it by"},
      {"{mesh: {file: dabs.yaml}}", "dabs.yaml: it is a stroke file, no mesh; apply it to a grid"},
      {"{grid: {file: nowhere.vdb}}", "nowhere.vdb: no such file"},
      {"{mesh: {file: cube.off, dim: 12.5}}", "`dim` is 12.5; give a whole number from 2 to 4096"}};
  for (const auto& [scene, told] : wrong) {
    const std::string message = refusal(scene);
    EXPECT_NE(message.find("s.yaml: line 2"), std::string::npos) << message;
    EXPECT_NE(message.find(told), std::string::npos) << message;
  }
}

TEST_F(SceneOfCube, NormalsHoldFarFromTheOrigin) {
  const std::string far = "at: [20000, -30000, 0]";
  const Field there = field("{mesh: {file: cube.off, dim: 48}, " + far + "}");
  const ValueGradient top = there.gradient({20000.4, -29999.3, 1.02});
  EXPECT_NEAR(top.value, 0.02, 0.01);
  EXPECT_LT(std::fabs(top.gradient.x) + std::fabs(top.gradient.y), 1e-3);
  EXPECT_GT(top.gradient.z, 0.5);
  const Field cloud = field("{points: {points: [[0, 0, 0], [9, 0, 0]], radius: 0.1}, " + far + "}");
  const ValueGradient side = cloud.gradient({20009, -30000, 0.125});
  EXPECT_NEAR(side.gradient.z, 1, 1e-3);
}

}  // namespace
}  // namespace sdfgrid
