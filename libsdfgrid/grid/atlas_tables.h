// grid/atlas_tables.h: how the bricks of an Atlas are filled, and the tables by which rays jump;
// internal to grid/.
#pragma once

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/atlas.h"

namespace sdfgrid {

// The 9^3 samples of brick b lie in eight bricks of the grid. Copies part n, what lies in the one
// at b + (n >> 2, n >> 1 & 1, n & 1): `from` its 512 values, or null for a constant.
void copy_part(const float* from, float constant, int part, float* samples);

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
