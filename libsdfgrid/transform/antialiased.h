// transform/antialiased.h: the distance transform of grey-level volumes, after S. Gustavson and R.
// Strand, *Anti-aliased Euclidean distance transform* (2011), in 3D (not installed).
#pragma once

#include <span>

#include "sdfgrid/core/job.h"
#include "sdfgrid/transform/transform.h"

namespace sdfgrid {

// For the method antialiased; otherwise as distance_transform(). Beside `distance` it needs 4 bytes
// a sample. Throws Error{usage} for values that are no coverage.
void antialiased_transform(const DenseSeeds& seeds, const TransformOptions& options,
                           std::span<float> distance, const Job& job);

}  // namespace sdfgrid
