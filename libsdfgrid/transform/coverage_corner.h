// transform/coverage_corner.h: edges and corners in a volume of coverage (not installed).
//
// Across an edge neither column heights nor a plane explain how much of a voxel is covered. The
// faces that meet there can be seen a voxel or two further on, though: of the planes around a voxel
// those are taken, one to three, whose solid covers it and its 26 neighbours as they are covered.
#pragma once

#include <array>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>

#include "sdfgrid/transform/coverage_surface.h"

namespace sdfgrid {

// The solid near an edge or corner: what all of its half-spaces share or, if it is hollow, what any
// of them covers. Lengths as in SurfacePatch.
struct Corner {
  struct Plane {
    glm::vec3 point;
    glm::vec3 normal;  // outwards, of length one
  };
  std::array<Plane, 3> planes{};
  int count = 0;
  bool hollow = false;
};

struct CornerFoot {
  float distance;  // signed
  glm::vec3 point;
  glm::vec3 normal;  // outwards, of a plane through it
};

// The nearest point of a corner's surface. Needs one plane at least.
[[nodiscard]] CornerFoot nearest_on(const Corner& corner, const glm::vec3& p);

// How much of a box a corner covers, to about 0.02.
[[nodiscard]] double covered_by(const Corner& corner, const glm::dvec3& middle,
                                const glm::dvec3& sides);

// A patch whose nine heights lie in a plane: no edge is near.
[[nodiscard]] bool is_smooth(const SurfacePatch& patch);

// The patch in the voxel of a sample, or null; the sample may be beyond the volume.
using PatchAt = std::function<const SurfacePatch*(const glm::ivec3& at)>;

// The corner that explains the coverage around a sample; nothing if none of the faces seen within
// three voxels does.
[[nodiscard]] std::optional<Corner> find_corner(const SignedSamples& samples, const glm::ivec3& at,
                                                const PatchAt& patch_at);

}  // namespace sdfgrid
