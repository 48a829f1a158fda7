// Strokes on grids: what they may change and what they refuse. Their undo is in
// undo_budget_test.cpp.
#include "sdfgrid/edit/sculptor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "edit/grids.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"

namespace sdfgrid {
namespace {

using namespace sdfgrid::test;
constexpr int kExtent = 32;

TEST(Sculptor, TheSameBitsAtAnyNumberOfThreads) {
  Content contents[2];
  for (const int threads : {1, 4}) {
    const ThreadLimit limit(threads);
    const Grid grid = ball_grid(15);
    Sculptor sculptor(grid);
    for (const Stroke& stroke : random_strokes(12, 4)) (void)sculptor.apply(stroke, Job());
    contents[threads == 1 ? 0 : 1] = content_of(grid, kExtent);
  }
  EXPECT_EQ(contents[0], contents[1]);
}

TEST(Sculptor, SameStrokeTwiceChangesNothing) {
  for (const Stroke& stroke : random_strokes(10, 6, 4)) {
    const Grid grid = ball_grid(15);
    Sculptor sculptor(grid);
    (void)sculptor.apply(stroke, Job());
    const Content once = content_of(grid, kExtent);
    (void)sculptor.apply(stroke, Job());
    // Beside a crease, which the grid rounds off, the brush's own distances may take the place of
    // ones that were measured to the grid's surface; never a sign.
    const Content twice = content_of(grid, kExtent);
    int different = 0;
    for (auto a = once.begin(), b = twice.begin(); a != once.end(); ++a, ++b) {
      ASSERT_EQ(a->first < 0, b->first < 0);
      ASSERT_NEAR(a->first, b->first, 0.1 * 0.3);
      different += std::abs(a->first - b->first) > 0.1 * 0.05 ? 1 : 0;
    }
    EXPECT_LT(different, 0.01 * static_cast<double>(grid.active_voxels()));
  }
}

// (A u B) n B = B and (A - B) u (A n B) has A's surface, as far as signs say.
TEST(Sculptor, Absorption) {
  for (const Stroke& stroke : random_strokes(10, 7)) {
    const Grid grid = ball_grid(15);
    Stroke other = stroke;
    Sculptor sculptor(grid);
    other.op = StrokeOp::unite;
    (void)sculptor.apply(other, Job());
    other.op = StrokeOp::intersect;
    (void)sculptor.apply(other, Job());
    // The brush alone: united with nothing.
    const Grid alone = ball_grid(15);
    Sculptor emptied(alone);
    (void)emptied.apply(ball_stroke(StrokeOp::subtract, {0, 0, 0}, 30), Job());
    other.op = StrokeOp::unite;
    (void)emptied.apply(other, Job());
    const Content got = content_of(grid, kExtent);
    const Content expected = content_of(alone, kExtent);
    for (auto a = got.begin(), b = expected.begin(); a != got.end(); ++a, ++b) {
      if (std::abs(b->first) < 1e-6F) continue;
      ASSERT_EQ(a->first < 0, b->first < 0);
    }
  }
}

// A brush wholly within the model adds nothing, one wholly outside takes nothing away.
TEST(Sculptor, StrokesWithoutEffectTouchNothing) {
  Sculptor sculptor(ball_grid(20));
  EXPECT_EQ(sculptor.apply(ball_stroke(StrokeOp::unite, {0, 0, 0}, 8), Job()).bricks_touched, 0U);
  EXPECT_EQ(sculptor.apply(ball_stroke(StrokeOp::subtract, {60, 0, 0}, 20), Job()).bricks_touched,
            0U);
}

// Far from the band the inside is a constant that must stay inside when bricks are made there.
TEST(Sculptor, DeepInteriorIsNeverReadAsOutside) {
  const Grid grid = ball_grid(40);
  Sculptor sculptor(grid);
  const TwoBalls cavity{{0, 0, 0}, {3, -2, 5}, 40, 9};
  (void)sculptor.apply(ball_stroke(StrokeOp::subtract, cavity.b, cavity.rb), Job());
  double inner = 0;
  for (int x = -45; x <= 45; ++x) {
    for (int y = -45; y <= 45; ++y) {
      for (int z = -45; z <= 45; ++z) {
        const glm::dvec3 p(x, y, z);
        const double truth = glm::clamp(cavity.subtract(p), -3.0, 3.0);
        const double got = grid.value({x, y, z}) / 0.1;
        if (std::abs(truth) > 1e-4) {
          ASSERT_EQ(got < 0, truth < 0) << x << " " << y << " " << z;
        }
        inner = std::max(inner, std::abs(got - truth));
      }
    }
  }
  EXPECT_LT(inner, 1e-4);
}

TEST(Sculptor, BricksThatBecomeConstantAreDropped) {
  const Grid grid = ball_grid(12);
  Sculptor sculptor(grid);
  (void)sculptor.apply(ball_stroke(StrokeOp::subtract, {0, 0, 0}, 25), Job());
  EXPECT_EQ(grid.bricks(), 0U);
  EXPECT_EQ(grid.active_voxels(), 0U);
  (void)sculptor.apply(ball_stroke(StrokeOp::unite, {2, 3, 4}, 10), Job());
  EXPECT_GT(grid.bricks(), 8U);
  sculptor.undo();
  sculptor.undo();
  EXPECT_GT(grid.active_voxels(), 1000U);
}

// To the tolerance of re-distancing: which of two equally near points is taken has no symmetry.
TEST(Sculptor, MirroredStrokesAreMirrorImages) {
  const Grid grid = ball_grid(15);
  Sculptor sculptor(grid);
  Stroke stroke = ball_stroke(StrokeOp::subtract, {11.31, 6.17, 4.09}, 5.3);
  stroke.path.push_back({{1.213, 0.107, 0.811}, 0.7});
  stroke.mirror = {{0, 0.0}, {1, 0.0}};
  const StrokeReport report = sculptor.apply(stroke, Job());
  EXPECT_EQ(report.dabs % 4, 0U);
  for (int x = -20; x <= 20; ++x) {
    for (int y = -20; y <= 20; ++y) {
      for (int z = -20; z <= 20; ++z) {
        ASSERT_NEAR(grid.value({x, y, z}), grid.value({-x, y, z}), 3e-2);
        ASSERT_NEAR(grid.value({x, y, z}), grid.value({x, -y, z}), 3e-2);
      }
    }
  }
}

TEST(Sculptor, RefusesWhatMakesNoSense) {
  Sculptor sculptor(ball_grid(15));
  const auto refused = [&](const Stroke& stroke, const std::string& why) {
    try {
      (void)sculptor.apply(stroke, Job());
      FAIL() << "not refused: " << why;
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::usage);
      EXPECT_NE(std::string(e.what()).find(why), std::string::npos) << e.what();
    }
  };
  refused(ball_stroke(StrokeOp::unite, {0, 0, 0}, 0), "radius");
  refused(ball_stroke(StrokeOp::unite, {0, 0, 0}, -3), "radius");
  refused(ball_stroke(StrokeOp::unite, {NAN, 0, 0}, 3), "finite");
  refused(ball_stroke(StrokeOp::unite, {0, 0, 0}, 1e6), "8.2e+15 bricks (1.8e+10 GB)");
  Stroke stroke = ball_stroke(StrokeOp::unite, {0, 0, 0}, 3);
  stroke.spacing = 0;
  refused(stroke, "spacing");
  stroke = ball_stroke(StrokeOp::unite, {0, 0, 0}, 3);
  stroke.path.clear();
  refused(stroke, "path");
  EXPECT_EQ(sculptor.history().undoable(), 0U);
}

// It refuses what apply() refuses, and changes nothing.
TEST(Sculptor, ChecksAStrokeWithoutMakingIt) {
  const Grid grid = ball_grid(15);
  const Content before = content_of(grid, 24);
  Sculptor sculptor(grid);
  Stroke no_path = ball_stroke(StrokeOp::unite, {0, 0, 0}, 3);
  no_path.path.clear();
  for (const Stroke& wrong : {ball_stroke(StrokeOp::unite, {NAN, 0, 0}, 3), no_path,
                              ball_stroke(StrokeOp::unite, {0, 0, 0}, 1e6),
                              ball_stroke(StrokeOp::flatten, {45, 0, 0}, 5)}) {
    std::string told[2];
    for (const bool only_check : {true, false}) {
      try {
        only_check ? sculptor.check(wrong, Job()) : (void)sculptor.apply(wrong, Job());
      } catch (const Error& e) {
        told[only_check ? 1 : 0] = e.what();
      }
    }
    EXPECT_NE(told[0], "");
    EXPECT_EQ(told[0], told[1]);
  }
  for (const StrokeOp op : {StrokeOp::unite, StrokeOp::subtract, StrokeOp::intersect,
                            StrokeOp::inflate, StrokeOp::flatten, StrokeOp::smooth}) {
    EXPECT_NO_THROW(sculptor.check(ball_stroke(op, {15, 0, 0}, 5), Job()));
  }
  EXPECT_EQ(content_of(grid, 24), before);
  EXPECT_EQ(sculptor.history().undoable(), 0U);
}

TEST(Sculptor, BrushBelowAVoxelWarnsAndIsStillRight) {
  const Grid grid = ball_grid(15);
  Sculptor sculptor(grid);
  const StrokeReport report =
      sculptor.apply(ball_stroke(StrokeOp::subtract, {15, 0, 0}, 0.7), Job());
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_NE(report.warnings[0].find("below one voxel"), std::string::npos);
  const TwoBalls balls{{0, 0, 0}, {15, 0, 0}, 15, 0.7};
  for (int x = 12; x <= 18; ++x) {
    EXPECT_EQ(grid.value({x, 0, 0}) < 0, balls.subtract({x, 0, 0}) < 0) << x;
  }
}

// What is beyond the band is not near, however wide the blend.
TEST(Sculptor, BlendsAreNoWiderThanTheBand) {
  const Grid sharp = ball_grid(10);
  const Grid blended = ball_grid(10);
  Stroke stroke = ball_stroke(StrokeOp::unite, {28, 0, 0}, 6);
  EXPECT_TRUE(Sculptor(sharp).apply(stroke, Job()).warnings.empty());
  stroke.smooth = 20 * sharp.lattice().voxel;
  const StrokeReport report = Sculptor(blended).apply(stroke, Job());
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_NE(report.warnings[0].find("band"), std::string::npos) << report.warnings[0];
  int inside = 0;
  for (int x = -32; x <= 40; ++x) {
    for (int y = -32; y <= 32; ++y) {
      const bool in = blended.value({x, y, 3}) < 0;
      EXPECT_EQ(in, sharp.value({x, y, 3}) < 0) << x << ' ' << y;
      inside += in ? 1 : 0;
    }
  }
  EXPECT_GT(inside, 100);
}

TEST(Sculptor, StrokesBeyondTheRangeAreCutOffAndSaySo) {
  const Grid grid = ball_grid(15);
  SculptOptions options;
  options.range = {{-25, -25, -25}, {25, 25, 25}};
  Sculptor sculptor(grid, options);
  Stroke stroke = ball_stroke(StrokeOp::unite, {15, 0, 0}, 6);
  stroke.path.push_back({{9.0, 0, 0}});
  const StrokeReport report = sculptor.apply(stroke, Job());
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_NE(report.warnings[0].find("range"), std::string::npos);
  glm::ivec3 lo;
  glm::ivec3 hi;
  grid.active_bounds(lo, hi);
  EXPECT_LE(hi.x, 25);
  EXPECT_GT(hi.x, 20);
  // Closed there: positive beyond the cut.
  EXPECT_GT(grid.value({24, 0, 0}), 0);
  EXPECT_LT(grid.value({19, 0, 0}), 0);
  // Wholly outside: nothing happens, and it is said.
  const StrokeReport outside = sculptor.apply(ball_stroke(StrokeOp::unite, {900, 0, 0}, 5), Job());
  EXPECT_EQ(outside.bricks_touched, 0U);
  EXPECT_EQ(outside.warnings.size(), 1U);
}

TEST(Sculptor, RefusesGridsThatItCannotSculpt) {
  EXPECT_THROW(Sculptor{Grid()}, Error);
  EXPECT_THROW(Sculptor{ball_grid(40, 0.1, 30)}, Error);
}

TEST(Sculptor, ACancelledStrokeLeavesTheGridAsItWas) {
  const Grid grid = ball_grid(15);
  Sculptor sculptor(grid);
  const Content before = content_of(grid, kExtent);
  const Job job;
  job.cancel();
  EXPECT_THROW((void)sculptor.apply(ball_stroke(StrokeOp::unite, {12, 0, 0}, 8), job), Error);
  EXPECT_EQ(content_of(grid, kExtent), before);
  EXPECT_EQ(sculptor.history().undoable(), 0U);
}

}  // namespace
}  // namespace sdfgrid
