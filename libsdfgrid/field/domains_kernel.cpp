// The batch functions of domains.h.
#include "sdfgrid/field/batch_family.h"
#include "sdfgrid/field/batch_kernel.h"
#include "sdfgrid/field/domains.h"

namespace sdfgrid::SDFGRID_ISA {

extern const BatchFamily kDomains = Functions<ops::Domains>::family;

}  // namespace sdfgrid::SDFGRID_ISA
