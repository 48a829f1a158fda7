// The tables of an Atlas against brute force: what is listed, what may be jumped over.
#include "sdfgrid/grid/atlas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>

#include "trace/lattice_field.h"
#include "trace/rough_grids.h"

namespace sdfgrid {
namespace {

constexpr int kBrick = Atlas::kBrick;

template <class Body>
void for_each(const glm::ivec3& lo, const glm::ivec3& end, const Body& body) {
  for (int x = lo.x; x < end.x; ++x) {
    for (int y = lo.y; y < end.y; ++y) {
      for (int z = lo.z; z < end.z; ++z) body(glm::ivec3(x, y, z));
    }
  }
}

glm::ivec3 direction_of(int octant) {
  return 1 - 2 * glm::ivec3((octant >> 2) & 1, (octant >> 1) & 1, octant & 1);
}

// The edge of the largest cube, at most `most`, from `first` on in an octant's directions of which
// no place within [0, dims) is occupied.
template <class Occupied>
int empty_edge(const glm::ivec3& first, int octant, const glm::ivec3& dims, int most,
               const Occupied& occupied) {
  const glm::ivec3 step = direction_of(octant);
  int edge = most;
  for_each(glm::ivec3(0), dims, [&](const glm::ivec3& place) {
    const glm::ivec3 ahead = (place - first) * step;
    const int distance = std::max({ahead.x, ahead.y, ahead.z});
    const bool behind = std::min({ahead.x, ahead.y, ahead.z}) < 0;
    if (!behind && distance < edge && occupied(place)) edge = distance;
  });
  return edge;
}

class AtlasTest : public testing::TestWithParam<int> {
 protected:
  const test::NamedGrid named_ = test::rough_grids()[GetParam()];
  const Atlas atlas_ = make_atlas(named_.grid, Job());
  const test::LatticeField field_{named_.grid};

  [[nodiscard]] const float* samples(std::int32_t brick) const {
    return atlas_.samples.data() + std::size_t(brick) * Atlas::kSamples;
  }
};

TEST_P(AtlasTest, HoldsTheGridsSamplesAndAprons) {
  int bricks = 0;
  for_each(glm::ivec3(0), atlas_.dims, [&](const glm::ivec3& slot) {
    const std::int32_t brick = atlas_.bricks[atlas_.place(slot)];
    if (brick < 0) return;
    ++bricks;
    const glm::ivec3 base = (atlas_.lo + slot) * kBrick;
    int i = 0;
    for_each(glm::ivec3(0), glm::ivec3(Atlas::kEdge), [&](const glm::ivec3& at) {
      ASSERT_EQ(samples(brick)[i++], field_.sample(base + at)) << named_.name;
    });
  });
  EXPECT_EQ(std::size_t(bricks) * Atlas::kSamples, atlas_.samples.size());
  EXPECT_GE(std::size_t(bricks), named_.grid.bricks());
}

// Every cell between samples of both signs is in a crossing brick, where no hop passes over it.
TEST_P(AtlasTest, ListsEveryCellWhereTheSignChanges) {
  int changes = 0;
  for_each(field_.lo(), field_.hi(), [&](const glm::ivec3& cell) {
    int negative = 0;
    for_each(cell, cell + 2, [&](const glm::ivec3& i) { negative += int(field_.sample(i) < 0); });
    if (negative == 0 || negative == 8) return;
    ++changes;
    const glm::ivec3 slot = (cell >> 3) - atlas_.lo;
    ASSERT_TRUE(slot == glm::clamp(slot, glm::ivec3(0), atlas_.dims - 1)) << named_.name;
    ASSERT_GE(atlas_.crossing_brick(slot), 0) << named_.name;
  });
  EXPECT_GT(changes, 100);
}

TEST_P(AtlasTest, JumpsAreTheLargestEmptyCubes) {
  const auto crossing = [&](const glm::ivec3& slot) { return atlas_.crossing_brick(slot) >= 0; };
  const std::size_t slots = atlas_.bricks.size();
  ASSERT_EQ(atlas_.jumps.size(), slots * Atlas::kJumpTables);
  for (int octant = 0; octant < Atlas::kOctants; ++octant) {
    for_each(glm::ivec3(0), atlas_.dims, [&](const glm::ivec3& slot) {
      const int edge = empty_edge(slot, octant, atlas_.dims, Atlas::kMostJump, crossing);
      ASSERT_EQ(atlas_.jump(octant, atlas_.place(slot)), edge)
          << named_.name << ", octant " << octant;
    });
  }
}

TEST_P(AtlasTest, HopsAreTheLargestEmptyCubesOfABrick) {
  ASSERT_GT(atlas_.crossing, 0);
  const int stride = 1 + atlas_.crossing / 6;  // a few bricks
  for (std::int32_t brick = 0; brick < atlas_.crossing; brick += stride) {
    const float margin = atlas_.margin();
    bool crossing[kBrick * kBrick * kBrick];
    for_each(glm::ivec3(0), glm::ivec3(kBrick), [&](const glm::ivec3& c) {
      int above = 0;
      int below = 0;
      for_each(c, c + 2, [&](const glm::ivec3& i) {
        const float value = samples(brick)[(i.x * 9 + i.y) * 9 + i.z];
        above += int(value > margin);
        below += int(value < -margin);
      });
      crossing[(c.x * kBrick + c.y) * kBrick + c.z] = above < 8 && below < 8;
    });
    const auto occupied = [&](const glm::ivec3& c) {
      return crossing[(c.x * kBrick + c.y) * kBrick + c.z];
    };
    for (int octant = 0; octant < Atlas::kOctants; ++octant) {
      const std::uint32_t* words =
          atlas_.hops.data() + std::size_t(brick) * Atlas::kHops + octant * kBrick * kBrick;
      for_each(glm::ivec3(0), glm::ivec3(kBrick), [&](const glm::ivec3& c) {
        const glm::ivec3 step = direction_of(octant);
        const glm::ivec3 back(step.x < 0 ? 7 - c.x : c.x, step.y < 0 ? 7 - c.y : c.y,
                              step.z < 0 ? 7 - c.z : c.z);
        const int hop = int(words[back.x * kBrick + back.y] >> (4 * back.z) & 15U);
        ASSERT_EQ(hop, empty_edge(c, octant, glm::ivec3(kBrick), kBrick, occupied))
            << named_.name << ", octant " << octant << ", brick " << brick;
      });
    }
  }
}

// A partial derivative of the trilinear field is largest on an edge, but the gradient's length is
// bounded over the whole cell: difference quotients at the corners, of all three axes.
TEST_P(AtlasTest, SlopeBoundsTheGradient) {
  double steepest = 0;
  for_each(field_.lo() + 1, field_.hi(), [&](const glm::ivec3& i) {
    for (int octant = 0; octant < Atlas::kOctants; ++octant) {
      const glm::ivec3 step = direction_of(octant);
      const double value = field_.sample(i);
      const double x = field_.sample(i + glm::ivec3(step.x, 0, 0)) - value;
      const double y = field_.sample(i + glm::ivec3(0, step.y, 0)) - value;
      const double z = field_.sample(i + glm::ivec3(0, 0, step.z)) - value;
      steepest = std::max(steepest, std::sqrt(x * x + y * y + z * z));
    }
  });
  EXPECT_LE(steepest, atlas_.slope * (1 + 1e-6)) << named_.name;
  EXPECT_GT(steepest, 0.3 * atlas_.slope) << named_.name << ": the bound says next to nothing";
}

INSTANTIATE_TEST_SUITE_P(RoughGrids, AtlasTest, testing::Range(0, 6));

TEST(EmptyAtlas, HasNoBricks) {
  const Atlas atlas = make_atlas(Grid(), Job());
  EXPECT_TRUE(atlas.bricks.empty());
  EXPECT_GT(atlas.value({0, 0, 0}), 0);
}

}  // namespace
}  // namespace sdfgrid
