// Stroke files: what they say, what is refused, and brushes that are fields.
#include "sdfgrid/edit/stroke_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "edit/grids.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/sculptor.h"

namespace sdfgrid {
namespace {

using namespace sdfgrid::test;

TEST(StrokeFile, ReadsEveryWord) {
  const StrokeFile file = parse_strokes(R"(
sdfgrid-strokes: 1
strokes:
  - {op: union, brush: {sphere: {radius: 0.05}}, path: [[0,0,1], [0.2,0,1,0.5]], spacing: 0.3}
  - {op: difference, brush: {box: {size: [0.1,0.1,0.4]}}, path: [[0,1,0]], smooth: 0.02, mirror: [x]}
  - op: pinch
    name: a spot
    brush: {sphere: {radius: 1}}
    path: [[1, 2, 3]]
    strength: 0.25
    mirror: [{z: 0.5}, y]
)",
                                        "test");
  ASSERT_EQ(file.strokes.size(), 3U);
  EXPECT_TRUE(file.warnings.empty());
  const Stroke& a = file.strokes[0];
  EXPECT_EQ(a.op, StrokeOp::unite);
  EXPECT_EQ(a.brush.radius, 0.05);
  ASSERT_EQ(a.path.size(), 2U);
  EXPECT_EQ(a.path[0].pressure, 1);
  EXPECT_EQ(a.path[1].at, glm::dvec3(0.2, 0, 1));
  EXPECT_EQ(a.path[1].pressure, 0.5);
  EXPECT_EQ(a.spacing, 0.3);
  const Stroke& b = file.strokes[1];
  EXPECT_EQ(b.op, StrokeOp::subtract);
  ASSERT_NE(b.brush.shape, nullptr);
  EXPECT_TRUE(b.brush.shape->exact);
  EXPECT_EQ(b.smooth, 0.02);
  EXPECT_EQ(b.mirror[0].axis, 0);
  const Stroke& c = file.strokes[2];
  EXPECT_EQ(c.op, StrokeOp::pinch);
  EXPECT_EQ(c.strength, 0.25);
  EXPECT_EQ(c.mirror[0].axis, 2);
  EXPECT_EQ(c.mirror[0].at, 0.5);
  EXPECT_EQ(c.mirror[1].axis, 1);
}

TEST(StrokeFile, TheTextOfAStrokeMakesItAgain) {
  const StrokeFile file = parse_strokes(R"(
sdfgrid-strokes: 1
strokes:
  - op: union
    brush: {capsule: {from: [0, 0, -0.123456789012345], to: [0, 0, 1], radius: 0.1}}
    path: [[0.1, 0.2, 0.30000000000000004]]
)",
                                        "test");
  const Stroke& stroke = file.strokes[0];
  EXPECT_EQ(stroke.text.find('\n'), std::string::npos);
  const Stroke again = parse_stroke(stroke.text, "test");
  EXPECT_EQ(again.text, stroke.text);
  EXPECT_EQ(again.path[0].at, stroke.path[0].at);
  EXPECT_EQ(again.brush.shape->bounds.lo, stroke.brush.shape->bounds.lo);
}

void expect_refused(const std::string& text, const std::string& what) {
  try {
    (void)parse_strokes(text, "file.yaml");
    FAIL() << "not refused: " << what;
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::input);
    EXPECT_NE(std::string(e.what()).find(what), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("file.yaml"), std::string::npos) << e.what();
  }
}

TEST(StrokeFile, RefusesWithLineAndRemedy) {
  const std::string head = "sdfgrid-strokes: 1\nstrokes:\n  - ";
  expect_refused("", "no stroke file");
  expect_refused("sdfgrid-strokes: 2\nstrokes: []\n", "version");
  expect_refused("sdfgrid-strokes: 1\n", "no list of strokes");
  expect_refused("sdfgrid-strokes: 1\nstrokes: [\n", "line");
  expect_refused(head + "{op: union, path: [[0,0,0]]}", "no brush");
  expect_refused(head + "{op: carve, brush: {sphere: {radius: 1}}, path: [[0,0,0]]}", "line 3");
  expect_refused(head + "{op: union, brush: {sphere: {radius: big}}, path: [[0,0,0]]}", "number");
  expect_refused(head + "{op: union, brush: {spere: {radius: 1}}, path: [[0,0,0]]}", "spere");
  expect_refused(head + "{op: union, brush: {sphere: {radius: 1}}, path: [[0,0]]}", "2 numbers");
  expect_refused(head + "{op: union, brush: {sphere: {radius: 1}}, path: 3}", "path");
  expect_refused(head + "{op: union, brush: {plane: {normal: [0,0,1]}}, path: [[0,0,0]]}",
                 "no end");
  expect_refused(head + "{op: union, brush: {sphere: {radius: 1}}, path: [[0,0,0]], mirror: [w]}",
                 "axis");
}

TEST(StrokeFile, AnUnknownWordIsAWarning) {
  const StrokeFile file = parse_strokes(
      "sdfgrid-strokes: 1\nstrokes:\n"
      "  - {op: union, brush: {sphere: {radius: 1}}, path: [[0,0,0]], spcing: 2}\n",
      "file.yaml");
  ASSERT_EQ(file.warnings.size(), 1U);
  EXPECT_NE(file.warnings[0].find("line 3"), std::string::npos);
  EXPECT_NE(file.warnings[0].find("spcing"), std::string::npos);
}

// A box taken out of a ball, against the closed form where its sides are near.
TEST(StrokeFile, FieldsAreBrushes) {
  const Grid grid = ball_grid(20);
  Sculptor sculptor(grid);
  (void)sculptor.apply(
      parse_stroke("{op: difference, brush: {box: {size: [1, 1, 8]}}, path: [[0.03, 0.04, 0]]}",
                   "test"),
      Job());
  for (int z = -12; z <= 12; ++z) {
    for (int x = -7; x <= 7; ++x) {
      const double truth = 5 - std::abs(x - 0.3);
      EXPECT_NEAR(grid.value({x, 0, z}) / 0.1, glm::clamp(truth, -3.0, 3.0), 1e-4) << x << " " << z;
    }
  }
}

// Two shapes in one brush: only a bound inside, measured anew after the stroke.
TEST(StrokeFile, BoundsOfDistancesBecomeDistances) {
  const Grid grid = ball_grid(10);
  Sculptor sculptor(grid);
  const StrokeReport report = sculptor.apply(
      parse_stroke("{op: union, brush: {union: [{sphere: {radius: 0.8}}, {capsule: {from: [0,0,0], "
                   "to: [0,0,1.5], radius: 0.6}}]}, path: [[0.9, 0, 0]]}",
                   "test"),
      Job());
  EXPECT_GT(report.remeasured, 0U);
  const TwoBalls balls{{0, 0, 0}, {9, 0, 0}, 10, 8};
  for (int x = -12; x <= 20; ++x) {
    const double truth = glm::clamp(balls.unite({x, 0, -1}), -3.0, 3.0);
    if (balls.to_crease({x, 0, -1}) < std::abs(truth) + 2) continue;
    EXPECT_NEAR(grid.value({x, 0, -1}) / 0.1, truth, 0.05) << x;
  }
}

// A bound that is an eighth of the distance at its ends: cut into a ball, it must not move the
// ball's surface further away than the band is wide.
TEST(StrokeFile, AShallowBoundLeavesTheSurfaceBesideTheBrushAlone) {
  const Grid grid = ball_grid(20);
  const Content before = content_of(grid, 24);
  Sculptor sculptor(grid);
  (void)sculptor.apply(
      parse_stroke("{op: difference, brush: {ellipsoid_bound: {radii: [0.2, 1.6, 0.8]}}, path: "
                   "[[0, 0, 2]]}",
                   "test"),
      Job());
  const Content after = content_of(grid, 24);
  const Field brush = make_field("ellipsoid", {{"radii", {2, 16, 8}}});  // exact, in voxels
  int beside = 0;
  std::size_t i = 0;
  for (int x = -24; x <= 24; ++x) {
    for (int y = -24; y <= 24; ++y) {
      for (int z = -24; z <= 24; ++z, ++i) {
        const float distance = brush({x, y, z - 20});
        if (distance < -0.1F) {
          ASSERT_GT(after[i].first, 0) << x << " " << y << " " << z;
        }
        if (distance < 3.5F || std::abs(before[i].first) > 0.1F) continue;
        ASSERT_EQ(after[i].first, before[i].first) << x << " " << y << " " << z;
        ++beside;
      }
    }
  }
  EXPECT_GT(beside, 5000);
}

}  // namespace
}  // namespace sdfgrid
