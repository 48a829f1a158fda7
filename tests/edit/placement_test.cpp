// Where strokes go: brushes scaled by the pressure, mirrored ones, and those that the range cuts.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "app/process.h"
#include "edit/grids.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/field_brush.h"
#include "sdfgrid/edit/sculptor.h"
#include "sdfgrid/edit/stroke_file.h"
#include "sdfgrid/grid/bricks.h"
#include "sdfgrid/grid/vdb.h"
#include "sdfgrid/scene/stamp.h"

namespace sdfgrid {
namespace {

using namespace sdfgrid::test;
constexpr int kExtent = 30;
constexpr double kVoxel = 0.1;

Stroke shaped(StrokeOp op, const Field& field, const glm::dvec3& at, double pressure = 1) {
  Stroke stroke;
  stroke.op = op;
  stroke.brush.shape = make_brush(field, true);
  stroke.path = {{at * kVoxel, pressure}};
  return stroke;
}

Content sculpted(const Stroke& stroke, int extent = kExtent) {
  const Grid grid = ball_grid(15);
  Sculptor sculptor(grid);
  (void)sculptor.apply(stroke, Job());
  return content_of(grid, extent);
}

// A brush of unequal sides away from its origin, so that nothing but the origin can be the centre.
Field bar(double scale) {
  return make_field("capsule", {{"from", {0.2 * scale, 0.1 * scale, 0.0}},
                                {"to", {1.2 * scale, 0.3 * scale, -0.5 * scale}},
                                {"radius", 0.4 * scale}});
}

TEST(Pressure, ScalesAShapeAboutItsOrigin) {
  for (const double pressure : {0.75, 0.5, 0.2}) {
    for (const StrokeOp op : {StrokeOp::unite, StrokeOp::subtract, StrokeOp::intersect}) {
      const Content pressed = sculpted(shaped(op, bar(1), {10, 3, -4}, pressure));
      const Content small = sculpted(shaped(op, bar(pressure), {10, 3, -4}));
      ASSERT_EQ(pressed.size(), small.size());
      int inside = 0;
      for (std::size_t i = 0; i < small.size(); ++i) {
        ASSERT_NEAR(pressed[i].first, small[i].first, 1e-3 * kVoxel) << i << " " << pressure;
        inside += small[i].first < 0 ? 1 : 0;
      }
      EXPECT_GT(inside, 5);
    }
  }
}

// Along a path, too, and mirrored; its reach shrinks with it.
TEST(Pressure, FollowsThePath) {
  Stroke stroke =
      shaped(StrokeOp::unite, make_field("box", {{"size", {0.8, 0.8, 0.8}}}), {0, 0, 21}, 1);
  stroke.path.push_back({glm::dvec3(2.4, 0, 2.1), 0.25});
  stroke.spacing = 0.05;
  stroke.mirror = {{1, -0.8}};
  const Grid grid = ball_grid(15);
  Sculptor sculptor(grid);
  (void)sculptor.apply(stroke, Job());
  for (const double y : {0.0, -16.0}) {
    // The half edge falls from 4 voxels at x = 0 to 1 at x = 24; that of the first box which
    // reaches x counts.
    for (int x = 0; x <= 24; ++x) {
      const double half = 4 - std::max(x - 4.0, 0.0) / 7;
      const int in = static_cast<int>(std::floor(half - 0.3));
      const int out = static_cast<int>(std::ceil(half + 0.3));
      EXPECT_LT(grid.value({x, static_cast<int>(y), 21 + in}), 0) << x;
      EXPECT_GT(grid.value({x, static_cast<int>(y), 21 + out}), 0) << x;
    }
  }
}

// A grid of half the size, whose own samples are then those of no lattice point.
TEST(Pressure, ScalesStamps) {
  Folder folder;
  write_grid(ball_grid(12), folder.path("ball.vdb"));
  const Job job;
  FileStamps stamps(job);
  const Grid grid = ball_grid(12);
  Sculptor sculptor(grid);
  (void)sculptor.apply(parse_stroke("{op: stamp, brush: {grid: {file: ball.vdb}}, "
                                    "path: [[1.4, 0, 0, 0.5]]}",
                                    "test", {&stamps, folder.path(""), false}),
                       job);
  const TwoBalls balls{{0, 0, 0}, {14, 0, 0}, 12, 6};
  for (int x = -16; x <= 24; ++x) {
    for (int y = -14; y <= 14; ++y) {
      const glm::dvec3 p(x, y, 1);
      const double truth = balls.unite(p);
      const double got = grid.value({x, y, 1}) / kVoxel;
      if (std::abs(truth) > 0.05) {
        ASSERT_EQ(got < 0, truth < 0) << x << " " << y;
      }
      if (balls.to_crease(p) < std::abs(truth) + 2) continue;
      ASSERT_NEAR(got, glm::clamp(truth, -3.0, 3.0), 0.05) << x << " " << y;
    }
  }
}

Content clay(StrokeOp op, const std::vector<PathPoint>& path, std::vector<MirrorPlane> mirror) {
  Stroke stroke = ball_stroke(op, {0, 0, 0}, 6);
  stroke.path = path;
  stroke.mirror = std::move(mirror);
  return sculpted(stroke);
}

// A dab on the plane is its own image, and a path across it puts down each pair of dabs once.
TEST(Mirrors, WhatIsThereAlreadyIsPutDownOnce) {
  const std::vector<PathPoint> on_plane = {{{0, 0, 1.5}}};
  const std::vector<PathPoint> across = {{{-0.4, 0, 1.5}, 0.5}, {{0.4, 0, 1.5}, 0.5}};
  const std::vector<PathPoint> corner = {{{0, 0, 1.5}}};
  for (const StrokeOp op : {StrokeOp::inflate, StrokeOp::flatten, StrokeOp::subtract}) {
    EXPECT_EQ(clay(op, on_plane, {}), clay(op, on_plane, {{0, 0.0}}));
    EXPECT_EQ(clay(op, across, {}), clay(op, across, {{0, 0.0}}));
    EXPECT_EQ(clay(op, corner, {}), clay(op, corner, {{0, 0.0}, {1, 0.0}}));
    // Beside the plane it is two, and the same plane named twice is one.
    const std::vector<PathPoint> beside = {{{0.3, 0, 1.47}}};
    EXPECT_NE(clay(op, beside, {}), clay(op, beside, {{0, 0.0}}));
    EXPECT_EQ(clay(op, beside, {{0, 0.0}}), clay(op, beside, {{0, 0.0}, {0, 0.0}}));
  }
}

TEST(Mirrors, FlattenHasAPlaneForEachImage) {
  // The path begins on the mirror plane, so the image of its first dab is left out.
  Stroke stroke = ball_stroke(StrokeOp::flatten, {0, 0, 14.5}, 6);
  stroke.path.push_back({{0.9, 0, 1.1}});
  stroke.strength = 1;
  stroke.mirror = {{0, 0.0}};
  const Grid grid = ball_grid(15);
  (void)Sculptor(grid).apply(stroke, Job());
  for (int x = 4; x <= 12; ++x) {
    EXPECT_NEAR(grid.value({x, 0, 12}), grid.value({-x, 0, 12}), 0.05) << x;
  }
}

TEST(Mirrors, TooManyOrEndlessOnesAreRefused) {
  Sculptor sculptor(ball_grid(15));
  Stroke stroke = ball_stroke(StrokeOp::unite, {0, 0, 15}, 4);
  stroke.mirror = {{0, NAN}};
  EXPECT_THROW((void)sculptor.apply(stroke, Job()), Error);
  stroke.mirror.clear();
  for (int i = 0; i < 60; ++i) stroke.mirror.push_back({0, std::exp2(i)});
  EXPECT_THROW((void)sculptor.apply(stroke, Job()), Error);
}

// The estimate that refuses strokes is of the bricks that there are in the range.
TEST(Range, WhatIsBeyondItCostsNothing) {
  const Grid grid = ball_grid(15);
  SculptOptions options;
  options.max_bricks = 5000;
  Sculptor sculptor(grid, options);  // whose range has 23 bricks a side at most
  options.max_bricks = 20000;
  Sculptor roomy(grid, options);
  const Field half = make_field("box", {{"size", {1000, 1000, 1000}}});
  EXPECT_THROW((void)sculptor.apply(shaped(StrokeOp::subtract, half, {0, 0, 5000}), Job()), Error);
  (void)roomy.apply(shaped(StrokeOp::subtract, half, {0, 0, 5000}), Job());
  for (int z = -18; z <= 18; ++z) {
    const double truth = glm::clamp(std::max(-15.0 - z, z * 1.0), -3.0, 3.0);
    EXPECT_NEAR(grid.value({0, 0, z}) / kVoxel, truth, 1e-3) << z;
  }
}

// A ball swept over a million voxels past the model is as exact as one over a hundred, and its
// dabs, of which it needs none, are no reason to refuse it.
TEST(Range, LongSweepsAreExact) {
  for (const double end : {60.0, 1e6, 1e8}) {
    Stroke stroke = ball_stroke(StrokeOp::subtract, {-end, 0.3, 4}, 5);
    stroke.path.push_back({glm::dvec3(end, 0.3, 4) * kVoxel});
    stroke.spacing = 1e-3;
    const Grid grid = ball_grid(15);
    (void)Sculptor(grid).apply(stroke, Job());
    for (int y = -8; y <= 8; ++y) {
      const double bore = 5 - std::hypot(y - 0.3, 3 - 4);
      EXPECT_NEAR(grid.value({0, y, 3}) / kVoxel, glm::clamp(bore, -3.0, 3.0), 1e-3) << y;
    }
  }
  Stroke stroke = ball_stroke(StrokeOp::subtract, {0, 0, 0}, 5);
  stroke.path.push_back({glm::dvec3(1e12, 0, 0)});
  EXPECT_THROW((void)Sculptor(ball_grid(15)).apply(stroke, Job()), Error);
}

// Coordinates in which the voxels are the last of eight digits.
TEST(Range, TheWarningTellsVoxelsApart) {
  Grid grid = ball_grid(15);
  SculptOptions options;
  options.range = {{4000000, -25, -25}, {4000051, 25, 25}};
  const StrokeReport report =
      Sculptor(grid, options).apply(ball_stroke(StrokeOp::unite, {4000051, 0, 0}, 6), Job());
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_NE(report.warnings[0].find("400005.1"), std::string::npos) << report.warnings[0];
}

// Leaves, and tiles of every level, in a box that cuts through them, as looking each brick up says.
TEST(Range, AnIntersectionFindsAllThatIsThere) {
  const Grid grid = ball_grid(15);
  openvdb::FloatTree& tree = vdb(grid)->tree();
  tree.addTile(1, {40, 0, 0}, -0.3F, false);
  tree.addTile(2, {-256, 0, 128}, -0.3F, false);
  tree.addTile(2, {128, 128, 0}, 0.3F, false);
  tree.addTile(3, {4096, 0, 0}, -0.3F, false);
  for (const auto& [first, last] : {std::pair(glm::ivec3(-40, -5, -3), glm::ivec3(20, 10, 25)),
                                    std::pair(glm::ivec3(-2, 0, 1), glm::ivec3(1, 1, 1)),
                                    std::pair(glm::ivec3(510, -1, -2), glm::ivec3(515, 2, 1)),
                                    std::pair(glm::ivec3(60, 60, 60), glm::ivec3(62, 62, 62))}) {
    std::vector<glm::ivec3> expected;
    const GridBricks bricks(grid);
    for (int x = first.x; x <= last.x; ++x) {
      for (int y = first.y; y <= last.y; ++y) {
        for (int z = first.z; z <= last.z; ++z) {
          const GridBrick brick = bricks.find({x, y, z});
          if (brick.values != nullptr || brick.constant < 0.3F) expected.emplace_back(x, y, z);
        }
      }
    }
    EXPECT_EQ(bricks_below(grid, first, last, 0.3F), expected);
  }
}

// Of every op and a ball, a box and a bound: too small a brush is said to be so and is right, too
// large a one is refused with the estimate, and nothing is left behind.
TEST(Sizes, AreRefusedOrWarnedOfWhateverTheOp) {
  for (int i = 0; i <= static_cast<int>(StrokeOp::paint); ++i) {
    const auto op = static_cast<StrokeOp>(i);
    for (const std::string kind : {"ball", "box", "twist"}) {
      const auto make = [&](double radius) {  // voxels
        Stroke stroke = ball_stroke(op, {15, 0, 0}, radius);
        stroke.material = 1;
        if (kind == "ball") return stroke;
        const double edge = 2 * radius * kVoxel / std::sqrt(3.0);
        const Field box = make_field("box", {{"size", {edge, edge, edge}}});
        const Field turned = make_field("twist", {{"turns", 0.1 / edge}}, {box});
        stroke.brush.shape = make_brush(kind == "box" ? box : turned, kind == "box");
        return stroke;
      };
      const std::string what = std::string(stroke_op_word(op)) + " " + kind;
      const Grid grid = ball_grid(15);
      const Content before = content_of(grid, kExtent);
      Sculptor sculptor(grid);
      try {
        (void)sculptor.apply(make(1e6), Job());
        ADD_FAILURE() << "not refused: " << what;
      } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::usage);
        EXPECT_NE(std::string(e.what()).find("bricks ("), std::string::npos) << e.what();
      }
      if (kind == "ball") {
        EXPECT_THROW((void)sculptor.apply(make(0), Job()), Error) << what;
      }
      EXPECT_EQ(sculptor.history().undoable(), 0U);
      EXPECT_EQ(content_of(grid, kExtent), before) << what;
      const StrokeReport report = sculptor.apply(make(0.6), Job());
      ASSERT_EQ(report.warnings.size(), 1U) << what;
      EXPECT_NE(report.warnings[0].find("below one voxel"), std::string::npos);
      if (op == StrokeOp::intersect) continue;
      // Only the sample in its middle can be on another side than before.
      const Content after = content_of(grid, kExtent);
      int turned = 0;
      for (std::size_t s = 0; s < after.size(); ++s) {
        turned += (after[s].first < 0) != (before[s].first < 0) ? 1 : 0;
      }
      EXPECT_LE(turned, 1) << what;
      if (op == StrokeOp::subtract) {
        EXPECT_GE(grid.value({15, 0, 0}), 0) << what;
      }
    }
  }
}

}  // namespace
}  // namespace sdfgrid
