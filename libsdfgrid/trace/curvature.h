// trace/curvature.h: how strongly a surface bends.
#pragma once

#include <glm/vec3.hpp>

#include "sdfgrid/grid/atlas.h"

namespace sdfgrid {

// Mean curvature at a world point of the surface, 1 / world unit: half the Laplacian of the
// distance, by second differences at the lattice points, interpolated between them. Positive where
// the surface bulges outwards: 1 / r on a sphere. On a mesh's flat triangles it is 0 and gathers at
// their edges.
[[nodiscard]] float mean_curvature_at(const Atlas& atlas, const glm::dvec3& world);

}  // namespace sdfgrid
