// trace/walk.h: a ray's way through an atlas, in voxels; internal to trace/.
#pragma once

#include <glm/vec3.hpp>

#include "sdfgrid/grid/atlas.h"
#include "sdfgrid/trace/camera.h"

namespace sdfgrid {

struct Walk {
  bool hit = false;
  double t = 0;   // voxels along the ray, if hit
  int steps = 0;  // jumps made and cells solved
};

// What trace_ray() does, with from and to and the answer in voxels along the ray.
[[nodiscard]] Walk walk_ray(const Atlas& atlas, const Ray& ray, double from, double to);

// The trilinear field in voxels at a place in cells counted from the first slot of the tables.
[[nodiscard]] double value_at(const Atlas& atlas, const glm::dvec3& place);

}  // namespace sdfgrid
