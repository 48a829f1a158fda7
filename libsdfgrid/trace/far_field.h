// trace/far_field.h: distances beyond the band, on a coarse lattice. A narrow band knows the
// surface only from a few voxels near by; soft shadows and ambient occlusion also ask how far away
// the rest of the object is, and a few percent of error do not show there.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/atlas.h"

namespace sdfgrid {

// Points on the surface, two for each brick edge or so (one a block of 4^3 cells that the surface
// crosses), in voxels from the first sample of the atlas's first slot (index 8 * atlas.lo).
[[nodiscard]] std::vector<glm::vec3> surface_points(const Atlas& atlas, const Job& job);

// Corners of boxes that together hold all of the surface, for cameras that must see all of it; in
// the same units. A box is that of the surface in a block of 1 to 8 cells a side, the more the
// finer the grid.
[[nodiscard]] std::vector<glm::vec3> surface_corners(const Atlas& atlas, const Job& job);

struct FarField {
  glm::vec3 origin{0.0F};     // of node (0, 0, 0), in voxels from index 8 * atlas.lo
  float spacing = 1;          // voxels between neighbouring nodes
  glm::ivec3 dims{0};         // 0 if there is no surface
  std::vector<float> values;  // in voxels, negative inside, z fastest
};

// Distances to the nearest of `points`, with the atlas's sign, at about `nodes` nodes along the
// longest side of the points' bounds and a margin of a quarter of it all round. Nearest points are
// handed from node to node in two sweeps (Danielsson 1980), so an error of a fraction of the
// spacing is possible.
[[nodiscard]] FarField make_far_field(const Atlas& atlas, const std::vector<glm::vec3>& points,
                                      int nodes, const Job& job);

}  // namespace sdfgrid
