// Chooses the marching kernel for this machine; declared in march_kernel.h.
#include "sdfgrid/core/isa.h"
#include "sdfgrid/transform/march_kernel.h"

namespace sdfgrid {

const MarchKernel& march_kernel() { return SDFGRID_SELECT_ISA(kMarchKernel); }

}  // namespace sdfgrid
