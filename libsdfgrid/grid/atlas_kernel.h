// grid/atlas_kernel.h: the vector arithmetic of one brick of an Atlas (9^3 samples, 8^3 cells, see
// grid/atlas.h), between the ordinary code and atlas_kernel.cpp, which is compiled once for each
// instruction set. Plain data only (not installed). All builds give the same bits.
//
// A set of a brick's cells, or of a leaf's 8^3 samples, is eight words: word x, bit y * 8 + z.
#pragma once

#include <cstdint>

#include "sdfgrid/core/kernel.h"

namespace sdfgrid {

struct SampleSurvey {
  float low, high;  // smallest and largest sample; -inf, inf if any is a NaN or infinite
  float step[3];    // largest difference of neighbours along each axis
  // The cells whose samples do not all lie beyond the margin on one side.
  std::uint64_t crossing[8];
};

struct AtlasKernel {
  // Part n of a brick's samples, n from 0 to 7, is what lies in the leaf at
  // (n >> 2, n >> 1 & 1, n & 1) from it: of that leaf the samples with x = 0, y = 0 or z = 0 where
  // the bit is set. Sets it to float(values[i] * factor), where `values` are that leaf's; returns
  // whether any sample was another before.
  bool (*copy)(const float* values, double factor, std::int32_t part, float* samples);
  // The set of a leaf's negative values.
  void (*negatives)(const float* values, std::uint64_t* words);
  void (*survey)(const float* samples, float margin, SampleSurvey& out);
  // Writes the 8 x 64 words of Atlas::hops.
  void (*hops)(const std::uint64_t* crossing, std::uint32_t* hops);
  // The cells that such words say to be crossing.
  void (*crossing_of)(const std::uint32_t* hops, std::uint64_t* crossing);
};

// The kernel for this machine.
const AtlasKernel& atlas_kernel();

SDFGRID_DECLARE_ISAS(extern const AtlasKernel kAtlasKernel)

}  // namespace sdfgrid
