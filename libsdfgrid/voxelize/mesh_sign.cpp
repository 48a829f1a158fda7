#include "sdfgrid/voxelize/mesh_sign.h"

#include "sdfgrid/core/error.h"
#include "sdfgrid/mesh/winding.h"

namespace sdfgrid {

std::string sign_name(SignMethod method) {
  switch (method) {
    case SignMethod::automatic:
      return "auto";
    case SignMethod::normal:
      return "normal";
    case SignMethod::winding:
      return "winding";
    case SignMethod::no_sign:
      break;
  }
  return "unsigned";
}

SignedMesh prepare_sign(TriangleSoup soup, SignMethod method, const Job& job) {
  SignedMesh mesh;
  mesh.soup = std::move(soup);
  mesh.method = method == SignMethod::automatic ? SignMethod::normal : method;
  job.checkpoint();
  if (mesh.method == SignMethod::normal) mesh.topology = std::make_shared<Topology>(mesh.soup);
  if (mesh.method == SignMethod::winding) {
    mesh.winding = std::make_shared<WindingNumber>(mesh.soup, job);
  }
  return mesh;
}

}  // namespace sdfgrid
