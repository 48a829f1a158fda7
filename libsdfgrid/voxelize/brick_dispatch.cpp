// Chooses the brick kernel for this machine; declared in brick_kernel.h.
#include "sdfgrid/core/isa.h"
#include "sdfgrid/voxelize/brick_kernel.h"

namespace sdfgrid {

const BrickKernel& brick_kernel() {
#if defined(__x86_64__)
  switch (active_isa()) {
    case Isa::avx512:
      return avx512::kBrickKernel;
    case Isa::avx2:
      return avx2::kBrickKernel;
    case Isa::baseline:
      break;
  }
#endif
  return baseline::kBrickKernel;
}

}  // namespace sdfgrid
