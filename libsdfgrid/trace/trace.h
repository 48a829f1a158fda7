// trace/trace.h: where rays meet the trilinear surface of a grid.
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
  std::vector<float> depth;           // world units along the ray; +inf where nothing is hit
  std::vector<std::uint16_t> steps;   // cells and jumps that the ray took
  [[nodiscard]] std::size_t size() const { return depth.size(); }
};

// First hits of the rays through the pixel centres.
[[nodiscard]] HitBuffer trace_primary(const Atlas& atlas, const Camera& camera, const Job& job);

// Distance in world units to the first zero of the interpolated field along the ray in (t_min, t_max),
// in double; nothing if there is none.
[[nodiscard]] std::optional<double> trace_ray(const Atlas& atlas, const Ray& ray, double t_min = 0.0,
                                              double t_max = 1e300);

// Outward unit normal of the surface at a world point near it: the gradient of the field, with central
// differences at the lattice points interpolated between them, so that it is continuous everywhere.
[[nodiscard]] glm::vec3 normal_at(const Atlas& atlas, const glm::dvec3& world);

}  // namespace sdfgrid
