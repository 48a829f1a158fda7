// transform/dense_marching.h: marching methods over a whole dense volume (not installed).
#pragma once

#include <span>

#include "sdfgrid/core/job.h"
#include "sdfgrid/transform/transform.h"

namespace sdfgrid {

// For the methods fmm, fmm2 and closest_point; otherwise as distance_transform().
void march_dense(const DenseSeeds& seeds, const TransformOptions& options,
                 std::span<float> distance, const Job& job);

}  // namespace sdfgrid
