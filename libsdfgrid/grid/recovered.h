// grid/recovered.h: distances, more or less, of a coarse grid that samples a field which is cut off
// near its surface, as that of a fine grid is at the end of its band: the surface between such
// samples is a staircase, which light shows as stripes.
#pragma once

#include "sdfgrid/core/job.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/grid/grid.h"

namespace sdfgrid {

// `grid` holds samples of `field`, active where that is within its band. A voxel with one of its 26
// neighbours on the other side gets its distance to the plane that touches the surface on the way
// there, found by bisection. Every other active voxel gets the length of the shortest way over
// neighbours to one of those, up to 9 % of the way too long, no farther from 0 than the background.
// Signs and paint stay.
[[nodiscard]] Grid recovered(const Grid& grid, const Field& field, const Job& job);

}  // namespace sdfgrid
