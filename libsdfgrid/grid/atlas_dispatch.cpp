// Chooses the kernel for this machine; declared in atlas_kernel.h.
#include "sdfgrid/core/isa.h"
#include "sdfgrid/grid/atlas_kernel.h"

namespace sdfgrid {

const AtlasKernel& atlas_kernel() { return SDFGRID_SELECT_ISA(kAtlasKernel); }

}  // namespace sdfgrid
