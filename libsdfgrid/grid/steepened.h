// grid/steepened.h: distances, more or less, of a grid that holds only bounds on them: those of a
// formula may be a hundredth of the distance, which light would take for shadow.
#pragma once

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/grid.h"

namespace sdfgrid {

// The value of every active voxel divided by the slope there (central differences), no farther from
// 0 than the background: of first order beside the surface, which stays where it is. Paint stays.
// `grid` itself if a fifth of the voxels beside the surface or fewer have slopes below 0.7.
[[nodiscard]] Grid steepened(const Grid& grid, const Job& job);

}  // namespace sdfgrid
