// grid/nanovdb.h: grids as NanoVDB files, which renderers and GPUs read in place (not installed;
// write_grid() comes here).
#pragma once

#include <iosfwd>

#include "sdfgrid/grid/grid.h"

namespace sdfgrid {

// Writes the bytes of an uncompressed .nvdb file. Values, active states and tiles are those of the
// grid; of its metadata only name, class and transform have a place there. Paint is a second grid.
void write_nanovdb(const Grid& grid, std::ostream& out);

}  // namespace sdfgrid
