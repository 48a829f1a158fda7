// grid/atlas_tables.h: the tables of an Atlas by which rays jump; internal to grid/.
#pragma once

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/atlas.h"

namespace sdfgrid {

struct BrickRange {
  float low, high;  // smallest and largest sample
  float slope;      // bound on the length of the gradient of the trilinear field
  bool finite;      // no sample is a NaN or infinite
};
[[nodiscard]] BrickRange brick_range(const float* samples);

// Fills the kHops words of one brick; a cell is crossing unless its samples all lie beyond `margin`
// on one side (a NaN among them makes it crossing).
void fill_hops(const float* samples, float margin, std::uint32_t* hops);

// Fills atlas.jumps from atlas.bricks and atlas.crossing.
void fill_jumps(Atlas& atlas, const Job& job);

}  // namespace sdfgrid
