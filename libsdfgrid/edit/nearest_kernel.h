// edit/nearest_kernel.h: the vector arithmetic of "which of these points is nearest", between the
// ordinary code and nearest_kernel.cpp, which is compiled once for each instruction set. Plain data
// only (not installed). All builds give the same bits.
#pragma once

#include <cstdint>

#include "sdfgrid/core/kernel.h"

namespace sdfgrid {

struct NearPoints {
  static constexpr int kMost = 4;
  std::int32_t index[kMost];  // nearest first; of points equally near the first one
  float squared[kMost];       // distances
};

struct NearestKernel {
  // Of `count` points, a multiple of 16 above 0, the nearest to `p`, and three more that are
  // nearest within their class of indices modulo 16.
  void (*nearest)(const float* x, const float* y, const float* z, std::int32_t count,
                  const float p[3], NearPoints& out);
};

// The kernel for this machine.
const NearestKernel& nearest_kernel();

SDFGRID_DECLARE_ISAS(extern const NearestKernel kNearestKernel)

}  // namespace sdfgrid
