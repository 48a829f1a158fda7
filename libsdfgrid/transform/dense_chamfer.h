// transform/dense_chamfer.h: chamfer passes over a whole dense volume (not installed).
#pragma once

#include <span>

#include "sdfgrid/core/job.h"
#include "sdfgrid/transform/transform.h"

namespace sdfgrid {

// For the chamfer methods; otherwise as distance_transform().
void chamfer_dense(const DenseSeeds& seeds, const TransformOptions& options,
                   std::span<float> distance, const Job& job);

}  // namespace sdfgrid
