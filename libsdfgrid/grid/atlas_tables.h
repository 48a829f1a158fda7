// grid/atlas_tables.h: the two tables of an Atlas by which rays jump; internal to grid/.
#pragma once

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/atlas.h"

namespace sdfgrid {

// Bound on the length of the gradient of a brick's trilinear field: a partial derivative of it is a
// mean of the differences along edges of that direction, so no larger than the largest of them.
[[nodiscard]] float brick_slope(const float* samples);

// Fills the kCells hops of one brick; a cell is crossing unless its samples all lie beyond `margin`
// on one side (a NaN among them makes it crossing). Returns whether any cell is.
bool fill_hops(const float* samples, float margin, std::uint8_t* hops);

// Fills atlas.jumps from atlas.bricks and atlas.hops.
void fill_jumps(Atlas& atlas, const Job& job);

}  // namespace sdfgrid
