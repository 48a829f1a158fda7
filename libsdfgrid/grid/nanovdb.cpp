#include "sdfgrid/grid/nanovdb.h"

#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>

#include <vector>

#include "sdfgrid/grid/paint.h"
#include "sdfgrid/grid/vdb.h"

namespace sdfgrid {

void write_nanovdb(const Grid& grid, std::ostream& out) {
  std::vector<nanovdb::GridHandle<>> grids;
  grids.push_back(nanovdb::openToNanoVDB(*vdb(grid)));
  if (has_paint(grid)) grids.push_back(nanovdb::openToNanoVDB(*grid.storage().paint));
  nanovdb::io::writeGrids<nanovdb::HostBuffer, std::vector>(out, grids, nanovdb::io::Codec::NONE);
}

}  // namespace sdfgrid
