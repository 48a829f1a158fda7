// The batch functions of leaves_fractal.h.
#include "sdfgrid/field/batch_family.h"
#include "sdfgrid/field/batch_kernel.h"
#include "sdfgrid/field/leaves_fractal.h"

namespace sdfgrid::SDFGRID_ISA {

extern const BatchFamily kFractalLeaves = Functions<ops::FractalLeaves>::family;

}  // namespace sdfgrid::SDFGRID_ISA
