// The batch functions of displace.h.
#include "sdfgrid/field/batch_family.h"
#include "sdfgrid/field/batch_kernel.h"
#include "sdfgrid/field/displace.h"

namespace sdfgrid::SDFGRID_ISA {

extern const BatchFamily kDisplacements = Functions<ops::Displacements>::family;
extern const BatchFamily kTerrainLeaves = Functions<ops::TerrainLeaves>::family;

}  // namespace sdfgrid::SDFGRID_ISA
