// Chooses the step kernel for this machine; declared in step_kernel.h.
#include "sdfgrid/core/isa.h"
#include "sdfgrid/trace/step_kernel.h"

namespace sdfgrid {

const StepKernel& step_kernel() { return SDFGRID_SELECT_ISA(kStepKernel); }

}  // namespace sdfgrid
