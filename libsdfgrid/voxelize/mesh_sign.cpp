#include "sdfgrid/voxelize/mesh_sign.h"

#include <fmt/format.h>

#include <glm/geometric.hpp>
#include <utility>

#include "sdfgrid/core/error.h"
#include "sdfgrid/mesh/diagnose.h"
#include "sdfgrid/mesh/orient.h"
#include "sdfgrid/mesh/winding.h"

namespace sdfgrid {
namespace {

// What keeps a mesh from having an inside in the strict sense, with counts; empty if nothing does.
std::string defects(const MeshDiagnosis& mesh) {
  std::string text;
  const auto add = [&](std::size_t count, const char* what) {
    if (count == 0) return;
    if (!text.empty()) text += ", ";
    text += fmt::format("{} {}", count, what);
  };
  add(mesh.boundary_edges, "boundary edges");
  add(mesh.nonmanifold_edges, "non-manifold edges");
  add(mesh.flipped_neighbours, "flipped neighbours");
  add(mesh.zero_area_faces, "zero-area faces");
  return text;
}

// Six times the volume under the triangles, seen from the centre of the bounds: its sign says which
// way most of a nearly closed mesh faces.
double facing(const TriangleSoup& soup) {
  const glm::dvec3 center = bounds(soup).center() - soup.origin;
  double sum = 0;
  for (const glm::uvec3& t : soup.triangles) {
    sum += glm::dot(soup.local(t.x) - center,
                    glm::cross(soup.local(t.y) - center, soup.local(t.z) - center));
  }
  return sum;
}

void turn(TriangleSoup& soup) {
  for (glm::uvec3& t : soup.triangles) std::swap(t.y, t.z);
}

}  // namespace

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
  mesh.method = method;
  if (method == SignMethod::no_sign) {
    mesh.reason = "asked for";
    return mesh;
  }
  job.report("sign", 0.0);
  const MeshDiagnosis diagnosis = diagnose(mesh.soup);
  const std::string wrong = defects(diagnosis);
  if (method == SignMethod::normal && !wrong.empty()) {
    throw Error(ErrorKind::input, "the mesh has no inside that normals could tell (" + wrong +
                                      "); use --sign winding or --sign auto, or repair the mesh");
  }
  if (method == SignMethod::automatic) {
    mesh.method = wrong.empty() ? SignMethod::normal : SignMethod::winding;
    mesh.reason = wrong.empty() ? "the mesh is closed and consistently oriented" : wrong;
  } else {
    mesh.reason = "asked for";
  }
  job.checkpoint();
  if (diagnosis.closed() && diagnosis.consistently_oriented()) {
    mesh.warnings = orient_closed_components(mesh.soup, diagnosis);
  } else if (facing(mesh.soup) < 0) {
    turn(mesh.soup);
    mesh.warnings.push_back("most of the mesh faces inward; it was turned inside out");
  }
  if (mesh.method == SignMethod::normal) {
    mesh.topology = std::make_shared<Topology>(mesh.soup);
  } else {
    mesh.winding = std::make_shared<WindingNumber>(mesh.soup, job);
  }
  job.report("sign", 1.0);
  return mesh;
}

}  // namespace sdfgrid
