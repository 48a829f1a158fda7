#include "sdfgrid/transform/chamfer_kernel.h"

#include "sdfgrid/core/simd.h"

namespace sdfgrid::SDFGRID_ISA {
namespace {

void take_side(const unsigned char* inside, int side, int samples, const float* from, float far,
               float* row) {
  if (from == nullptr) {
    for (int k = 0; k < samples; ++k) row[k] = inside[k] == side ? far : 0.0F;
  } else {
    for (int k = 0; k < samples; ++k) row[k] = inside[k] == side ? from[k] : 0.0F;
  }
}

void put_side(const unsigned char* inside, int side, int samples, const float* row, float* to) {
  for (int k = 0; k < samples; ++k) to[k] = inside[k] == side ? row[k] : to[k];
}

void relax(const ChamferTerm* terms, int count, int samples, float* row) {
  for (int k = 0; k < samples; k += kLanes) {
    F16 v = load(row + k);
    for (int t = 0; t < count; ++t) v = min(v, load(terms[t].row + k) + splat(terms[t].length));
    store(row + k, v);
  }
}

// By doubling: after steps of 1, 2, 4 ... all distances are covered, and no lane waits for the one
// before it. Blocks go against the direction, so that what is read is from before the step.
void run_along(float length, bool forward, int samples, float* row) {
  const int blocks = (samples + kLanes - 1) / kLanes;
  for (int step = 1; step < samples; step *= 2) {
    const F16 more = splat(length * static_cast<float>(step));
    const int begin = forward ? blocks - 1 : 0;
    const int end = forward ? -1 : blocks;
    for (int b = begin; b != end; b += forward ? -1 : 1) {
      const int k = b * kLanes;
      const int from = forward ? k - step : k + step;
      // What lies further out than the margin is infinite.
      if (from < -kLanes || from >= blocks * kLanes) continue;
      store(row + k, min(load(row + k), load(row + from) + more));
    }
  }
}

}  // namespace

extern const ChamferKernel kChamferKernel;
const ChamferKernel kChamferKernel = {take_side, put_side, relax, run_along};

}  // namespace sdfgrid::SDFGRID_ISA
