// edit/nearest_kernel.h: the vector arithmetic of re-distancing (which of these points is nearest;
// where near them is the surface), between the ordinary code and nearest_kernel.cpp, which is
// compiled once for each instruction set. Plain data only (not installed). All builds give the same
// bits: no contraction, nothing but operations that IEEE 754 rounds exactly.
#pragma once

#include <cstdint>

#include "sdfgrid/core/kernel.h"

namespace sdfgrid {

struct NearPoints {
  static constexpr int kMost = 4;
  std::int32_t index[kMost];  // nearest first; of points equally near the first one
  float squared[kMost];       // distances
};

// The samples of a Block (edit/block.h): (x, y, z), each from -apron to edge - apron - 1, is
// values[((x + apron) * edge + y + apron) * edge + z + apron]. Between them the field is trilinear.
struct BlockSamples {
  const float* values;
  std::int32_t edge;
  std::int32_t apron;
};

// `count` positions, a multiple of 16.
struct Positions {
  const float *x, *y, *z;
  std::int32_t count;
};

struct NearestKernel {
  // Of each row of constant x and y, which samples are negative: bit z + apron. Rows are at most 64
  // long; there are fifteen floats more behind the samples.
  void (*signs)(const BlockSamples& block, std::uint64_t* rows);

  // Of points, at least 16, the nearest to `p`, and three more that are nearest within their class
  // of indices modulo 16.
  void (*nearest)(const Positions& points, const float p[3], NearPoints& out);

  // Whether the surface is where a sample's value says: there, against the gradient from the
  // sample, the field is zero but for `tolerance` voxels, and half a voxel further on it has the
  // other sign. One bit a sample. Their neighbours must be in the block.
  void (*agree)(const BlockSamples& block, const Positions& samples, float tolerance,
                std::uint16_t* bits);

  // The distances from `from` to points of the surface near `to` that are nearer still, or to `to`:
  // by Newton steps on the trilinear field.
  void (*improve)(const BlockSamples& block, const Positions& from, const Positions& to,
                  float* distances);
};

// The kernel for this machine.
const NearestKernel& nearest_kernel();

SDFGRID_DECLARE_ISAS(extern const NearestKernel kNearestKernel)

}  // namespace sdfgrid
