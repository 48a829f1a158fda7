// transform/mesh_transform.h: the band around a mesh by a transform from exact seeds beside it,
// brick by brick (not installed). Bricks come out one at a time and are not kept here.
#pragma once

#include <functional>
#include <memory>

#include "sdfgrid/core/job.h"
#include "sdfgrid/core/lattice.h"
#include "sdfgrid/transform/transform.h"
#include "sdfgrid/voxelize/band.h"
#include "sdfgrid/voxelize/brick_maker.h"
#include "sdfgrid/voxelize/mesh_sign.h"

namespace sdfgrid {

class MeshTransform {
 public:
  virtual ~MeshTransform() = default;

  // Bricks that may come out.
  [[nodiscard]] virtual std::size_t bricks() const = 0;
  // Calls take(i, brick) for every brick i with a sample in the band, from several threads at once
  // and in no order; which brick is i does not depend on the threads.
  virtual void run(const std::function<void(std::size_t i, const Brick&)>& take,
                   const Job& job) const = 0;
  // Whether normals disagreed beside the surface (as in MeshVoxelizer).
  [[nodiscard]] virtual bool contradicted() const = 0;
};

// Does the transform, all but the last step. Keeps a reference to the mesh. Takes the methods that
// transform_methods() has for meshes; of the options method, bucket_width and steps. Throws
// Error{usage} for others, and for a band that the method cannot do.
[[nodiscard]] std::unique_ptr<MeshTransform> make_mesh_transform(const SignedMesh& mesh,
                                                                 const Lattice& lattice,
                                                                 const Band& band,
                                                                 const TransformOptions& options,
                                                                 const Job& job);

}  // namespace sdfgrid
