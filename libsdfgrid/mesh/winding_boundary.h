// mesh/winding_boundary.h: the boundary of a soup as a current, and how fast it lets the winding
// number change (not installed). Away from the triangles the winding number is the scalar magnetic
// potential of a current in the boundary edges, so its gradient follows the law of Biot and Savart.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/mesh/soup.h"

namespace sdfgrid::winding {

// An edge that triangles pass `times` more often from a to b than back; times > 0.
struct BoundaryEdge {
  glm::dvec3 a, b;
  double times;
};

// The edges that do not cancel, each once. Points at the same position count as one.
[[nodiscard]] std::vector<BoundaryEdge> boundary_edges(const TriangleSoup& soup);

// A binary tree over boundary edges that bounds the gradient.
class Boundary {
 public:
  explicit Boundary(std::vector<BoundaryEdge> edges);

  [[nodiscard]] bool empty() const { return edges_.empty(); }

  // At least (1 / 4 pi) times the integral over the boundary of times / distance^2, for every point
  // of the ball; +inf if an edge enters it, or once that is seen to exceed `limit`. A tree node
  // whose diagonal is below `opening` times its distance from the ball is taken whole.
  [[nodiscard]] double gradient_bound(const glm::dvec3& center, double radius, double opening,
                                      double limit) const;

 private:
  struct Node {
    Box box;
    double length = 0.0;      // of the edges, each as often as it counts
    glm::dvec3 current{0.0};  // sum of times * (b - a): zero for closed loops
    double spread = 0.0;      // integral along the edges of the distance from the box's centre
    std::uint32_t begin = 0;  // its edges
    std::uint32_t end = 0;
    std::uint32_t right = 0;  // its second child; the first follows it; 0 for a leaf
  };
  std::uint32_t build(std::uint32_t begin, std::uint32_t end);

  std::vector<BoundaryEdge> edges_;
  std::vector<Node> nodes_;
};

}  // namespace sdfgrid::winding
