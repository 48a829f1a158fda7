// Chooses the visibility kernel for this machine; declared in visibility.h.
#include "sdfgrid/core/isa.h"
#include "sdfgrid/trace/visibility.h"

namespace sdfgrid {

VisibilityKernel visibility_kernel() { return SDFGRID_SELECT_ISA(visibility); }

}  // namespace sdfgrid
