// tests/chart/shapes.h: meshes whose fields are smooth, have edges, and have medial axes.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>

#include "sdfgrid/mesh/soup.h"

namespace sdfgrid::testing {

// A sphere of `rings` rings of twice as many quadrangles, radius 1.
inline TriangleSoup ball(int rings) {
  TriangleSoup soup;
  const double pi = std::acos(-1.0);
  const int around = 2 * rings;
  soup.points.emplace_back(0, 0, 1);
  for (int i = 1; i < rings; ++i) {
    for (int j = 0; j < around; ++j) {
      const double t = pi * i / rings;
      const double p = 2 * pi * j / around;
      soup.points.emplace_back(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t));
    }
  }
  soup.points.emplace_back(0, 0, -1);
  const auto at = [&](int i, int j) -> std::uint32_t {
    if (i == 0) return 0;
    if (i == rings) return static_cast<std::uint32_t>(soup.points.size() - 1);
    return static_cast<std::uint32_t>(1 + (i - 1) * around + j % around);
  };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < around; ++j) {
      if (i > 0) soup.triangles.emplace_back(at(i, j), at(i + 1, j), at(i, j + 1));
      if (i + 1 < rings) soup.triangles.emplace_back(at(i, j + 1), at(i + 1, j), at(i + 1, j + 1));
    }
  }
  return soup;
}

// The box from 0 to `size`.
inline TriangleSoup box(const glm::vec3& size) {
  TriangleSoup soup;
  for (int i = 0; i < 8; ++i) soup.points.emplace_back(glm::vec3(i & 1, i >> 1 & 1, i >> 2) * size);
  soup.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return soup;
}

}  // namespace sdfgrid::testing
