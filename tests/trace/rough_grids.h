// tests/trace/rough_grids.h: small grids that are hard on a ray tracer.
#pragma once

#include <string>
#include <vector>

#include "sdfgrid/grid/grid.h"

namespace sdfgrid::test {

struct NamedGrid {
  std::string name;
  Grid grid;
};

// Spheres, noise, thin plates, single voxels, faint crumbs and caps between tiles, each about 40
// samples a side, on different lattices.
[[nodiscard]] std::vector<NamedGrid> rough_grids();

}  // namespace sdfgrid::test
