// edit/redistance.h: makes distances of values that are only bounds of them, in the bricks that an
// edit touched. The surface is the zero set of the trilinear field and stays where it is: samples
// beside it are read, not written (unless asked for), and no sample changes its sign.
//
// A sample keeps its value if that is consistent: walking so far against the gradient ends on the
// surface. All others get the distance to the nearest point of the surface: the nearest zero on an
// edge of the lattice, improved by Newton steps on the trilinear field.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/bricks.h"

namespace sdfgrid {

// Widest band, in voxels, that local re-distancing (and so sculpting) takes.
inline constexpr double kWidestBand = 26;

struct RedistanceTask {
  glm::ivec3 brick{0};
  std::uint64_t suspect[8] = {};  // the samples to look at: word x, bit y * 8 + z
  // Whether suspects beside the surface may be written too. The surface moves then, by less than
  // the trilinear field's own error; wanted where the field's slope there is not one.
  bool beside_surface = false;
};

struct RedistancedBrick {
  BrickChange change;
  float values[kBrickSamples] = {};  // world units
  std::uint64_t active[8] = {};
};

// The new values of those bricks of `tasks` in which some changed; the grid is only read. The same
// at any number of threads. `voxel` is the grid's, world units.
[[nodiscard]] std::vector<RedistancedBrick> redistance(const GridBricks& bricks, double voxel,
                                                       const BandLimits& limits,
                                                       const std::vector<RedistanceTask>& tasks,
                                                       const Job& job);

}  // namespace sdfgrid
