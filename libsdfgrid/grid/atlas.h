// grid/atlas.h: the bricks of a Grid laid out for tracing: read-only, aprons included, and beside
// them how far a ray may jump without meeting the surface.
//
// A cell is the cube between eight neighbouring samples; a brick is 8^3 cells, so 9^3 samples, and
// brick b owns the cells from index 8 b on. The atlas's field is the trilinear interpolation of
// float(value / voxel) over the samples of the grid. A cell may hold a zero only if its samples do
// not all lie on one side: such a cell, and a brick with one, is called crossing. Only crossing
// cells are ever solved; all others are jumped over, by two tables of the sizes of empty cubes:
// `jumps` in bricks, `hops` in the cells of one brick. They are kept for each of the eight octants
// of directions, as a ray needs only the space ahead to be empty: octant 4 fx + 2 fy + fz, where f
// is 1 for a ray that runs towards smaller coordinates.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/grid.h"

namespace sdfgrid {

struct Atlas {
  static constexpr int kBrick = 8;                        // cells a side
  static constexpr int kEdge = kBrick + 1;                // samples a side
  static constexpr int kSamples = kEdge * kEdge * kEdge;  // z fastest: (x * 9 + y) * 9 + z
  static constexpr int kOctants = 8;
  // A jump is no longer, so that an edit changes none further away (grid/live_atlas.h).
  static constexpr int kMostJump = 15;
  static constexpr int kJumpTables = kOctants / 2;
  static constexpr int kHops = kOctants * kBrick * kBrick;  // words a brick
  static constexpr std::int32_t kOutside = -1;  // in `bricks`: no brick, the field is positive
  static constexpr std::int32_t kInside = -2;   // in `bricks`: no brick, the field is negative
  // A cell also counts as crossing if its samples come within margin() of zero, so that a tracer
  // whose positions are wrong by up to kReach voxels cannot slip past a zero at a cell's border.
  static constexpr float kReach = 1.0F / 1024;

  Lattice lattice;
  glm::ivec3 lo{0};    // brick coordinate (index >> 3) of slot (0, 0, 0) of the two tables
  glm::ivec3 dims{0};  // slots a side; beyond the tables the field is positive everywhere
  std::vector<std::int32_t> bricks;  // a slot, z fastest: >= 0 which brick, else kOutside, kInside
  std::int32_t crossing = 0;         // the bricks before this one are the crossing ones
  // For each octant and slot the edge of the largest cube of slots that starts there, goes on in
  // the octant's directions and holds no crossing brick; at most kMostJump, and 0 in such a brick.
  // A table of slots for each pair of octants that differ in z only: the even one in the lower four
  // bits, so that an edit finds both in one line of memory.
  std::vector<std::uint8_t> jumps;
  std::vector<float> samples;  // kSamples a brick, in voxels, negative inside
  // For each crossing brick and octant the same in cells, as if the brick were alone: 64 words,
  // each of eight fields of four bits, lowest first. The place of cell (x, y, z) is field z of word
  // x * 8 + y, with those coordinates counted backwards in which the octant is negative.
  std::vector<std::uint32_t> hops;
  float outside = 3;  // distance in voxels where `bricks` says kOutside
  float inside = -3;  // and kInside
  float slope = 1;    // bound on the length of the field's gradient in all bricks, voxel / voxel

  [[nodiscard]] float margin() const { return slope * kReach; }
  // Of slot, which must be within dims, the place in the two tables.
  [[nodiscard]] std::size_t place(const glm::ivec3& slot) const {
    return (static_cast<std::size_t>(slot.x) * dims.y + slot.y) * dims.z + slot.z;
  }
  // The jump of the slot at a place.
  [[nodiscard]] int jump(int octant, std::size_t place) const {
    const std::size_t table = static_cast<std::size_t>(octant >> 1) * bricks.size();
    return jumps[table + place] >> 4 * (octant & 1) & kMostJump;
  }
  // The crossing brick of a slot, or -1.
  [[nodiscard]] std::int32_t crossing_brick(const glm::ivec3& slot) const {
    const std::int32_t brick = bricks[place(slot)];
    return brick >= 0 && brick < crossing ? brick : -1;
  }
  // The sample at an index point, in voxels.
  [[nodiscard]] float value(const glm::ivec3& index) const;
};

// Bricks are the leaves of the grid, and the regions without one where the interpolated field
// changes sign between two tiles or a tile and a leaf (the caps that the winding number puts on
// holes). Throws Error{failed}, with its estimate, if the tables would be absurdly large.
[[nodiscard]] Atlas make_atlas(const Grid& grid, const Job& job);

}  // namespace sdfgrid
