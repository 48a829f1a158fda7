// The batch functions of formulas.h.
#include "sdfgrid/field/batch_family.h"
#include "sdfgrid/field/batch_kernel.h"
#include "sdfgrid/field/formulas.h"

namespace sdfgrid::SDFGRID_ISA {

extern const BatchFamily kFormulas = Functions<ops::Formulas>::family;

}  // namespace sdfgrid::SDFGRID_ISA
