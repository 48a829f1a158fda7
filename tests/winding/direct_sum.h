// tests/winding/direct_sum.h: the winding number as its definition says, in double, over all
// triangles one after the other: what the hierarchical one is measured against.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "sdfgrid/mesh/soup.h"

namespace sdfgrid {

// Solid angle of the triangle seen from `q`, counted positive where its back is seen.
inline double solid_angle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                          const glm::dvec3& q) {
  const glm::dvec3 u = a - q;
  const glm::dvec3 v = b - q;
  const glm::dvec3 w = c - q;
  const double lu = glm::length(u);
  const double lv = glm::length(v);
  const double lw = glm::length(w);
  const double y = glm::dot(u, glm::cross(b - a, c - a));
  const double x = lu * lv * lw + glm::dot(u, v) * lw + glm::dot(v, w) * lu + glm::dot(w, u) * lv;
  return y == 0.0 ? 0.0 : 2.0 * std::atan2(y, x);
}

inline double direct_winding(const TriangleSoup& soup, const glm::dvec3& local) {
  double sum = 0.0;
  for (const glm::uvec3& t : soup.triangles) {
    sum += solid_angle(soup.local(t.x), soup.local(t.y), soup.local(t.z), local);
  }
  return 0.25 * std::numbers::inv_pi * sum;
}

}  // namespace sdfgrid
