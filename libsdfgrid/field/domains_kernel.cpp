// The batch functions of domains.h, folds.h, warps.h.
#include "sdfgrid/field/batch_family.h"
#include "sdfgrid/field/batch_kernel.h"
#include "sdfgrid/field/domains.h"
#include "sdfgrid/field/folds.h"
#include "sdfgrid/field/warps.h"

namespace sdfgrid::SDFGRID_ISA {

extern const BatchFamily kDomains = Functions<ops::Domains>::family;
extern const BatchFamily kFolds = Functions<ops::Folds>::family;
extern const BatchFamily kWarps = Functions<ops::Warps>::family;
extern const BatchFamily kMoreWarps = Functions<ops::MoreWarps>::family;

}  // namespace sdfgrid::SDFGRID_ISA
