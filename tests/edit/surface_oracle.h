// tests/edit/surface_oracle.h: distances to the surface that a grid holds, the zero set of its
// trilinear field, by brute force in double: the field of each cell that the surface crosses is
// sampled on a lattice many times as fine, and the zeros on its edges are the surface. Shares
// nothing with the library's re-distancing.
#pragma once

#include <glm/vec3.hpp>
#include <unordered_map>
#include <vector>

#include "sdfgrid/grid/grid.h"

namespace sdfgrid::test {

class SurfaceOracle {
 public:
  // Looks at the cells of [-extent, extent]^3; `fine` subdivisions of each.
  SurfaceOracle(const Grid& grid, int extent, int fine = 8);

  struct Nearest {
    double distance = 1e300;  // voxels
    glm::dvec3 point{0.0};    // index space
    // Whether the surface is bent sharply beside that point: normals of the field within two voxels
    // of it differ by more than 30 degrees (a ball of radius 8 voxels stays below that).
    bool crease = false;
  };
  // Of the surface points within `reach` voxels of an index point.
  [[nodiscard]] Nearest nearest(const glm::dvec3& p, double reach) const;

 private:
  struct Cell {
    std::vector<glm::dvec3> points;
    glm::dvec3 normal{0.0};
  };
  static long key(const glm::ivec3& cell);
  const Cell* cell(const glm::ivec3& at) const;

  std::unordered_map<long, Cell> cells_;
};

// The surface of balls that were added and taken away one after the other, in closed form: points
// of it about half a voxel apart, each with the number of its ball. Shares nothing with the grid.
class CarvedBalls {
 public:
  struct Ball {
    glm::dvec3 middle;
    double radius;
    bool added;
  };
  explicit CarvedBalls(const std::vector<Ball>& balls);

  // Whether the surfaces of two balls, both part of what is left, come within `reach` voxels of p:
  // whatever the angle between them.
  [[nodiscard]] bool crease(const glm::dvec3& p, double reach) const;

 private:
  struct Point {
    glm::dvec3 at;
    std::size_t ball;
  };
  std::unordered_map<long, std::vector<Point>> cells_;
};

}  // namespace sdfgrid::test
