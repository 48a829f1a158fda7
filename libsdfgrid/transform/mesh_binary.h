// transform/mesh_binary.h: the band around a mesh as if only its mask were known: exact distances
// between samples on either side, after Meijster, Roerdink and Hesselink (2000), over bricks (not
// installed).
#pragma once

#include <memory>

#include "sdfgrid/transform/mesh_transform.h"

namespace sdfgrid {

// Throws Error{usage} for bands that reach further than kLargestReach allows, and for meshes
// without signs.
[[nodiscard]] std::unique_ptr<MeshTransform> make_mesh_binary(const SignedMesh& mesh,
                                                              const Lattice& lattice,
                                                              const Band& band, const Job& job);

}  // namespace sdfgrid
