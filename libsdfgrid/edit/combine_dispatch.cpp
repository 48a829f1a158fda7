// Chooses the kernel for this machine; declared in combine_kernel.h.
#include "sdfgrid/core/isa.h"
#include "sdfgrid/edit/combine_kernel.h"

namespace sdfgrid {

const CombineKernel& combine_kernel() { return SDFGRID_SELECT_ISA(kCombineKernel); }

}  // namespace sdfgrid
