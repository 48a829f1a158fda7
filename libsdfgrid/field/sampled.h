// field/sampled.h: readings of a Sampler that batches alone do not give (internal to field/).
#pragma once

#include "sdfgrid/field/field.h"

namespace sdfgrid {

[[nodiscard]] float sample_at(const Sampler& sampler, const glm::dvec3& p);

// The gradient by central differences; no longer than 1.
[[nodiscard]] ValueGradient sample_gradient(const Sampler& sampler, const glm::dvec3& p);

}  // namespace sdfgrid
