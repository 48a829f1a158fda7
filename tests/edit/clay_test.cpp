// Clay tools: each moves the surface the way it says, within its reach only, and leaves distances.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "edit/grids.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/sculptor.h"

namespace sdfgrid {
namespace {

using namespace sdfgrid::test;
constexpr int kExtent = 30;

Stroke clay(StrokeOp op, const glm::dvec3& at, double radius, double strength) {
  Stroke stroke = ball_stroke(op, at, radius);
  stroke.strength = strength;
  return stroke;
}

// Where the surface is along the positive x axis, voxels.
double surface_on_x(const Grid& grid) {
  for (int x = kExtent; x > 0; --x) {
    const double a = grid.value({x - 1, 0, 0});
    const double b = grid.value({x, 0, 0});
    if (a < 0 && b >= 0) return x - 1 + a / (a - b);
  }
  return 0;
}

double volume(const Grid& grid) {
  double sum = 0;
  for (const auto& [value, active] : content_of(grid, kExtent)) {
    sum += glm::clamp(0.5 - value / 0.1, 0.0, 1.0);
  }
  return sum;
}

TEST(Clay, InflateAndDeflateMoveTheSurface) {
  for (const StrokeOp op : {StrokeOp::inflate, StrokeOp::deflate}) {
    const Grid grid = ball_grid(15);
    const Content before = content_of(grid, kExtent);
    Sculptor sculptor(grid);
    (void)sculptor.apply(clay(op, {15, 0, 0}, 8, 0.5), Job());
    // By strength times one voxel in the middle of the dab, where its weight is one.
    const double moved = surface_on_x(grid) - 15;
    EXPECT_NEAR(moved, op == StrokeOp::inflate ? 0.5 : -0.5, 0.05);
    // The other side of the ball is as it was.
    EXPECT_EQ(grid.value({-15, 2, 1}), ball_grid(15).value({-15, 2, 1}));
    ASSERT_TRUE(sculptor.undo());
    EXPECT_EQ(content_of(grid, kExtent), before);
  }
}

TEST(Clay, ManyDabsAddUpAndStayDistances) {
  const Grid grid = ball_grid(15);
  Sculptor sculptor(grid);
  for (int i = 0; i < 10; ++i)
    (void)sculptor.apply(clay(StrokeOp::inflate, {15, 0, 0}, 9, 0.5), Job());
  EXPECT_GT(surface_on_x(grid), 17);
  // Along the axis the field has slope one through the whole band.
  const double surface = surface_on_x(grid);
  for (int x = static_cast<int>(surface) - 1; x <= static_cast<int>(surface) + 2; ++x) {
    EXPECT_NEAR(grid.value({x, 0, 0}) / 0.1, x - surface, 0.06) << x;
  }
}

TEST(Clay, SmoothTakesBumpsAway) {
  const auto bumpy = [](const glm::dvec3& p) {
    const double r = glm::length(p);
    const double bump = r > 1e-9 ? 0.4 * std::sin(p.y * 1.6) * std::sin(p.z * 1.6) : 0;
    return r - 15 - bump;
  };
  const Grid grid = make_grid(bumpy, 22, 0.1);
  const auto roughness = [&] {
    double sum = 0;
    for (int y = -3; y <= 3; ++y) {
      for (int z = -3; z <= 3; ++z) {
        const double round = std::sqrt(225.0 + y * y + z * z);
        const double d = grid.value({15, y, z}) / 0.1 - (round - 15);
        sum += d * d;
      }
    }
    return sum;
  };
  const double before = roughness();
  Sculptor sculptor(grid);
  for (int i = 0; i < 4; ++i)
    (void)sculptor.apply(clay(StrokeOp::smooth, {15, 0, 0}, 10, 1), Job());
  EXPECT_LT(roughness(), 0.3 * before);
}

TEST(Clay, FlattenMovesTheSurfaceToThePlane) {
  const Grid grid = ball_grid(15);
  Sculptor sculptor(grid);
  const double full = volume(grid);
  for (int i = 0; i < 12; ++i)
    (void)sculptor.apply(clay(StrokeOp::flatten, {13, 0, 0}, 9, 1), Job());
  // A cap of the ball is gone, and the plane stands where the path began.
  EXPECT_LT(volume(grid), full - 20);
  EXPECT_NEAR(surface_on_x(grid), 13, 0.4);
}

TEST(Clay, PinchSharpensARidge) {
  // A rounded ridge along y; a cut below its top is narrower after the pinch.
  const auto ridge = [](const glm::dvec3& p) {
    const double x = std::abs(p.x);
    return std::max(0.7 * (x + p.z - 8), glm::length(p) - 18);
  };
  const auto width = [](const Grid& grid) {
    int inside = 0;
    for (int x = -8; x <= 8; ++x) inside += grid.value({x, 0, 4}) < 0 ? 1 : 0;
    return inside;
  };
  const Grid grid = make_grid(ridge, 22, 0.1);
  const int before = width(grid);
  Sculptor sculptor(grid);
  for (int i = 0; i < 6; ++i) (void)sculptor.apply(clay(StrokeOp::pinch, {0, 0, 4}, 10, 1), Job());
  EXPECT_LT(width(grid), before);
}

TEST(Clay, SpaceWithoutASurfaceStaysEmpty) {
  const Grid grid = ball_grid(15);
  Sculptor sculptor(grid);
  const std::size_t bricks = grid.bricks();
  (void)sculptor.apply(clay(StrokeOp::inflate, {45, 0, 0}, 9, 1), Job());
  EXPECT_EQ(grid.bricks(), bricks);
  EXPECT_THROW((void)sculptor.apply(clay(StrokeOp::flatten, {45, 0, 0}, 9, 1), Job()), Error);
}

// A sample at the band's limit says only that there is no surface near: no tool makes matter or
// holes of it, not even where distances are never measured anew.
TEST(Clay, BoundsAreNotMovedAsIfTheyWereDistances) {
  for (const Redistance redistance : {Redistance::off, Redistance::local}) {
    SculptOptions options;
    options.redistance = redistance;
    for (const StrokeOp op :
         {StrokeOp::inflate, StrokeOp::deflate, StrokeOp::smooth, StrokeOp::pinch}) {
      for (const glm::dvec3& at : {glm::dvec3(0, 0, 0), glm::dvec3(32, 0, 0)}) {
        const Grid grid = ball_grid(20);
        const Content before = content_of(grid, 40);
        Sculptor sculptor(grid, options);
        for (int i = 0; i < 8; ++i) (void)sculptor.apply(clay(op, at, 8, 1), Job());
        const Content after = content_of(grid, 40);
        double worst = 0;
        for (std::size_t i = 0; i < before.size(); ++i) {
          worst = std::max(worst, std::abs(double(after[i].first) - before[i].first) / 0.1);
        }
        // What is measured anew around the dab is a distance to the trilinear surface.
        EXPECT_LT(worst, redistance == Redistance::off ? 1e-9 : 0.03)
            << stroke_op_word(op) << " " << at.x;
      }
    }
  }
}

// Where there is a surface, bounds move it as far as distances do, whatever the strength.
TEST(Clay, WithoutReDistancingTheSurfaceMovesAsFar) {
  for (const StrokeOp op : {StrokeOp::inflate, StrokeOp::deflate}) {
    for (const double strength : {0.1, 0.5, 1.0}) {
      const int dabs = static_cast<int>(std::round(5 / strength));
      double moved[2];
      for (const Redistance redistance : {Redistance::off, Redistance::local}) {
        const Grid grid = ball_grid(15);
        SculptOptions options;
        options.redistance = redistance;
        Sculptor sculptor(grid, options);
        for (int i = 0; i < dabs; ++i) {
          (void)sculptor.apply(clay(op, {15, 0, 0}, 12, strength), Job());
        }
        moved[redistance == Redistance::off ? 0 : 1] = surface_on_x(grid) - 15;
      }
      EXPECT_GT(std::abs(moved[1]), 3) << strength;
      EXPECT_NEAR(moved[0], moved[1], 1) << strength;
    }
  }
}

// Growth ends at the range, closed, as that of a union does.
TEST(Clay, EndsAtTheRange) {
  for (const StrokeOp op :
       {StrokeOp::inflate, StrokeOp::smooth, StrokeOp::pinch, StrokeOp::flatten}) {
    for (const Redistance redistance : {Redistance::local, Redistance::off}) {
      const Grid grid = ball_grid(15);
      SculptOptions options;
      options.redistance = redistance;
      options.range = {{-25, -25, -25}, {25, 25, 25}};
      Sculptor sculptor(grid, options);
      Stroke stroke = clay(op, {15, 0, 0}, 12, 1);
      if (op == StrokeOp::flatten) stroke.path = {{{0, 0, 1.5}}, {{1.2, 0, 1.2}}};
      for (int i = 0; i < 16; ++i) {
        const StrokeReport report = sculptor.apply(stroke, Job());
        ASSERT_EQ(report.warnings.size(), 1U);
      }
      glm::ivec3 lo;
      glm::ivec3 hi;
      grid.active_bounds(lo, hi);
      EXPECT_LE(std::max({hi.x, hi.y, hi.z}), 25) << stroke_op_word(op);
      for (int y = -25; y <= 25; ++y) {
        for (int z = -25; z <= 25; ++z) {
          ASSERT_GT(grid.value({22, y, z}), 0) << stroke_op_word(op) << " " << y << " " << z;
        }
      }
      if (op == StrokeOp::inflate) {
        EXPECT_GT(surface_on_x(grid), 20);
      }
    }
  }
}

}  // namespace
}  // namespace sdfgrid
