// edit/combine_kernel.h: the vector arithmetic of one edited brick, between the ordinary code and
// combine_kernel.cpp, which is compiled once for each instruction set. Plain data only (not
// installed).
//
// Samples are ordered z fastest, (x * 8 + y) * 8 + z; a bit set over them is eight words, one for
// each x, with bit y * 8 + z. All builds of this kernel give the same bits: it is compiled without
// contraction to multiply-add, and uses nothing but operations that IEEE 754 rounds exactly.
#pragma once

#include <cstdint>

#include "sdfgrid/core/kernel.h"

namespace sdfgrid {

// A ball swept along a segment while its radius goes from one value to another: the convex hull of
// two balls, seen from a brick. In voxels, from the brick's first sample. The distance to it is
// that to the ball with its centre at a + t u, where t and the radius follow from the tangent cone
// (exact inside and outside; derived in docs/methods.md).
struct RoundSegment {
  float a[3];          // centre of the first ball
  float axis[3];       // from it to the last, its length included
  float over_length2;  // 1 / |axis|^2; 0 for a single ball
  float across;        // t = clamp((p - a) . axis * over_length2 - across * (distance to the axis))
  float radius;        // of the first ball
  float growth;        // radius of the last minus that of the first
};

enum class CombineOp : std::int32_t { unite, subtract, intersect };

struct CombineInput {
  CombineOp op;
  const float* brush;   // 512 distances to the brush, voxels, negative inside
  const float* before;  // 512 values, world units; null: `constant` everywhere
  float constant;
  const float*
      extended;  // values not cut off at the band's limits to blend with, or null: `before`
  float voxel;   // world units
  float smooth;  // width of the blend, world units; 0: a sharp edge
  float inside, outside;  // the band's limits, world units
  // Whether the distances inside the brush are only bounds (its own parts overlap).
  bool bound_inside;
};

struct CombineOutput {
  float* after;             // 512 values
  std::uint64_t active[8];  // strictly within the band's limits
  // Whose value may not be the distance to the new surface, because the point of the surface that
  // it was measured to may have been removed.
  std::uint64_t suspect[8];
  std::uint64_t changed[8];
  bool any_changed;
  bool all_inside;  // every value is the limit
  bool all_outside;
};

struct CombineKernel {
  // Distances, in voxels, of the 512 samples to the union of `count` segments (at least one).
  void (*sweep)(const RoundSegment* segments, std::int32_t count, float* distances);
  void (*combine)(const CombineInput& in, CombineOutput& out);
};

// The kernel for this machine.
const CombineKernel& combine_kernel();

SDFGRID_DECLARE_ISAS(extern const CombineKernel kCombineKernel)

}  // namespace sdfgrid
