// voxelize/mesh_voxelizer.h: exact signed distances to a mesh at the lattice points beside it,
// brick by brick (not installed). Bricks come out one at a time and are not kept here: who calls
// decides where they go.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>

#include "sdfgrid/core/job.h"
#include "sdfgrid/core/lattice.h"
#include "sdfgrid/voxelize/band.h"
#include "sdfgrid/voxelize/brick_maker.h"
#include "sdfgrid/voxelize/mesh_sign.h"
#include "sdfgrid/voxelize/node_bins.h"

namespace sdfgrid {

class MeshVoxelizer {
 public:
  // Keeps references: mesh must outlive this. Throws Error{usage} for a band below one voxel, and
  // if the voxel size is too small for 32-bit indices.
  MeshVoxelizer(const SignedMesh& mesh, const Lattice& lattice, const Band& band, const Job& job);

  // The work comes in nodes of 128^3 samples; each may run on its own thread.
  [[nodiscard]] std::size_t nodes() const { return bins_.size(); }
  [[nodiscard]] glm::ivec3 node_origin(std::size_t node) const { return bins_.origin(node); }

  // Calls take(brick) for every brick of the node, from several threads at once and in no order.
  // The brick's data are gone when take returns. Throws what take throws, and Error{cancelled}.
  void run(std::size_t node, const std::function<void(const Brick&)>& take, const Job& job);

  // Whether normals contradicted each other in a brick so far: the mesh crosses itself, and signs
  // by normals are wrong somewhere.
  [[nodiscard]] bool contradicted() const { return contradicted_; }

 private:
  const SignedMesh& mesh_;
  Lattice lattice_;
  Band band_;
  double reach_;
  NodeBins bins_;
  std::atomic<bool> contradicted_{false};
};

}  // namespace sdfgrid
