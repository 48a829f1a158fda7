#include "sdfgrid/voxelize/mesh_sign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "sdfgrid/core/error.h"
#include "sdfgrid/mesh/diagnose.h"
#include "sdfgrid/mesh/orient.h"
#include "sdfgrid/mesh/winding.h"

namespace sdfgrid {
namespace {

// What keeps a mesh from having an inside in the strict sense, with counts; empty if nothing does.
std::string defects(const MeshDiagnosis& mesh, std::size_t flat) {
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
  add(mesh.duplicate_faces, "duplicate faces");
  add(flat, "components without volume");
  return text;
}

// Closed components so flat that front and back coincide: which of the two is nearest is left to
// rounding.
std::size_t flat_components(const TriangleSoup& soup, const MeshDiagnosis& diagnosis) {
  constexpr double kFlat = 1e-7;  // of the volume that a ball of the same area has, about
  struct Size {
    double volume = 0;
    double area = 0;
    glm::dvec3 corner{0.0};
  };
  std::vector<Size> sizes(diagnosis.components);
  for (std::size_t t = soup.triangles.size(); t-- > 0;) {
    sizes[diagnosis.component[t]].corner = soup.local(soup.triangles[t].x);
  }
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    Size& size = sizes[diagnosis.component[t]];
    const glm::uvec3& v = soup.triangles[t];
    const glm::dvec3 a = soup.local(v.x) - size.corner;
    const glm::dvec3 cross =
        glm::cross(soup.local(v.y) - size.corner - a, soup.local(v.z) - size.corner - a);
    size.volume += glm::dot(a, cross) / 6;
    size.area += glm::length(cross) / 2;
  }
  return static_cast<std::size_t>(std::count_if(sizes.begin(), sizes.end(), [](const Size& size) {
    return std::abs(size.volume) <= kFlat * std::pow(size.area, 1.5);
  }));
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
  const Orientation orientation = orient_mesh(mesh.soup);
  const MeshDiagnosis& diagnosis = orientation.diagnosis;
  mesh.warnings = orientation.warnings;
  const std::string wrong = defects(diagnosis, flat_components(mesh.soup, diagnosis));
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
  if (mesh.method == SignMethod::normal) {
    mesh.topology = std::make_shared<Topology>(mesh.soup);
  } else {
    mesh.winding = std::make_shared<WindingNumber>(mesh.soup, job);
  }
  job.report("sign", 1.0);
  return mesh;
}

void sign_by_winding(SignedMesh& mesh, std::string reason, const Job& job) {
  mesh.method = SignMethod::winding;
  mesh.reason = std::move(reason);
  mesh.topology.reset();
  mesh.winding = std::make_shared<WindingNumber>(mesh.soup, job);
}

}  // namespace sdfgrid
