// Chooses the brick kernel for this machine; declared in brick_kernel.h.
#include "sdfgrid/core/isa.h"
#include "sdfgrid/voxelize/brick_kernel.h"

namespace sdfgrid {

const BrickKernel& brick_kernel() { return SDFGRID_SELECT_ISA(kBrickKernel); }

}  // namespace sdfgrid
