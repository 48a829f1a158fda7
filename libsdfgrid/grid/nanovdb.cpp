#include "sdfgrid/grid/nanovdb.h"

#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>

#include "sdfgrid/grid/vdb.h"

namespace sdfgrid {

void write_nanovdb(const Grid& grid, std::ostream& out) {
  const auto handle = nanovdb::openToNanoVDB(*vdb(grid));
  nanovdb::io::writeGrid(out, handle, nanovdb::io::Codec::NONE);
}

}  // namespace sdfgrid
