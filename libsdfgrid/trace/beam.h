// trace/beam.h: many rays from one place through the empty space before the surface in one march;
// internal to trace/. Positions and lengths in cells, counted from the first slot of the tables.
#pragma once

#include <glm/vec3.hpp>

#include "sdfgrid/grid/atlas.h"

namespace sdfgrid {

// All rays from `origin` whose unit directions differ from `axis`, of unit length too, by at most
// `spread` (the length of the difference).
struct Beam {
  glm::dvec3 origin;
  glm::dvec3 axis;
  double spread = 0;
};

// A length, `from` or more, up to which no ray of the beam meets a crossing brick after `from`;
// +inf if none ever does.
[[nodiscard]] double march(const Atlas& atlas, const Beam& beam, double from);

}  // namespace sdfgrid
