// grid/atlas_kernel.h: the vector arithmetic of one brick of an Atlas (9^3 samples, 8^3 cells, see
// grid/atlas.h), between the ordinary code and atlas_kernel.cpp, which is compiled once for each
// instruction set. Plain data only (not installed). All builds give the same bits.
#pragma once

#include <cstdint>

#include "sdfgrid/core/kernel.h"

namespace sdfgrid {

struct SampleRange {
  float low, high;  // smallest and largest sample
  float step[3];    // largest difference of neighbours along each axis
  bool finite;      // no sample is a NaN or infinite
};

// Of the parts of a leaf that lie in the bricks at (0 or -1, 0 or -1, 0 or -1) from it, as
// copy_part() in atlas_tables.h counts them, the smallest and the largest value.
struct PartRanges {
  float low[8], high[8];
};

struct AtlasKernel {
  // out[i] = float(in[i] * factor), `count` times; out may be in.
  void (*scale)(const float* in, double factor, std::int32_t count, float* out);
  void (*parts)(const float* values, PartRanges& out);
  void (*range)(const float* samples, SampleRange& out);
  // Writes the 8 x 64 words of Atlas::hops: a cell is crossing unless its samples all lie beyond
  // `margin` on one side.
  void (*hops)(const float* samples, float margin, std::uint32_t* hops);
};

// The kernel for this machine.
const AtlasKernel& atlas_kernel();

SDFGRID_DECLARE_ISAS(extern const AtlasKernel kAtlasKernel)

}  // namespace sdfgrid
