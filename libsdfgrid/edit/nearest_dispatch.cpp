// Chooses the kernel for this machine; declared in nearest_kernel.h.
#include "sdfgrid/core/isa.h"
#include "sdfgrid/edit/nearest_kernel.h"

namespace sdfgrid {

const NearestKernel& nearest_kernel() { return SDFGRID_SELECT_ISA(kNearestKernel); }

}  // namespace sdfgrid
