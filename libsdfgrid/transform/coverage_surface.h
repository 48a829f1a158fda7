// transform/coverage_surface.h: the surface through partly covered voxels, as a small disc in each
// (not installed).
//
// Where the surface can be seen as a height over one axis, the coverages of a column of voxels add
// up to its mean height there, and nine columns give position and slope exactly for a plane, and
// with the curvature to second order for other surfaces: the height functions of S. Cummins, M.
// Francois and D. Kothe (2005). Elsewhere (thin parts) the plane has the direction of the
// coverage's gradient and cuts off as much of its voxel as is covered, as in S. Gustavson and R.
// Strand, *Anti-aliased Euclidean distance transform* (2011). Where coverage changes so slowly that
// it is none (blurred volumes, grey plateaus), the surface is where it passes one half between
// samples.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "sdfgrid/transform/dense_seeds.h"

namespace sdfgrid {

// Of discs that are right in one place only, units.
inline constexpr float kEdgeRadius = 0.7F;

// Lengths in units of the smallest spacing, from sample (0, 0, 0) on.
struct SurfacePatch {
  glm::vec3 point;
  glm::vec3 normal;  // outwards, of length one
  float curvature;   // mean of the principal ones, positive where it bulges outwards; 0 if unknown
  float radius;      // how far the disc reaches
  float misfit;      // of the heights around from the disc's plane; 1 if it was not made of them
  // At d from `point` the surface's function is normal . d + d . bend d / 2, of slope one nearby.
  glm::mat3 bend{0};
};

// How much of the voxel around a sample is covered, 0 to 1; as at the border beyond it.
[[nodiscard]] double coverage_at(const SignedSamples& samples, const glm::ivec3& at);
// Neither whole nor empty, to half a grey level of 256.
[[nodiscard]] bool is_partly_covered(double coverage);

// Whether the voxel around a sample is covered in part and coverage passes one half between it and
// its 26 neighbours. The surface may pass such voxels, and those that are beside one on the other
// side along an axis.
[[nodiscard]] bool is_cut_by_surface(const SignedSamples& samples, const glm::ivec3& at);

// The patch of such a voxel; nothing if the surface passes it not, or the middle of its column in a
// neighbour.
[[nodiscard]] std::optional<SurfacePatch> surface_patch(const SignedSamples& samples,
                                                        const glm::ivec3& at);

// The patch where coverage passes one half between a sample and its neighbours along the axes;
// nothing if it does not.
[[nodiscard]] std::optional<SurfacePatch> crossing_patch(const SignedSamples& samples,
                                                         const glm::ivec3& at);

// How far from the centre of a box of these `sides` a plane of that outward normal is that leaves
// `coverage` of the box inside; negative below one half. For 0 < coverage < 1.
[[nodiscard]] double plane_offset(double coverage, const glm::dvec3& normal,
                                  const glm::dvec3& sides);

}  // namespace sdfgrid
