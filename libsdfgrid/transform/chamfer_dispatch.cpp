// Chooses the chamfer kernel for this machine; declared in chamfer_kernel.h.
#include "sdfgrid/core/isa.h"
#include "sdfgrid/transform/chamfer_kernel.h"

namespace sdfgrid {

const ChamferKernel& chamfer_kernel() { return SDFGRID_SELECT_ISA(kChamferKernel); }

}  // namespace sdfgrid
