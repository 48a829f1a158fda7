// grid/dense.h: between sparse grids and dense volumes.
#pragma once

#include "sdfgrid/grid/grid.h"
#include "sdfgrid/volume/volume.h"

namespace sdfgrid {

// All samples of the box around the active voxels and `margin` more on each side; where none is
// stored, the value that the grid has there (plus or minus background in a level set). Throws
// Error{input} if there are no active voxels, Error{failed} if the memory does not suffice.
[[nodiscard]] Volume to_volume(const Grid& grid, int margin = 0);

// A grid of distances with every sample of `distances` active. Throws Error{usage} if its samples
// are not float, its spacings differ or its axes are turned: a Grid has cubic voxels only.
[[nodiscard]] Grid to_grid(const Volume& distances);

}  // namespace sdfgrid
