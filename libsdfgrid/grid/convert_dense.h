// grid/convert_dense.h: distances at every sample of a box, not in a band only.
#pragma once

#include <string>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/grid/convert_field.h"
#include "sdfgrid/mesh/soup.h"
#include "sdfgrid/volume/volume.h"

namespace sdfgrid {

struct DenseConversion {
  Volume distances;  // float, world units, negative inside
  SignMethod sign = SignMethod::no_sign;
  std::string sign_reason;
  std::vector<std::string> warnings;
  ConvertSeconds seconds;
};

// The distances at every lattice point of the mesh's bounds and `exwidth` voxels more on each side.
// Without a transform exact everywhere, to the rounding of float: within the band as
// convert_mesh(), beyond it by a tree of boxes. With one what it makes of exact seeds; it must be
// one that transform_methods() has for volumes, and the mesh must have signs.
// Takes 4 bytes a sample, twice that with a transform and 8 to 16 more for marching ones. Throws as
// convert_mesh() does.
[[nodiscard]] DenseConversion convert_dense(const TriangleSoup& soup, const ConvertOptions& options,
                                            const Job& job);

// The field's own values at every lattice point of its bounds and `exwidth` voxels more. Throws as
// convert_field() does.
[[nodiscard]] Volume convert_dense(const Field& field, const FieldConvertOptions& options,
                                   const Job& job);

}  // namespace sdfgrid
