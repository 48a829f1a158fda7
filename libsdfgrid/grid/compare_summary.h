// grid/compare_summary.h: many samples' errors in a few numbers. Internal to grid/compare.h.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "sdfgrid/grid/compare.h"

namespace sdfgrid {

struct SampleError {
  bool counts = false;  // false for a sample that found no place
  bool sign_error = false;
  double error = 0;  // world units, >= 0; not a number counts as infinite
  glm::dvec3 world{0.0};
};

// Sums in the order of the samples, so that the result is the same whoever measured them.
[[nodiscard]] ErrorSummary summarize(const std::vector<SampleError>& samples);

}  // namespace sdfgrid
