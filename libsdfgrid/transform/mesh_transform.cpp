#include "sdfgrid/transform/mesh_transform.h"

#include "sdfgrid/core/error.h"
#include "sdfgrid/transform/mesh_binary.h"
#include "sdfgrid/transform/mesh_feature.h"
#include "sdfgrid/transform/mesh_marching.h"

namespace sdfgrid {

std::unique_ptr<MeshTransform> make_mesh_transform(const SignedMesh& mesh, const Lattice& lattice,
                                                   const Band& band,
                                                   const TransformOptions& options,
                                                   const Job& job) {
  check(options);
  switch (options.method) {
    case TransformMethod::feature:
      return make_mesh_feature(mesh, lattice, band, job);
    case TransformMethod::fmm:
    case TransformMethod::fmm2:
    case TransformMethod::closest_point:
    case TransformMethod::chamfer345:
    case TransformMethod::chamfer3:
    case TransformMethod::chamfer5:
    case TransformMethod::chamfer_mask:
      return make_mesh_march(mesh, lattice, band, options, job);
    case TransformMethod::meijster:
      return make_mesh_binary(mesh, lattice, band, job);
    case TransformMethod::antialiased:
      break;
  }
  throw Error(ErrorKind::usage, "this method is for volumes only");
}

}  // namespace sdfgrid
