// mesh/triangulate.h: polygons into triangles (not installed).
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>

namespace sdfgrid {

enum class Cut {
  clean,    // the triangles do not overlap, seen along the polygon's normal
  crossing  // the polygon crosses itself or has no area: the triangles cover it, and may overlap
};

// Cuts one polygon of three or more corners (indices into `points`) into its size minus two
// triangles, handed to `emit` in the polygon's own orientation. Convex ones become a fan round
// their first corner; others lose one ear after the other, in the plane of their area vector,
// O(corners^2).
Cut triangulate(std::span<const glm::dvec3> points, std::span<const std::uint32_t> polygon,
                const std::function<void(std::uint32_t, std::uint32_t, std::uint32_t)>& emit);

}  // namespace sdfgrid
