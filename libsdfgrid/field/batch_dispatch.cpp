// Chooses the field kernel for this machine; declared in batch_kernel.h.
#include "sdfgrid/core/isa.h"
#include "sdfgrid/field/batch_kernel.h"

namespace sdfgrid {

const FieldKernel& field_kernel() { return SDFGRID_SELECT_ISA(kFieldKernel); }

}  // namespace sdfgrid
