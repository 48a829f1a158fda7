// The batch functions of warps.h.
#include "sdfgrid/field/batch_family.h"
#include "sdfgrid/field/batch_kernel.h"
#include "sdfgrid/field/warps.h"

namespace sdfgrid::SDFGRID_ISA {

extern const BatchFamily kWarps = Functions<ops::Warps>::family;

}  // namespace sdfgrid::SDFGRID_ISA
