// What becomes of a scene's materials when it is converted: paint of the grid, which says how it
// looks, in pictures of the grid and in scenes that hold it.
#include "sdfgrid/scene/paint_scene.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <iterator>

#include "app/process.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/atlas.h"
#include "sdfgrid/grid/convert_field.h"
#include "sdfgrid/grid/paint.h"
#include "sdfgrid/trace/atlas_seen.h"

namespace sdfgrid {
namespace {

const char* const kTwoBalls = R"(
sdfgrid: 1
materials:
  red: {diffuse: [0.7, 0.05, 0.04], specular: 0.3, exponent: 64}
  blue: {diffuse: [0.05, 0.1, 0.6]}
scene:
  - {sphere: {radius: 1}, material: red}
  - difference:
      - {sphere: {radius: 1}, at: [3, 0, 0], material: blue}
      - {sphere: {radius: 0.5}, at: [4, 0, 0], material: red}
)";

struct Painted {
  Grid grid;
  ScenePaint paint;
  SceneModel model;
};

Painted convert(const std::string& text, int dim = 60, const std::string& file = "s.yaml") {
  Painted p;
  p.model = build_scene(parse_scene(text, file).scene, file, 0, Job());
  FieldConvertOptions options;
  options.dim = dim;
  p.grid = convert_field(p.model.field, options, Job()).grid;
  p.paint = paint_scene(p.model, p.grid, Job());
  return p;
}

// The materials that a picture of the grid alone shows.
Material seen(const Grid& grid, const glm::dvec3& p) {
  const Atlas atlas = make_atlas(grid, Job());
  const SeenAtlas shown(atlas, {}, grid);
  glm::vec3 normal;
  Material material;
  shown.describe({&p, 1}, {&normal, 1}, {&material, 1});
  return material;
}

TEST(PaintScene, EverySampleHasTheMaterialOfItsSurface) {
  const Painted p = convert(kTwoBalls);
  EXPECT_EQ(p.paint.materials, (std::map<int, std::string>{{1, "red"}, {2, "blue"}}));
  const PaintReader paint(p.grid);
  const double voxel = p.grid.lattice().voxel;
  std::size_t seen_samples = 0;
  glm::ivec3 lo;
  glm::ivec3 hi;
  p.grid.active_bounds(lo, hi);
  for (int x = lo.x; x <= hi.x; ++x) {
    for (int y = lo.y; y <= hi.y; ++y) {
      for (int z = lo.z; z <= hi.z; ++z) {
        if (std::fabs(p.grid.value({x, y, z})) >= p.grid.background()) continue;
        const glm::dvec3 at = p.grid.lattice().to_world({x, y, z});
        // Whose surface decides, in closed form; ties within rounding may go either way.
        const double red = glm::length(at) - 1;
        const double blue = glm::length(at - glm::dvec3(3, 0, 0)) - 1;
        const double cut = 0.5 - glm::length(at - glm::dvec3(4, 0, 0));
        if (std::fabs(blue - cut) < 1e-3 * voxel) continue;
        const bool is_blue = std::fmax(blue, cut) < red && blue > cut;
        ASSERT_EQ(paint.at(at), is_blue ? 2 : 1) << at.x << " " << at.y << " " << at.z;
        ++seen_samples;
      }
    }
  }
  EXPECT_GT(seen_samples, 10000U);
}

TEST(PaintScene, TheGridShowsTheColoursOfTheScene) {
  const Painted p = convert(kTwoBalls);
  EXPECT_EQ(seen(p.grid, {-1, 0, 0}).diffuse, glm::vec3(0.7F, 0.05F, 0.04F));
  EXPECT_EQ(seen(p.grid, {-1, 0, 0}).specular, 0.3F);
  EXPECT_EQ(seen(p.grid, {-1, 0, 0}).exponent, 64.0F);
  EXPECT_EQ(seen(p.grid, {3, 1, 0}).diffuse, glm::vec3(0.05F, 0.1F, 0.6F));
  EXPECT_EQ(seen(p.grid, {3.5, 0, 0}).diffuse, glm::vec3(0.7F, 0.05F, 0.04F));  // in the cut
  EXPECT_EQ(seen(p.grid, {3, 1, 0}).index, 2);
}

TEST(PaintScene, OneMaterialIsNoPaint) {
  const Painted none = convert("sdfgrid: 1\nmaterials: {a: {}}\nscene: {sphere: {}}\n");
  EXPECT_FALSE(has_paint(none.grid));
  EXPECT_TRUE(paint_looks(none.grid).empty());
  const Painted one = convert(
      "sdfgrid: 1\nmaterials: {a: {diffuse: [0.1, 0.2, 0.3]}}\nscene: {sphere: {}, material: a}\n");
  EXPECT_FALSE(has_paint(one.grid));
  EXPECT_FALSE(has_several_materials(one.model));
  EXPECT_TRUE(one.paint.materials.empty());
  EXPECT_EQ(seen(one.grid, {1, 0, 0}).diffuse, glm::vec3(0.1F, 0.2F, 0.3F));
  // A second one that is nowhere to be seen.
  const Painted hidden = convert(R"(
sdfgrid: 1
materials: {a: {diffuse: [0.1, 0.2, 0.3]}, b: {}}
scene: [{sphere: {radius: 1}, material: a}, {sphere: {radius: 0.2}, material: b}]
)");
  EXPECT_TRUE(has_several_materials(hidden.model));
  EXPECT_FALSE(has_paint(hidden.grid));
  EXPECT_EQ(seen(hidden.grid, {1, 0, 0}).diffuse, glm::vec3(0.1F, 0.2F, 0.3F));
}

TEST(PaintScene, WhatHasNoMaterialIsNotPainted) {
  const Painted p = convert(R"(
sdfgrid: 1
materials: {a: {diffuse: [0.1, 0.2, 0.3]}}
scene: [{sphere: {radius: 1}, material: a}, {sphere: {radius: 1}, at: [3, 0, 0]}]
)");
  EXPECT_EQ(p.paint.materials, (std::map<int, std::string>{{1, "a"}}));
  EXPECT_EQ(seen(p.grid, {0, 1, 0}).diffuse, glm::vec3(0.1F, 0.2F, 0.3F));
  EXPECT_EQ(seen(p.grid, {3, 1, 0}).diffuse, Material().diffuse);
}

TEST(PaintScene, MaterialsCalledByNumbersKeepThem) {
  const Painted p = convert(R"(
sdfgrid: 1
materials: {a: {}, "1": {}, b: {}, "300": {}}
scene:
  - {sphere: {}, material: a}
  - {sphere: {}, at: [3, 0, 0], material: "1"}
  - {sphere: {}, at: [6, 0, 0], material: b}
  - {sphere: {}, at: [9, 0, 0], material: "300"}
)");
  EXPECT_EQ(p.paint.materials,
            (std::map<int, std::string>{{1, "1"}, {2, "a"}, {3, "b"}, {4, "300"}}));
}

TEST(PaintScene, MoreMaterialsThanNumbersAreCounted) {
  std::string text = "sdfgrid: 1\nmaterials:\n";
  for (int i = 0; i < 258; ++i) text += fmt::format("  m{}: {{}}\n", i);
  text += "scene:\n";
  for (int i : {0, 254, 257}) {
    text += fmt::format("  - {{sphere: {{}}, at: [{}, 0, 0], material: m{}}}\n", 3 * i, i);
  }
  const Painted p = convert(text, 1500);
  EXPECT_EQ(p.paint.too_many, 3);
  EXPECT_EQ(p.paint.materials, (std::map<int, std::string>{{1, "m0"}, {255, "m254"}}));
  EXPECT_EQ(PaintReader(p.grid).at({3 * 257, 1, 0}), 0);
}

// In a scene a grid brings the colours of the scene that it was made of, unless they are said.
TEST(PaintScene, AGridBringsItsLooksIntoAScene) {
  const test::Folder folder;
  write_grid(convert(kTwoBalls).grid, folder.path("balls.vdb"));
  write_grid(convert("sdfgrid: 1\nmaterials: {a: {diffuse: [0.1, 0.2, 0.3]}}\n"
                     "scene: {sphere: {}, material: a}\n")
                 .grid,
             folder.path("ball.vdb"));
  const std::string path = folder.write("s.yaml", R"(
sdfgrid: 1
materials: {clay: {}, "2": {diffuse: [0.9, 0.9, 0]}}
scene:
  - grid: {file: balls.vdb}
  - {grid: {file: ball.vdb}, at: [0, 5, 0]}
  - {grid: {file: ball.vdb}, at: [0, 10, 0], material: clay}
)");
  const SceneModel model = build_scene(read_scene(path).scene, path, 0, Job());
  EXPECT_EQ(model.names, (std::vector<std::string>{"clay", "2", "red", "a"}));
  const auto at = [&](double x, double y) {
    return model.materials[static_cast<std::size_t>(model.field.tag_at({x, y, 0}))].diffuse;
  };
  EXPECT_EQ(at(-1, 0), glm::vec3(0.7F, 0.05F, 0.04F));
  EXPECT_EQ(at(3, 1), glm::vec3(0.9F, 0.9F, 0));
  EXPECT_EQ(at(0, 6), glm::vec3(0.1F, 0.2F, 0.3F));
  EXPECT_EQ(model.field.tag_at({0, 11, 0}), 0);
  // And from there into another grid.
  const Painted again = convert(
      "sdfgrid: 1\nscene: [{grid: {file: balls.vdb}}, {sphere: {}, at: [0, 5, 0]}]\n", 60, path);
  EXPECT_EQ(seen(again.grid, {-1, 0, 0}).diffuse, glm::vec3(0.7F, 0.05F, 0.04F));
  EXPECT_EQ(seen(again.grid, {3, 1, 0}).diffuse, glm::vec3(0.05F, 0.1F, 0.6F));
  EXPECT_EQ(PaintReader(again.grid).at({0, 6, 0}), 0);
}

TEST(PaintScene, LooksThatCannotBeUnderstoodAreLeftOut) {
  Grid grid = convert(kTwoBalls).grid;
  ASSERT_EQ(paint_looks(grid).size(), 2U);
  for (const char* broken :
       {"", "0.1 0.2", "0.1 0.2 0.3 0.4 -5 x", "nan 0 0 0 1 x", "a b c d e f"}) {
    grid.set_metadata("sdfgrid:material-1", broken);
    EXPECT_EQ(paint_looks(grid).count(1), 0U) << broken;
    EXPECT_EQ(seen(grid, {-1, 0, 0}).diffuse, paint_look(1).diffuse);
  }
  grid.set_metadata("sdfgrid:material-1", "0.1 0.2 0.3 0 1 a name of words");
  EXPECT_EQ(paint_looks(grid).at(1).name, "a name of words");
}

TEST(PaintScene, IsTheSameAtAnyNumberOfThreads) {
  const test::Folder folder;
  const auto bytes = [&](int threads, const std::string& name) {
    const ThreadLimit limit(threads);
    write_grid(convert(kTwoBalls).grid, folder.path(name));
    std::ifstream in(folder.path(name), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  EXPECT_TRUE(bytes(1, "a.vdb") == bytes(4, "b.vdb"));
}

}  // namespace
}  // namespace sdfgrid
