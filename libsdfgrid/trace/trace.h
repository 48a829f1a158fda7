// trace/trace.h: where rays meet the surface of a grid: the zeros of its trilinear field, found as
// roots of a cubic in each cell, not by small steps. Lengths are in world units.
//
// A hit is where the field changes between negative (inside) and not negative (outside); a ray that
// starts inside hits where it leaves. A touch without a change is no hit.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/atlas.h"
#include "sdfgrid/trace/camera.h"

namespace sdfgrid {

// What the first hits of a picture are, row by row, (0, 0) the upper left pixel.
struct HitBuffer {
  int width = 0;
  int height = 0;
  std::vector<float> depth;          // world units along the ray; +inf where nothing is hit
  std::vector<std::uint16_t> steps;  // jumps made and cells solved by the ray, at most 65535
  [[nodiscard]] std::size_t size() const { return depth.size(); }
};

// First hits of the rays through the pixel centres. Finds a hit exactly where trace_ray() does. The
// depth differs from its by about 2.5e-4 voxel over the sine of the angle between ray and surface:
// by less than 1e-3 voxel, but up to 1e-2 where the ray grazes the surface.
[[nodiscard]] HitBuffer trace_primary(const Atlas& atlas, const Camera& camera, const Job& job);

// Distance to the first hit along the ray in (t_min, t_max), in double; nothing if there is none.
// The ray's direction must have unit length.
[[nodiscard]] std::optional<double> trace_ray(const Atlas& atlas, const Ray& ray,
                                              double t_min = 0.0, double t_max = 1e300);

// The trilinear field at a world point, world units, negative inside. Beyond the band it is plus or
// minus the background.
[[nodiscard]] float distance_at(const Atlas& atlas, const glm::dvec3& world);

// Outward unit normal of the surface at a world point near it: the gradient of the field, with
// central differences at the lattice points interpolated between them, so that it is continuous
// everywhere. Zero where the field is flat.
[[nodiscard]] glm::vec3 normal_at(const Atlas& atlas, const glm::dvec3& world);

}  // namespace sdfgrid
