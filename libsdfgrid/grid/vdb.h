// grid/vdb.h: the OpenVDB grid inside a Grid, for those who want all that OpenVDB can do. The only
// public header that includes OpenVDB (several seconds of compile time): include it in .cpp files.
#pragma once

#include <openvdb/openvdb.h>

#include "sdfgrid/grid/grid.h"

namespace sdfgrid {

struct GridStorage {
  openvdb::FloatGrid::Ptr vdb;
  openvdb::Int32Grid::Ptr
      paint;  // the samples' materials (grid/paint.h); null where none is painted
};

[[nodiscard]] inline openvdb::FloatGrid::Ptr vdb(const Grid& grid) { return grid.storage().vdb; }

// Takes an OpenVDB grid with a uniform scale and translation for its transform.
// Throws Error{input} for any other transform.
[[nodiscard]] Grid from_vdb(openvdb::FloatGrid::Ptr vdb, const std::string& source = "grid");

}  // namespace sdfgrid
