// transform/chamfer_mask.h: a chamfer mask with all its symmetric steps (not installed).
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sdfgrid/transform/transform.h"

namespace sdfgrid {

struct MaskStep {
  glm::ivec3 offset;
  double length;  // in the units of the spacing
};

// Every permutation and sign of every step.
[[nodiscard]] std::vector<MaskStep> expand_steps(std::span<const ChamferStep> steps,
                                                 const glm::dvec3& spacing);

}  // namespace sdfgrid
