// grid/atlas.h: the bricks of a Grid laid out for tracing: read-only, aprons included, with the
// distance to the next brick where there is none.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/grid.h"

namespace sdfgrid {

struct Atlas {
  static constexpr int kEdge = 9;                        // samples a side: 8 and an apron of one
  static constexpr int kSamples = kEdge * kEdge * kEdge;  // z fastest: (x * 9 + y) * 9 + z

  Lattice lattice;
  glm::ivec3 lo{0};    // brick coordinate (index >> 3) of cell (0, 0, 0) of `cells`
  glm::ivec3 dims{0};  // bricks a side of `cells`
  // dims.x * dims.y * dims.z, z fastest. >= 0: which brick is there. < 0: none, and none within
  // Chebyshev distance -cell - 1 bricks either.
  std::vector<std::int32_t> cells;
  std::vector<float> samples;  // kSamples a brick, in voxels, negative inside
  std::vector<float> slope;    // a brick: bound on the gradient's length of its trilinear field
  std::vector<float> low, high;  // a brick: smallest and largest sample
};

// Bricks = leaves of the grid, and those beside them where an inactive neighbour changes sign.
[[nodiscard]] Atlas make_atlas(const Grid& grid, const Job& job);

}  // namespace sdfgrid
