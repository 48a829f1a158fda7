// transform/mesh_feature.h: the feature transform of a mesh: the nearest seed of every sample, and
// from its triangle and those of the samples around it the distance (not installed).
#pragma once

#include <memory>

#include "sdfgrid/transform/mesh_transform.h"

namespace sdfgrid {

// Throws Error{usage} for bands that reach further than kLargestReach allows.
[[nodiscard]] std::unique_ptr<MeshTransform> make_mesh_feature(const SignedMesh& mesh,
                                                               const Lattice& lattice,
                                                               const Band& band, const Job& job);

}  // namespace sdfgrid
