// The batch functions of leaves_round.h, leaves_soft.h.
#include "sdfgrid/field/batch_family.h"
#include "sdfgrid/field/batch_kernel.h"
#include "sdfgrid/field/leaves_round.h"
#include "sdfgrid/field/leaves_soft.h"

namespace sdfgrid::SDFGRID_ISA {

extern const BatchFamily kRoundLeaves = Functions<ops::RoundLeaves>::family;
extern const BatchFamily kSoftLeaves = Functions<ops::SoftLeaves>::family;

}  // namespace sdfgrid::SDFGRID_ISA
