// tests/render/scenes.h: grids of known shapes, to be seen in pictures whose pixels are known too.
#pragma once

#include <functional>

#include "sdfgrid/grid/grid.h"

namespace sdfgrid::test {

using Distance = std::function<double(const glm::dvec3&)>;

// The narrow band (half-width 3) of a signed distance at the lattice's points in `box`, which must
// hold the whole surface; elsewhere plus and minus the background.
[[nodiscard]] Grid grid_of(const Distance& distance, const Box& box, double voxel);

[[nodiscard]] Distance sphere(const glm::dvec3& center, double radius);
[[nodiscard]] Distance cuboid(const glm::dvec3& lo, const glm::dvec3& hi);  // exact
[[nodiscard]] Distance either(const Distance& a, const Distance& b);        // union; exact outside

// A sphere of radius 1 about the origin, 32 voxels a radius.
[[nodiscard]] Grid unit_sphere();

}  // namespace sdfgrid::test
