// After a stroke the grid is a distance field again: against brute force to the surface that it
// holds.
#include "sdfgrid/edit/redistance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>
#include <random>

#include "edit/grids.h"
#include "edit/surface_oracle.h"
#include "sdfgrid/edit/sculptor.h"

namespace sdfgrid {
namespace {

using namespace sdfgrid::test;

// Samples nearer than this to the surface define it, and are never measured.
constexpr double kBeside = 1.0;

struct BandErrors {
  double smooth = 0;  // worst where the nearest surface is smooth, voxels
  double crease = 0;  // and where it is bent sharply
  double beyond = 0;  // worst where the surface is further than the band
  double slope = 0;   // worst difference of the gradient's length from one, where it is smooth
  double beside_slope = 0;  // the same within a voxel of the surface
  int samples = 0;
  int smooth_samples = 0;
};

// By central differences of the oracle's distances; nothing if one of those is to a crease.
std::optional<double> true_slope(const SurfaceOracle& oracle, const Grid& grid,
                                 const glm::ivec3& p) {
  glm::dvec3 g(0.0);
  for (int i = 0; i < 6; ++i) {
    glm::ivec3 step(0);
    step[i / 2] = i % 2 == 0 ? 1 : -1;
    const auto beside = oracle.nearest(glm::dvec3(p + step), 6);
    if (beside.crease) return std::nullopt;
    g[i / 2] += (grid.value(p + step) < 0 ? -0.5 : 0.5) * step[i / 2] * beside.distance;
  }
  return glm::length(g);
}

// Of every `stride`-th sample of the band. Creases are where the oracle sees them, and where
// `crease` says so of a surface point.
BandErrors band_errors(const Grid& grid, int extent, int stride,
                       const std::function<bool(const glm::dvec3&)>& crease) {
  BandErrors e;
  const double voxel = grid.lattice().voxel;
  const double limit = grid.background() / voxel;
  const SurfaceOracle oracle(grid, extent, 5);
  const auto at = [&](int x, int y, int z) { return grid.value({x, y, z}) / voxel; };
  int count = 0;
  for (int x = -extent + 4; x < extent - 4; ++x) {
    for (int y = -extent + 4; y < extent - 4; ++y) {
      for (int z = -extent + 4; z < extent - 4; ++z) {
        const double got = at(x, y, z);
        if (++count % stride != 0) continue;
        auto truth = oracle.nearest(glm::dvec3(x, y, z), limit + 0.5);
        truth.crease = truth.crease || crease(truth.point);
        if (truth.distance > limit + 0.4) {
          e.beyond = std::max(e.beyond, limit - std::abs(got));
          continue;
        }
        const bool beside = truth.distance < kBeside;
        if (beside && truth.crease) continue;
        const double error = std::abs(std::abs(got) - std::min(truth.distance, limit));
        ++e.samples;
        e.smooth_samples += truth.crease ? 0 : 1;
        double& worst = truth.crease ? e.crease : e.smooth;
        if (!beside) worst = std::max(worst, error);
        if (truth.crease || truth.distance > limit - 1.2) continue;
        const glm::dvec3 g(at(x + 1, y, z) - at(x - 1, y, z), at(x, y + 1, z) - at(x, y - 1, z),
                           at(x, y, z + 1) - at(x, y, z - 1));
        double slope = std::abs(0.5 * glm::length(g) - 1);
        // Half-way between two sheets true distances have no slope of one either.
        if (slope > 0.05) {
          const auto expected = true_slope(oracle, grid, {x, y, z});
          slope = expected ? std::abs(0.5 * glm::length(g) - *expected) : 0;
        }
        double& steepest = beside ? e.beside_slope : e.slope;
        steepest = std::max(steepest, slope);
      }
    }
  }
  return e;
}

TwoBalls two_balls() { return {{0, 0, 0}, {13.3, 5.1, -3.7}, 16.2, 10.3}; }

BandErrors errors_of(StrokeOp op, Redistance redistance) {
  const TwoBalls balls = two_balls();
  const Grid grid = ball_grid(balls.ra);
  SculptOptions options;
  options.redistance = redistance;
  Sculptor sculptor(grid, options);
  (void)sculptor.apply(ball_stroke(op, balls.b, balls.rb), Job());
  return band_errors(grid, 30, 3, [&](const glm::dvec3& p) { return balls.to_crease(p) < 2; });
}

TEST(Redistance, OneStrokeLeavesADistanceField) {
  for (const StrokeOp op : {StrokeOp::unite, StrokeOp::subtract, StrokeOp::intersect}) {
    for (const Redistance redistance : {Redistance::local, Redistance::full}) {
      const BandErrors e = errors_of(op, redistance);
      EXPECT_GT(e.samples, 1000) << stroke_op_word(op);
      EXPECT_LT(e.smooth, 0.05) << stroke_op_word(op);
      EXPECT_LT(e.beyond, 0.05) << stroke_op_word(op);
      EXPECT_LT(e.crease, 0.2) << stroke_op_word(op);
    }
    // Without it the bounds are off: the test would see it.
    EXPECT_GT(errors_of(op, Redistance::off).crease, 0.5) << stroke_op_word(op);
  }
}

// What the grid says in closed form: the sign everywhere, and the distance away from the crease.
TEST(Redistance, SignsAreRightAndSmoothPartsExact) {
  const TwoBalls balls = two_balls();
  for (const double width : {1.5, 3.0, 6.0}) {
    const Grid grid = ball_grid(balls.ra, 0.1, width);
    Sculptor sculptor(grid);
    (void)sculptor.apply(ball_stroke(StrokeOp::subtract, balls.b, balls.rb), Job());
    double worst = 0;
    for (int x = -30; x <= 30; ++x) {
      for (int y = -30; y <= 30; ++y) {
        for (int z = -30; z <= 30; ++z) {
          const glm::dvec3 p(x, y, z);
          const double got = grid.value({x, y, z}) / 0.1;
          const double truth = balls.subtract(p);
          if (std::abs(truth) > 1e-4) {
            ASSERT_EQ(got < 0, truth < 0) << x << " " << y << " " << z;
          }
          if (balls.to_crease(p) < std::abs(truth) + 1.5) continue;
          worst = std::max(worst, std::abs(got - glm::clamp(truth, -width, width)));
        }
      }
    }
    // Exact, or measured to the trilinear surface, which is by 1 / (4 radius) off at most.
    EXPECT_LT(worst, 0.025) << width;
  }
}

// The requirement of the project: a thousand random strokes, and still a distance field. Away from
// creases means: no other ball's surface within two voxels of the nearest point, at any angle.
void carve_a_thousand(double least_radius, double largest_radius) {
  const Grid grid = ball_grid(28);
  Sculptor sculptor(grid);
  std::vector<CarvedBalls::Ball> balls = {{glm::dvec3(0.0), 28, true}};
  std::mt19937 random(42);
  std::normal_distribution<double> direction;
  std::uniform_real_distribution<double> radius(least_radius, largest_radius);
  std::uniform_real_distribution<double> depth(24, 34);
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 d(direction(random), direction(random), direction(random));
    const auto op = i % 2 == 0 ? StrokeOp::unite : StrokeOp::subtract;
    const glm::dvec3 at = depth(random) * glm::normalize(d);
    balls.push_back({at, radius(random), op == StrokeOp::unite});
    (void)sculptor.apply(ball_stroke(op, at, balls.back().radius), Job());
  }
  const CarvedBalls carved(balls);
  const BandErrors e =
      band_errors(grid, 52, 5, [&](const glm::dvec3& p) { return carved.crease(p, 2); });
  EXPECT_GT(e.samples, 5000);
  EXPECT_GT(e.smooth_samples, 1000);
  EXPECT_LT(e.smooth, 0.05);
  EXPECT_LT(e.beyond, 0.05);
  EXPECT_LT(e.slope, 0.05);
  EXPECT_LT(e.beside_slope, 0.05);
  EXPECT_LT(e.crease, 0.35);
}

TEST(Redistance, AThousandStrokesLeaveADistanceField) { carve_a_thousand(8, 13); }
TEST(Redistance, AThousandSmallStrokesLeaveADistanceField) { carve_a_thousand(5, 9); }

// All samples of all bricks, as full re-distancing takes them.
std::vector<RedistanceTask> everything(const Grid& grid) {
  std::vector<RedistanceTask> tasks;
  const GridBricks bricks(grid);
  for (const glm::ivec3& brick : all_bricks(grid)) {
    RedistanceTask task;
    task.brick = brick;
    for (int word = 0; word < 8; ++word) task.suspect[word] = bricks.find(brick).active[word];
    tasks.push_back(task);
  }
  return tasks;
}

void remeasure(const Grid& grid) {
  const GridBricks bricks(grid);
  const auto found =
      redistance(bricks, grid.lattice().voxel, band_limits(grid), everything(grid), Job());
  for (const RedistancedBrick& brick : found) {
    const GridBrick now = bricks.find(brick.change.brick);
    std::copy(std::begin(brick.values), std::end(brick.values), now.values);
    std::copy(std::begin(brick.active), std::end(brick.active), now.active);
  }
}

// A hundred times over nothing moves: neither the surface nor the band around it.
TEST(Redistance, DoesNotDrift) {
  const TwoBalls balls = two_balls();
  const Grid grid = ball_grid(balls.ra);
  Sculptor sculptor(grid);
  (void)sculptor.apply(ball_stroke(StrokeOp::subtract, balls.b, balls.rb), Job());
  const Grid before = grid.clone();
  for (int i = 0; i < 100; ++i) remeasure(grid);
  double surface = 0;
  for (int x = -30; x < 30; ++x) {
    for (int y = -30; y < 30; ++y) {
      for (int z = -30; z < 30; ++z) {
        const double a = before.value({x, y, z});
        const double b = before.value({x, y, z + 1});
        const double now_a = grid.value({x, y, z});
        const double now_b = grid.value({x, y, z + 1});
        ASSERT_EQ(a < 0, now_a < 0);
        if ((a < 0) == (b < 0)) continue;
        surface = std::max(surface, std::abs(a / (a - b) - now_a / (now_a - now_b)));
      }
    }
  }
  EXPECT_EQ(surface, 0);  // 0.01 voxel is required
  const BandErrors e =
      band_errors(grid, 30, 3, [&](const glm::dvec3& p) { return balls.to_crease(p) < 2; });
  EXPECT_LT(e.smooth, 0.05);
}

}  // namespace
}  // namespace sdfgrid
