// transform/mesh_marching.h: marching and chamfer methods over the band of a mesh: bricks are made
// where the front comes (not installed).
#pragma once

#include <memory>

#include "sdfgrid/transform/mesh_transform.h"

namespace sdfgrid {

// For fmm, fmm2, closest_point, which carries the nearest triangle, and the chamfer methods, by
// Dijkstra's shortest ways from the seeds.
[[nodiscard]] std::unique_ptr<MeshTransform> make_mesh_march(const SignedMesh& mesh,
                                                             const Lattice& lattice,
                                                             const Band& band,
                                                             const TransformOptions& options,
                                                             const Job& job);

}  // namespace sdfgrid
