// grid/convert_field.h: from an analytic field to a sparse distance grid, without a visit to empty
// space.
#pragma once

#include <cstddef>

#include "sdfgrid/core/job.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/voxelize/band.h"

namespace sdfgrid {

struct FieldConvertOptions {
  double voxel = 0;  // world units; if 0, `dim` decides
  int dim = 256;     // voxels along the longest side of the solid's bounds
  Band band;
  // Bytes that the conversion may take; 0 means 80 % of what the machine has free.
  std::size_t max_memory = 0;
};

struct FieldConversion {
  Grid grid;
  std::size_t evaluated = 0;  // samples and probes of blocks at which the field was computed
  std::size_t regions = 0;    // boxes over which it was bounded by intervals
  double seconds = 0;
};

// The lattice for a field: the voxel size asked for, samples at whole multiples of it. Throws
// Error{input} for a field that is empty or has no end along an axis, Error{usage} if neither voxel
// nor dim makes sense.
[[nodiscard]] Lattice choose_lattice(const Field& field, const FieldConvertOptions& options);

// The field's own values, bit for bit, at every lattice point where they are within the band;
// beyond it plus and minus background. Space is divided in eight again and again: a box whose
// interval lies beyond the band is left, and the program shortens on the way down. Where the field
// is only a bound on the distance, so are the values, and the band is as wide in it. Throws as
// choose_lattice, and Error{failed} if the grid would exceed the memory allowed.
[[nodiscard]] FieldConversion convert_field(const Field& field, const FieldConvertOptions& options,
                                            const Job& job);

}  // namespace sdfgrid
