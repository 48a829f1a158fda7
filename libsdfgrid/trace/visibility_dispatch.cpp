// Chooses the visibility kernel for this machine; declared in visibility.h.
#include "sdfgrid/core/isa.h"
#include "sdfgrid/trace/visibility.h"

namespace sdfgrid {

VisibilityKernel visibility_kernel() {
#if defined(__x86_64__)
  switch (active_isa()) {
    case Isa::avx512:
      return avx512::visibility;
    case Isa::avx2:
      return avx2::visibility;
    case Isa::baseline:
      break;
  }
#endif
  return baseline::visibility;
}

}  // namespace sdfgrid
