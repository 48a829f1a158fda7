// transform/mesh_feature.h: the feature transform of a mesh: for every cell of 2^3 samples the
// nearest cell beside the surface, and from the triangles of the seeds in and around those cells
// the distances (not installed).
#pragma once

#include <memory>

#include "sdfgrid/transform/mesh_transform.h"

namespace sdfgrid {

// Throws Error{usage} for bands that reach further than kLargestReach allows.
[[nodiscard]] std::unique_ptr<MeshTransform> make_mesh_feature(const SignedMesh& mesh,
                                                               const Lattice& lattice,
                                                               const Band& band, const Job& job);

}  // namespace sdfgrid
