// transform/march_kernel.h: the vector arithmetic of fast marching, between the ordinary code and
// march_kernel.cpp, which is compiled once for each instruction set. Plain data only (not
// installed).
#pragma once

#include <cstdint>

#include "sdfgrid/core/kernel.h"

namespace sdfgrid {

// What a stencil reads. A value is a signed distance whose last bit is 0 if it is final, else 1.
struct MarchStencil {
  const float* values;         // fewer than 2^31
  std::int32_t stride[3];      // between neighbours in a dense field
  const std::int32_t* bricks;  // in bricks: nine neighbours each (BrickField::neighbors)
  float weight[3];             // of a first-order term along each axis
  bool second_order;
};

struct MarchKernel {
  // distances[i] >= 0 solves |grad T| = 1 at samples[i] from its final neighbours on one side:
  // sides[i] is the sign bit of their values. Infinite if there is none.
  using Solve = void(const MarchStencil& stencil, const std::int32_t* samples,
                     const std::int32_t* sides, int count, float* distances);
  Solve* dense;
  Solve* bricks;
};

// The kernel for this machine.
const MarchKernel& march_kernel();

SDFGRID_DECLARE_ISAS(extern const MarchKernel kMarchKernel)

}  // namespace sdfgrid
