// core/lattice.h: where samples sit. Samples lie ON integer index points; world = origin + voxel *
// index.
#pragma once

#include <cmath>
#include <glm/vec3.hpp>

namespace sdfgrid {

// An axis-aligned box of positions; empty while lo > hi in any axis.
struct Box {
  glm::dvec3 lo{1e300};
  glm::dvec3 hi{-1e300};

  void add(const glm::dvec3& p) {
    for (int a = 0; a < 3; ++a) {
      if (p[a] < lo[a]) lo[a] = p[a];
      if (p[a] > hi[a]) hi[a] = p[a];
    }
  }
  [[nodiscard]] bool empty() const { return lo.x > hi.x || lo.y > hi.y || lo.z > hi.z; }
  // Whether it has an end along every axis.
  [[nodiscard]] bool finite() const {
    for (int a = 0; a < 3; ++a) {
      if (!std::isfinite(lo[a]) || !std::isfinite(hi[a])) return false;
    }
    return true;
  }
  [[nodiscard]] glm::dvec3 size() const { return hi - lo; }
  [[nodiscard]] glm::dvec3 center() const { return 0.5 * (lo + hi); }
};

// A uniform lattice without bounds. Positions are double: a mesh may sit at 4e6 units from zero.
struct Lattice {
  glm::dvec3 origin{0.0};  // world position of index (0, 0, 0)
  double voxel = 1.0;      // world length between neighbouring samples, > 0

  [[nodiscard]] glm::dvec3 to_world(const glm::dvec3& index) const {
    return origin + voxel * index;
  }
  [[nodiscard]] glm::dvec3 to_index(const glm::dvec3& world) const {
    return (world - origin) / voxel;
  }
};

}  // namespace sdfgrid
