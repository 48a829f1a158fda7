// Paint: which samples it reaches, that it is undone, kept and stored, and that it costs nothing
// where there is none.
#include "sdfgrid/grid/paint.h"

#include <gtest/gtest.h>
#include <nanovdb/util/IO.h>

#include <cmath>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <sstream>

#include "app/process.h"
#include "edit/grids.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/sculptor.h"
#include "sdfgrid/edit/session.h"
#include "sdfgrid/edit/snapshots.h"
#include "sdfgrid/edit/stroke_file.h"
#include "sdfgrid/grid/bricks.h"

namespace sdfgrid {
namespace {

using namespace sdfgrid::test;
constexpr int kExtent = 20;

Stroke paint_stroke(const glm::dvec3& at, double radius, int material) {
  Stroke stroke = ball_stroke(StrokeOp::paint, at, radius);
  stroke.material = material;
  return stroke;
}

// The material of every sample of [-kExtent, kExtent]^3.
std::vector<int> paint_of(const Grid& grid) {
  const GridBricks bricks(grid);
  std::vector<int> all;
  for (int x = -kExtent; x <= kExtent; ++x) {
    for (int y = -kExtent; y <= kExtent; ++y) {
      for (int z = -kExtent; z <= kExtent; ++z) {
        const std::int32_t* paint = bricks.paint({x >> 3, y >> 3, z >> 3});
        all.push_back(paint != nullptr ? paint[(x & 7) << 6 | (y & 7) << 3 | (z & 7)] : 0);
      }
    }
  }
  return all;
}

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream bytes;
  bytes << in.rdbuf();
  return bytes.str();
}

TEST(Paint, ReachesTheBandWithinTheBrushAndNothingElse) {
  const Grid grid = ball_grid(12);
  const Content before = content_of(grid, kExtent);
  Sculptor sculptor(grid);
  // Across the borders of bricks, swept, and the second over a part of the first.
  Stroke first = paint_stroke({9, 7, 0}, 5, 3);
  first.path.push_back({{-0.9, 0.7, 0.1}, 1});
  (void)sculptor.apply(first, Job());
  (void)sculptor.apply(paint_stroke({0, 12, 0}, 4.3, 200), Job());
  EXPECT_EQ(content_of(grid, kExtent), before);
  const std::vector<int> paint = paint_of(grid);
  std::size_t i = 0;
  for (int x = -kExtent; x <= kExtent; ++x) {
    for (int y = -kExtent; y <= kExtent; ++y) {
      for (int z = -kExtent; z <= kExtent; ++z, ++i) {
        const glm::dvec3 p(x, y, z);
        const glm::dvec3 a(9, 7, 0);
        const glm::dvec3 ab = glm::dvec3(-9, 7, 1) - a;
        const double t = glm::clamp(glm::dot(p - a, ab) / glm::dot(ab, ab), 0.0, 1.0);
        const double to_first = glm::length(p - a - t * ab) - 5;
        const double to_second = glm::length(p - glm::dvec3(0, 12, 0)) - 4.3;
        if (std::abs(to_first) < 1e-4 || std::abs(to_second) < 1e-4) continue;
        const int expected = !before[i].second ? 0 : to_second < 0 ? 200 : to_first < 0 ? 3 : 0;
        ASSERT_EQ(paint[i], expected) << x << " " << y << " " << z;
      }
    }
  }
  const auto counts = paint_counts(grid);
  EXPECT_EQ(counts.size(), 2U);
  EXPECT_GT(counts.at(200), 100U);
}

TEST(Paint, IsUndoneAndRedoneWithAllElse) {
  for (const std::size_t budget : {std::size_t{256} << 20, std::size_t{1}}) {
    SculptOptions options;
    options.undo.full_bytes = budget;  // the second time all but the last are compressed
    const Grid grid = ball_grid(12);
    Sculptor sculptor(grid, options);
    const std::vector<Stroke> strokes = {
        paint_stroke({12, 0, 0}, 6, 1), ball_stroke(StrokeOp::subtract, {12, 3, 0}, 5),
        paint_stroke({11, 0, 2}, 5, 2), ball_stroke(StrokeOp::unite, {12, -3, 0}, 4),
        paint_stroke({12, 0, 0}, 6, 0)};
    std::vector<std::vector<int>> paints = {paint_of(grid)};
    std::vector<Content> contents = {content_of(grid, kExtent)};
    for (const Stroke& stroke : strokes) {
      EXPECT_GT(sculptor.apply(stroke, Job()).bricks_touched, 0U);
      EXPECT_FALSE(sculptor.touched().empty());
      paints.push_back(paint_of(grid));
      contents.push_back(content_of(grid, kExtent));
    }
    EXPECT_NE(paints[1], paints[3]);
    EXPECT_NE(paints[4], paints[5]);
    for (std::size_t i = strokes.size(); i-- > 0;) {
      ASSERT_TRUE(sculptor.undo());
      ASSERT_EQ(paint_of(grid), paints[i]) << i;
      ASSERT_EQ(content_of(grid, kExtent), contents[i]) << i;
    }
    for (std::size_t i = 1; i <= strokes.size(); ++i) {
      ASSERT_TRUE(sculptor.redo());
      ASSERT_EQ(paint_of(grid), paints[i]) << i;
      ASSERT_EQ(content_of(grid, kExtent), contents[i]) << i;
    }
  }
}

TEST(Paint, IsStoredBesideTheDistances) {
  const Folder folder;
  const Grid grid = ball_grid(12);
  write_grid(grid, folder.path("plain.vdb"));
  Sculptor sculptor(grid);
  (void)sculptor.apply(paint_stroke({12, 0, 0}, 6, 7), Job());
  write_grid(grid, folder.path("painted.vdb"));
  const Grid again = read_grid(folder.path("painted.vdb"));
  EXPECT_EQ(paint_of(again), paint_of(grid));
  EXPECT_EQ(content_of(again, kExtent), content_of(grid, kExtent));
  EXPECT_EQ(paint_of(grid.clone()), paint_of(grid));
  // A clone's paint is its own, and a file without paint is as if there had never been any.
  Sculptor other(grid.clone());
  (void)other.apply(paint_stroke({-12, 0, 0}, 6, 8), Job());
  EXPECT_EQ(paint_of(again), paint_of(grid));
  ASSERT_TRUE(sculptor.undo());
  write_grid(grid, folder.path("undone.vdb"));
  EXPECT_EQ(bytes_of(folder.path("undone.vdb")), bytes_of(folder.path("plain.vdb")));
}

TEST(Paint, NanoVdbHoldsItAsASecondGrid) {
  const Folder folder;
  const Grid grid = ball_grid(12);
  write_grid(grid, folder.path("plain.nvdb"));
  EXPECT_EQ(nanovdb::io::readGrids(folder.path("plain.nvdb")).size(), 1U);
  Sculptor sculptor(grid);
  (void)sculptor.apply(paint_stroke({12, 0, 0}, 6, 7), Job());
  write_grid(grid, folder.path("painted.nvdb"));
  const auto distances = nanovdb::io::readGrid(folder.path("painted.nvdb"), grid.name());
  const auto paint = nanovdb::io::readGrid(folder.path("painted.nvdb"), kPaintName);
  ASSERT_NE(distances.grid<float>(), nullptr);
  ASSERT_NE(paint.grid<std::int32_t>(), nullptr);
  const std::vector<int> expected = paint_of(grid);
  const auto values = distances.grid<float>()->getAccessor();
  const auto materials = paint.grid<std::int32_t>()->getAccessor();
  std::size_t i = 0;
  for (int x = -kExtent; x <= kExtent; ++x) {
    for (int y = -kExtent; y <= kExtent; ++y) {
      for (int z = -kExtent; z <= kExtent; ++z) {
        ASSERT_EQ(values.getValue({x, y, z}), grid.value({x, y, z}));
        ASSERT_EQ(materials.getValue({x, y, z}), expected[i++]) << x << " " << y << " " << z;
      }
    }
  }
}

// Where little weight lies on painted samples the point is not painted, and the other way round.
TEST(Paint, APointHasTheMaterialOfMostWeight) {
  const Grid grid = make_grid([](const glm::dvec3& p) { return p.z; }, 12, 0.1);
  EXPECT_EQ(PaintReader(grid).at({0.11, 0.2, 0}), 0);
  Sculptor sculptor(grid);
  const Stroke stroke = parse_stroke(
      "{op: paint, material: 5, brush: {box: {size: [0.5, 0.5, 0.5]}}, path: [[0, 0, 0]]}", "test");
  (void)sculptor.apply(stroke, Job());  // the samples -2 to 2
  const PaintReader paint(grid);
  EXPECT_EQ(paint.at({0.1, 0.1, 0.01}), 5);
  EXPECT_EQ(paint.at({0.249, 0, 0.01}), 5);
  EXPECT_EQ(paint.at({0.251, 0, 0.01}), 0);
  EXPECT_EQ(paint.at({-0.251, 0, 0.01}), 0);
  EXPECT_EQ(paint.at({9, 9, 9}), 0);
}

TEST(Paint, ASessionKeepsIt) {
  const Folder folder;
  const std::string path = folder.path("s");
  create_session(path, ball_grid(12), Redistance::local);
  std::vector<int> expected;
  {
    Session session(path, {.snapshot_every = 2}, Job());
    for (const char* text :
         {"{op: paint, material: 2, brush: {sphere: {radius: 0.5}}, path: [[1.2, 0, 0]]}",
          "{op: difference, brush: {sphere: {radius: 0.3}}, path: [[1.2, 0, 0]]}",
          "{op: paint, material: 4, brush: {sphere: {radius: 0.3}}, path: [[0, 1.2, 0]]}"}) {
      (void)session.apply(parse_stroke(text, "test"), Job());
    }
    expected = paint_of(session.grid());
  }
  ASSERT_EQ(find_snapshots(path).size(), 1U);
  Session session(path, {}, Job());
  EXPECT_EQ(paint_of(session.grid()), expected);
  EXPECT_EQ(paint_counts(session.grid()).size(), 2U);
  EXPECT_EQ(session.undo(3, Job()), 3U);
  EXPECT_TRUE(paint_counts(session.grid()).empty());
}

TEST(Paint, RefusesMaterialsThatThereAreNot) {
  const std::string rest = ", brush: {sphere: {radius: 0.5}}, path: [[0, 0, 0]]}";
  for (const char* bad : {"{op: paint", "{op: paint, material: 1.5", "{op: paint, material: 256",
                          "{op: paint, material: -1", "{op: paint, material: red"}) {
    EXPECT_THROW((void)parse_stroke(bad + rest, "test"), Error) << bad;
  }
  Sculptor sculptor(ball_grid(12));
  EXPECT_THROW((void)sculptor.apply(paint_stroke({12, 0, 0}, 3, 256), Job()), Error);
}

}  // namespace
}  // namespace sdfgrid
