// Chooses the parabola kernel for this machine; declared in parabola_kernel.h.
#include "sdfgrid/core/isa.h"
#include "sdfgrid/transform/parabola_kernel.h"

namespace sdfgrid {

template <>
const ParabolaKernel<float>& parabola_kernel() {
#if defined(__x86_64__)
  switch (active_isa()) {
    case Isa::avx512:
      return avx512::kParabolaOfFloats;
    case Isa::avx2:
      return avx2::kParabolaOfFloats;
    case Isa::baseline:
      break;
  }
#endif
  return baseline::kParabolaOfFloats;
}

template <>
const ParabolaKernel<std::int32_t>& parabola_kernel() {
#if defined(__x86_64__)
  switch (active_isa()) {
    case Isa::avx512:
      return avx512::kParabolaOfInts;
    case Isa::avx2:
      return avx2::kParabolaOfInts;
    case Isa::baseline:
      break;
  }
#endif
  return baseline::kParabolaOfInts;
}

}  // namespace sdfgrid
