// tests/edit/grids.h: grids in closed form to sculpt, and ways to look at all that a grid holds.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "sdfgrid/edit/stroke.h"
#include "sdfgrid/grid/grid.h"

namespace sdfgrid::test {

// A level set of a function with gradient 1, sampled at the lattice points of [-extent, extent]^3
// (voxels), the band `width` voxels wide; beyond it the signed background.
[[nodiscard]] Grid make_grid(const std::function<double(const glm::dvec3&)>& distance, int extent,
                             double voxel, double width = 3);
// A ball around the origin, its radius in voxels.
[[nodiscard]] Grid ball_grid(double radius, double voxel = 0.1, double width = 3);

// Value and state of every sample of [-extent, extent]^3, z fastest.
using Content = std::vector<std::pair<float, bool>>;
[[nodiscard]] Content content_of(const Grid& grid, int extent);

// A stroke of one place; all lengths in voxels of 0.1.
[[nodiscard]] Stroke ball_stroke(StrokeOp op, const glm::dvec3& at, double radius,
                                 double voxel = 0.1);

// Distance to the union, or to what is left of the first without the second, of two balls.
struct TwoBalls {
  glm::dvec3 a{0.0}, b{0.0};
  double ra = 1, rb = 1;

  [[nodiscard]] double unite(const glm::dvec3& p) const;
  [[nodiscard]] double subtract(const glm::dvec3& p) const;
  [[nodiscard]] double intersect(const glm::dvec3& p) const;
  // From p to the circle in which they cut each other; infinite if they do not.
  [[nodiscard]] double to_crease(const glm::dvec3& p) const;
};

// Balls united and subtracted in turn, some along a path, around a ball of about 15 voxels.
[[nodiscard]] std::vector<Stroke> random_strokes(int count, unsigned seed, double least_radius = 2);

}  // namespace sdfgrid::test
