// transform/chamfer_kernel.h: the vector arithmetic of chamfer passes, compiled once for each
// instruction set. Plain data only (not installed).
#pragma once

#include <cstddef>

#include "sdfgrid/core/kernel.h"

namespace sdfgrid {

// A row of samples that a step leads from.
struct ChamferTerm {
  const float* row;
  float length;
};

struct ChamferKernel {
  // Copies a row where `inside` (0 or 1) is `side`; elsewhere writes zero. A null `from` is `far`
  // everywhere.
  void (*take_side)(const unsigned char* inside, int side, int samples, const float* from,
                    float far, float* row);
  // Copies a row where `inside` is `side`, and nothing elsewhere.
  void (*put_side)(const unsigned char* inside, int side, int samples, const float* row, float* to);
  // row[k] = least of itself and term.row[k] + term.length over the terms. Rows have room for 16
  // numbers more.
  void (*relax)(const ChamferTerm* terms, int count, int samples, float* row);
  // row[k] = least of row[k - s] + s * length over s >= 0 (forward), or of row[k + s] + s * length.
  // The row is preceded and followed by 16 infinite numbers.
  void (*run_along)(float length, bool forward, int samples, float* row);
};

// The kernel for this machine.
const ChamferKernel& chamfer_kernel();

SDFGRID_DECLARE_ISAS(extern const ChamferKernel kChamferKernel)

}  // namespace sdfgrid
