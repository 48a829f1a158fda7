// The batch functions of blends.h, combinations.h, ranges.h.
#include "sdfgrid/field/batch_family.h"
#include "sdfgrid/field/batch_kernel.h"
#include "sdfgrid/field/blends.h"
#include "sdfgrid/field/combinations.h"
#include "sdfgrid/field/ranges.h"

namespace sdfgrid::SDFGRID_ISA {

extern const BatchFamily kCombinations = Functions<ops::Combinations>::family;
extern const BatchFamily kBlends = Functions<ops::Blends>::family;
extern const BatchFamily kRanges = Functions<ops::Ranges>::family;

}  // namespace sdfgrid::SDFGRID_ISA
