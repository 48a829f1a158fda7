// grid/atlas_tables.h: how the bricks of an Atlas are filled, and the tables by which rays jump;
// internal to grid/.
#pragma once

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/atlas.h"
#include "sdfgrid/grid/atlas_kernel.h"

namespace sdfgrid {

// The 9^3 samples of brick b lie in eight bricks of the grid. Sets part n, what lies in the one at
// b + (n >> 2, n >> 1 & 1, n & 1), to float(value * factor): `from` has its 512 values, or is null
// for a constant. Returns whether any sample was another before.
bool copy_part(const float* from, float constant, double factor, int part, float* samples);

// What a brick's samples say of it.
struct BrickRange {
  float low, high;  // smallest and largest, as in SampleSurvey
  float slope;      // bound on the length of the gradient of the trilinear field

  explicit BrickRange(const SampleSurvey& survey);
  // Whether it belongs to the crossing ones: unless its samples all lie beyond `margin` on one
  // side.
  [[nodiscard]] bool crossing(float margin) const { return low <= margin && high >= -margin; }
  // Whether its field changes sign.
  [[nodiscard]] bool changes_sign() const { return low < 0 && high >= 0; }
};

// Fills atlas.jumps from atlas.bricks and atlas.crossing.
void fill_jumps(Atlas& atlas, const Job& job);

}  // namespace sdfgrid
