// The batch functions of leaves_basic.h.
#include "sdfgrid/field/batch_family.h"
#include "sdfgrid/field/batch_kernel.h"
#include "sdfgrid/field/leaves_basic.h"

namespace sdfgrid::SDFGRID_ISA {

extern const BatchFamily kBasicLeaves = Functions<ops::BasicLeaves>::family;

}  // namespace sdfgrid::SDFGRID_ISA
