// trace/grid_sampler.h: a grid as a leaf of fields.
#pragma once

#include <memory>

#include "sdfgrid/core/job.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/grid/grid.h"

namespace sdfgrid {

// The grid's trilinear field divided by the bound on its gradient, so that it is 1-Lipschitz; its
// zeros are those of the trilinear field. Beyond the band it is the background, and outside of the
// box of the active voxels the distance to that box if that is more. Throws Error{input} for a grid
// without sign or without voxels.
[[nodiscard]] std::shared_ptr<const Sampler> make_sampler(const Grid& grid, const Job& job);

}  // namespace sdfgrid
