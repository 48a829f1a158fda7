// The arithmetic of nearest_kernel.h, sixteen points at a time. Compiled once for each instruction
// set: include nothing here that emits functions shared with other files.
#include "sdfgrid/edit/nearest_kernel.h"

#include "sdfgrid/core/simd.h"

namespace sdfgrid::SDFGRID_ISA {
namespace {

alignas(64) constexpr std::int32_t kLane[kLanes] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                    8, 9, 10, 11, 12, 13, 14, 15};

// Sorts the lanes' own nearest points into `out`.
void take_least(F16 squared, I16 which, NearPoints& out) {
  for (int i = 0; i < NearPoints::kMost; ++i) {
    out.squared[i] = 3e38F;
    out.index[i] = -1;
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    float d = squared[lane];
    std::int32_t index = which[lane];
    for (int i = 0; i < NearPoints::kMost; ++i) {
      const bool before = d < out.squared[i] || (d == out.squared[i] && index < out.index[i]);
      if (!before) continue;
      const float later = out.squared[i];
      const std::int32_t later_index = out.index[i];
      out.squared[i] = d;
      out.index[i] = index;
      d = later;
      index = later_index;
    }
  }
}

void nearest(const float* x, const float* y, const float* z, std::int32_t count, const float p[3],
             NearPoints& out) {
  F16 best = splat(3e38F);
  I16 which = splat(0);
  I16 index = load(kLane);
  for (std::int32_t i = 0; i < count; i += kLanes) {
    const F16 dx = load(x + i) - p[0];
    const F16 dy = load(y + i) - p[1];
    const F16 dz = load(z + i) - p[2];
    const F16 squared = dx * dx + dy * dy + dz * dz;
    const I16 nearer = squared < best;
    best = select(nearer, squared, best);
    which = select(nearer, index, which);
    index = index + kLanes;
  }
  take_least(best, which, out);
}

}  // namespace

extern const NearestKernel kNearestKernel;
const NearestKernel kNearestKernel = {nearest};

}  // namespace sdfgrid::SDFGRID_ISA
