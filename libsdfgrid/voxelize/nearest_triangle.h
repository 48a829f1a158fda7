// voxelize/nearest_triangle.h: exact distances from anywhere to a mesh, by a tree of boxes: for
// samples so far from the surface that a band's bins would list every triangle (not installed).
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/mesh/soup.h"
#include "sdfgrid/voxelize/brick_kernel.h"

namespace sdfgrid {

class NearestTriangle {
 public:
  // `soup` must have a triangle.
  NearestTriangle(const TriangleSoup& soup, const Lattice& lattice);

  // The distance in voxels from a place in index coordinates; exact to rounding of double. `known`
  // is a triangle, by a number of this tree's, from which the search starts, and becomes the
  // nearest one: a neighbour's is near, 0 is as good as any.
  [[nodiscard]] double distance(const glm::dvec3& at, std::uint32_t& known) const;

  // Appends the numbers of all triangles within `reach` voxels of a place, and of a few more.
  void collect(const glm::dvec3& at, double reach, std::vector<std::uint32_t>& triangles) const;

  [[nodiscard]] const TriangleRecord& record(std::uint32_t triangle) const {
    return records_[triangle];
  }

 private:
  struct Box {
    float lo[3];
    float hi[3];
    std::uint32_t first;  // triangle, or node if count is 0
    std::uint32_t count;
  };
  struct Node {
    Box sides[2];
  };
  struct Corners;

  Box build(std::vector<Corners>& triangles, std::size_t begin, std::size_t end);
  void visit(const Box& box, const glm::dvec3& at, double& best, std::uint32_t& known) const;
  void collect(const Box& box, const glm::dvec3& at, double square,
               std::vector<std::uint32_t>& triangles) const;

  std::vector<Node> nodes_;
  std::vector<TriangleRecord> records_;
  Box root_{};
};

}  // namespace sdfgrid
