// The batch functions of combinations.h.
#include "sdfgrid/field/batch_family.h"
#include "sdfgrid/field/batch_kernel.h"
#include "sdfgrid/field/combinations.h"

namespace sdfgrid::SDFGRID_ISA {

extern const BatchFamily kCombinations = Functions<ops::Combinations>::family;

}  // namespace sdfgrid::SDFGRID_ISA
