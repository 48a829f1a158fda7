// tests/field/roots_kernel.h: the roots of lanes as functions over memory, for each instruction
// set.
#pragma once

#include "sdfgrid/core/kernel.h"

struct RootsKernel {
  // n a multiple of 16.
  void (*inner_root)(int n, const float* a, float* out);
};

SDFGRID_DECLARE_ISAS(extern const RootsKernel kRootsKernel)
