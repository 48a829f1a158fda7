// mesh/reference_tree.h: the bounding volume hierarchy under mesh/reference.h. It answers two
// questions about a heap of triangles, in double: what is nearest to a point, and how often does a
// ray leave through them. It shares no code with the converter in voxelize/, which it measures.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "sdfgrid/core/lattice.h"

namespace sdfgrid::reference {

struct Corners {
  glm::dvec3 a, b, c;
};

// The point of the triangle (its inside, edges and corners) that is nearest to p. Holds for slivers
// and for triangles that are a segment or a point: what it returns is always a point of the
// triangle to rounding, so the distance to it can never come out too small.
[[nodiscard]] glm::dvec3 closest_on_triangle(const glm::dvec3& p, const Corners& triangle);

// A direction with two axes across it; right-handed and orthonormal.
struct RayFrame {
  glm::dvec3 across, aside, along;
};

class TriangleTree {
 public:
  struct Nearest {
    glm::dvec3 point{0.0};
    double squared = std::numeric_limits<double>::infinity();  // squared distance
  };

  explicit TriangleTree(std::vector<Corners> triangles);

  // The nearest point of all triangles. `squared_limit` is a squared distance within which there is
  // known to be one, infinity if nothing is known: the tighter, the fewer nodes are visited. If
  // nothing is within the limit, `squared` is infinite.
  [[nodiscard]] Nearest nearest(const glm::dvec3& p, double squared_limit) const;

  // Triangles that the ray from p along frame.along leaves through (from their back to their front,
  // where their corners run counter-clockwise) less those that it enters through. Nothing if p or
  // the ray is so near to a triangle's border that rounding could decide.
  [[nodiscard]] std::optional<int> crossings(const glm::dvec3& p, const RayFrame& frame) const;

  [[nodiscard]] const std::vector<Corners>& triangles() const { return triangles_; }
  [[nodiscard]] const Box& bounds() const { return nodes_.front().box; }

 private:
  struct Node {
    Box box;
    std::uint32_t first = 0;  // leaf: its first triangle; else: its first child, the second follows
    std::uint32_t count = 0;  // leaf: its triangles; else 0
  };
  class Builder;

  std::vector<Corners> triangles_;  // in the order of the leaves
  std::vector<Node> nodes_;         // the root first
};

}  // namespace sdfgrid::reference
