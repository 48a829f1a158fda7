// Chooses the parabola kernel for this machine; declared in parabola_kernel.h.
#include "sdfgrid/core/isa.h"
#include "sdfgrid/transform/parabola_kernel.h"

namespace sdfgrid {

template <>
const ParabolaKernel<float>& parabola_kernel() {
  return SDFGRID_SELECT_ISA(kParabolaOfFloats);
}

template <>
const ParabolaKernel<std::int32_t>& parabola_kernel() {
  return SDFGRID_SELECT_ISA(kParabolaOfInts);
}

}  // namespace sdfgrid
