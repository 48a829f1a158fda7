// grid/peers.h: what OpenVDB makes of a mesh, to measure ours against (not installed; see
// grid/methods.h).
#pragma once

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/mesh/soup.h"

namespace sdfgrid {

// meshToVolume, on the lattice that convert_mesh() would take. Cancellation waits for its end.
[[nodiscard]] Conversion convert_by_openvdb(const TriangleSoup& soup, const ConvertOptions& options,
                                            const Job& job);

// Exact distances within a voxel of the surface, and fast sweeping (Zhao 2005, as dilateSdf has it)
// from there to the wider of the two sides of the band.
[[nodiscard]] Conversion convert_by_sweeping(const TriangleSoup& soup,
                                             const ConvertOptions& options, const Job& job);

}  // namespace sdfgrid
