// grid/dense.h: between sparse grids and dense volumes.
#pragma once

#include <glm/vec3.hpp>

#include "sdfgrid/grid/grid.h"
#include "sdfgrid/volume/volume.h"

namespace sdfgrid {

// All samples of the box around the active voxels and `margin` more on each side; where none is
// stored, the value that the grid has there (plus or minus background in a level set). Throws
// Error{input} if there are no active voxels, Error{failed} if the memory does not suffice.
[[nodiscard]] Volume to_volume(const Grid& grid, int margin = 0);

// The same of the samples from index `lo` to `hi`, inclusive.
[[nodiscard]] Volume to_volume(const Grid& grid, const glm::ivec3& lo, const glm::ivec3& hi);

// A grid of distances with every sample of `distances` active. Beyond them it says `background`
// (world units; the largest of the distances if 0), which every place there must be away. Throws
// Error{usage} if its samples are not float, its spacings differ or its axes are turned: a Grid has
// cubic voxels only.
[[nodiscard]] Grid to_grid(const Volume& distances, double background = 0);

}  // namespace sdfgrid
