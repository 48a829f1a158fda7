// transform/coverage_surface.h: the surface through partly covered voxels, as a small disc in each
// (not installed).
//
// Where the surface can be seen as a height over one axis, the coverages of a column of voxels add
// up to its mean height there, and nine columns give position and slope exactly for a plane, and
// with the curvature to second order for other surfaces: the height functions of S. Cummins, M.
// Francois and D. Kothe (2005). Elsewhere (edges, thin parts) the plane has the direction of the
// coverage's gradient and cuts off as much of its voxel as is covered, as in S. Gustavson and R.
// Strand, *Anti-aliased Euclidean distance transform* (2011).
#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "sdfgrid/transform/dense_seeds.h"

namespace sdfgrid {

// Lengths in units of the smallest spacing, from sample (0, 0, 0) on.
struct SurfacePatch {
  glm::vec3 point;
  glm::vec3 normal;  // outwards, of length one
  float curvature;   // mean of the principal ones, positive where it bulges outwards; 0 if unknown
  float radius;      // how far the disc reaches
};

// The patch of the voxel around a sample; nothing if the surface does not pass it, or passes the
// middle of its column in a neighbour.
[[nodiscard]] std::optional<SurfacePatch> surface_patch(const SignedSamples& samples,
                                                        const glm::ivec3& at);

// How far from the centre of a box of these `sides` a plane of that outward normal is that leaves
// `coverage` of the box inside; negative below one half. For 0 < coverage < 1.
[[nodiscard]] double plane_offset(double coverage, const glm::dvec3& normal,
                                  const glm::dvec3& sides);

}  // namespace sdfgrid
