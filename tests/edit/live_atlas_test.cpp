// An atlas that follows its grid says what a new one says.
#include "sdfgrid/grid/live_atlas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <random>

#include "edit/grids.h"
#include "sdfgrid/edit/sculptor.h"
#include "sdfgrid/grid/atlas_kernel.h"
#include "sdfgrid/trace/trace.h"

namespace sdfgrid {
namespace {

using namespace sdfgrid::test;

// Inside the crossing bricks no hop passes over a cell whose samples have both signs.
void expect_safe_hops(const Atlas& a, const std::string& when) {
  std::vector<std::uint32_t> longest(Atlas::kHops);
  for (const std::int32_t brick : a.bricks) {
    if (brick < 0 || brick >= a.crossing) continue;
    const std::uint32_t* hops = a.hops.data() + std::size_t(brick) * Atlas::kHops;
    SampleSurvey survey;
    atlas_kernel().survey(a.samples.data() + std::size_t(brick) * Atlas::kSamples, 0, survey);
    atlas_kernel().hops(survey.crossing, longest.data());
    for (std::size_t i = 0; i < std::size_t{Atlas::kHops} * 8; ++i) {
      const auto cell = [&](const std::uint32_t* words) {
        return words[i / 8] >> 4 * (i % 8) & 15;
      };
      ASSERT_LE(cell(hops), cell(longest.data())) << when;
    }
  }
}

void expect_same(const LiveAtlas& live, const Grid& grid, const std::string& when) {
  const Atlas& a = live.atlas();
  const Atlas fresh = make_atlas(grid, Job());
  for (int x = -40; x <= 40; ++x) {
    for (int y = -40; y <= 40; ++y) {
      for (int z = -40; z <= 40; ++z) {
        ASSERT_EQ(a.value({x, y, z}), fresh.value({x, y, z})) << when;
      }
    }
  }
  // No jump is longer than it may be: the cubes of the new atlas are the largest that are empty.
  for (std::size_t place = 0; place < fresh.bricks.size(); ++place) {
    const auto n = static_cast<int>(place);
    const glm::ivec3 slot(n / (fresh.dims.y * fresh.dims.z), n / fresh.dims.z % fresh.dims.y,
                          n % fresh.dims.z);
    const glm::ivec3 own = slot + fresh.lo - a.lo;
    const bool within =
        glm::all(glm::greaterThanEqual(own, glm::ivec3(0))) && glm::all(glm::lessThan(own, a.dims));
    if (!within) continue;
    for (int octant = 0; octant < Atlas::kOctants; ++octant) {
      ASSERT_LE(a.jump(octant, a.place(own)), fresh.jump(octant, place)) << when;
    }
  }
  expect_safe_hops(a, when);
  // The same hits, whatever the tables say of the way there.
  std::mt19937 random(11);
  std::normal_distribution<double> direction;
  std::uniform_real_distribution<double> place(-4, 4);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    Ray ray;
    ray.origin = {place(random), place(random), place(random)};
    ray.direction =
        glm::normalize(glm::dvec3(direction(random), direction(random), direction(random)));
    const auto expected = trace_ray(fresh, ray);
    const auto got = trace_ray(a, ray);
    ASSERT_EQ(expected.has_value(), got.has_value()) << when;
    if (!expected) continue;
    ++hits;
    ASSERT_NEAR(*expected, *got, 1e-9) << when;
  }
  EXPECT_GT(hits, 50) << when;
}

TEST(LiveAtlas, FollowsStrokesUndoAndRedo) {
  const Grid grid = ball_grid(15);
  Sculptor sculptor(grid);
  LiveAtlas live(grid, Job());
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-16, 16);
  std::uniform_real_distribution<double> radius(2, 8);
  for (int i = 0; i < 12; ++i) {
    const auto op = i % 2 == 0 ? StrokeOp::unite : StrokeOp::subtract;
    (void)sculptor.apply(
        ball_stroke(op, {place(random), place(random), place(random)}, radius(random)), Job());
    live.refresh(sculptor.touched(), Job());
    if (i % 4 == 3) {
      sculptor.undo();
      live.refresh(sculptor.touched(), Job());
      sculptor.undo();
      live.refresh(sculptor.touched(), Job());
      sculptor.redo();
      live.refresh(sculptor.touched(), Job());
    }
    expect_same(live, grid, "stroke " + std::to_string(i));
    if (HasFatalFailure()) return;
  }
}

std::vector<float> samples_of(const GridBricks& bricks, const glm::ivec3& brick) {
  const GridBrick now = bricks.find(brick);
  if (now.values == nullptr) return std::vector<float>(kBrickSamples, now.constant);
  return {now.values, now.values + kBrickSamples};
}

// Those samples and no others, so that what is missed beside them shows.
void mark_changed(const std::vector<float>& before, const std::vector<float>& after,
                  BrickChange& change) {
  for (int i = 0; i < kBrickSamples; ++i) {
    const bool changed = before[std::size_t(i)] != after[std::size_t(i)];
    change.samples[i >> 6] |= std::uint64_t{changed} << (i & 63);
  }
}

// Bricks written at random, so that the field changes sign in slots without a leaf, too: between
// leaves, constants and each other, as the caps of holes do.
TEST(LiveAtlas, FollowsSamplesThatReachSlotsWithoutALeaf) {
  const Grid grid = ball_grid(15);
  LiveAtlas live(grid, Job());
  GridBricks bricks(grid);
  const BandLimits limits = band_limits(grid);
  std::mt19937 random(6);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  int without_leaf = 0;
  for (int i = 0; i < 60; ++i) {
    std::vector<BrickChange> changes;
    for (int n = 0; n <= below(3); ++n) {
      const glm::ivec3 brick(below(6) - 3, below(6) - 3, below(6) - 3);
      const auto same = [&](const BrickChange& change) { return change.brick == brick; };
      if (std::any_of(changes.begin(), changes.end(), same)) continue;
      const std::vector<float> before = samples_of(bricks, brick);
      changes.push_back({brick, {}});
      if (below(3) == 0) {
        bricks.drop(brick, below(2) == 0 ? limits.inside : limits.outside);
        mark_changed(before, samples_of(bricks, brick), changes.back());
        continue;
      }
      const GridBrick now = bricks.make_unset(brick);
      const float all = below(2) == 0 ? limits.inside : limits.outside;
      std::fill_n(now.values, kBrickSamples, all);
      std::fill_n(now.active, kBrickWords, 0);
      // One sample on the other side, at a face, an edge, a corner or in the middle.
      const auto place = [&] { return below(2) == 0 ? 0 : below(8); };
      now.values[(place() * 8 + place()) * 8 + place()] = -0.5F * all;
      mark_changed(before, samples_of(bricks, brick), changes.back());
    }
    bricks.finish();
    live.refresh(changes, Job());
    const Atlas& a = live.atlas();
    for (std::size_t at = 0; at < a.bricks.size(); ++at) {
      const glm::ivec3 slot(int(at) / (a.dims.y * a.dims.z), int(at) / a.dims.z % a.dims.y,
                            int(at) % a.dims.z);
      without_leaf += a.bricks[at] >= 0 && bricks.find(slot + a.lo).values == nullptr ? 1 : 0;
    }
    expect_same(live, grid, "round " + std::to_string(i));
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(without_leaf, 100);
}

TEST(LiveAtlas, GrowsWithItsGrid) {
  const Grid grid = ball_grid(10);
  Sculptor sculptor(grid);
  LiveAtlas live(grid, Job());
  (void)sculptor.apply(ball_stroke(StrokeOp::unite, {28, -20, 9}, 6), Job());
  live.refresh(sculptor.touched(), Job());
  expect_same(live, grid, "beyond the tables");
  // A piece that stands alone disappears again.
  (void)sculptor.apply(ball_stroke(StrokeOp::subtract, {28, -20, 9}, 12), Job());
  live.refresh(sculptor.touched(), Job());
  expect_same(live, grid, "without it");
}

}  // namespace
}  // namespace sdfgrid
