// mesh/soup.h: a triangle soup, the only form in which the library takes meshes. No topology is
// assumed: triangles may be non-manifold, open, flipped, duplicated or of zero area.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sdfgrid/core/lattice.h"

namespace sdfgrid {

struct TriangleSoup {
  // World position of point i is origin + points[i]; the origin is double so that a mesh in UTM
  // coordinates keeps float precision relative to its own size.
  std::vector<glm::vec3> points;
  std::vector<glm::uvec3> triangles;  // indices into points, counter-clockwise seen from outside
  glm::dvec3 origin{0.0};

  // Point i relative to `origin`, in double.
  [[nodiscard]] glm::dvec3 local(std::uint32_t i) const { return glm::dvec3(points[i]); }
};

// Bounds in world units of the points that triangles use; empty if there are none.
[[nodiscard]] Box bounds(const TriangleSoup& soup);

}  // namespace sdfgrid
