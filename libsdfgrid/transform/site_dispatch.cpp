// Chooses the site kernel for this machine; declared in site_kernel.h.
#include "sdfgrid/core/isa.h"
#include "sdfgrid/transform/site_kernel.h"

namespace sdfgrid {

const SiteKernel& site_kernel() { return SDFGRID_SELECT_ISA(kSiteKernel); }

}  // namespace sdfgrid
