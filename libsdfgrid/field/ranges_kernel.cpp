// The batch functions of ranges.h.
#include "sdfgrid/field/batch_family.h"
#include "sdfgrid/field/batch_kernel.h"
#include "sdfgrid/field/ranges.h"

namespace sdfgrid::SDFGRID_ISA {

extern const BatchFamily kRanges = Functions<ops::Ranges>::family;

}  // namespace sdfgrid::SDFGRID_ISA
