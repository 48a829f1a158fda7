#include "mesh/om_files.h"

#include <gtest/gtest.h>

#include <OpenMesh/Core/IO/MeshIO.hh>
// After MeshIO.hh, as OpenMesh asks for.
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <sstream>

namespace sdfgrid::testing {
namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using FloatMesh = OpenMesh::PolyMesh_ArrayKernelT<>;
using DoubleMesh = OpenMesh::PolyMesh_ArrayKernelT<DoubleTraits>;

template <class Mesh>
std::string bytes_by(const PolygonMesh& polygons) {
  using Scalar = typename Mesh::Scalar;
  Mesh mesh;
  std::vector<OpenMesh::VertexHandle> points;
  for (const glm::dvec3& p : polygons.points) {
    points.push_back(mesh.add_vertex(typename Mesh::Point(
        static_cast<Scalar>(p.x), static_cast<Scalar>(p.y), static_cast<Scalar>(p.z))));
  }
  for (const auto& face : polygons.faces) {
    std::vector<OpenMesh::VertexHandle> corners;
    for (const std::uint32_t i : face) corners.push_back(points[i]);
    mesh.add_face(corners);
  }
  OpenMesh::VPropHandleT<int> weight;
  mesh.add_property(weight, "weight");
  mesh.property(weight).set_persistent(true);
  mesh.request_vertex_normals();
  std::ostringstream stream;
  omlog().disable();
  const OpenMesh::IO::Options options =
      OpenMesh::IO::Options::Binary | OpenMesh::IO::Options::VertexNormal;
  EXPECT_TRUE(OpenMesh::IO::write_mesh(mesh, stream, ".om", options));
  return stream.str();
}

}  // namespace

std::string om_bytes(const PolygonMesh& mesh, bool doubles) {
  return doubles ? bytes_by<DoubleMesh>(mesh) : bytes_by<FloatMesh>(mesh);
}

std::vector<OpenMeshTriangle> triangles_by_openmesh(const std::string& path) {
  FloatMesh mesh;
  OpenMesh::IO::Options options;
  EXPECT_TRUE(OpenMesh::IO::read_mesh(mesh, path, options));
  std::vector<OpenMeshTriangle> result;
  for (const auto face : mesh.faces()) {
    OpenMeshTriangle triangle{};
    std::size_t k = 0;
    for (const auto v : mesh.fv_range(face)) {
      const auto& p = mesh.point(v);
      triangle.at(k++) = {p[0], p[1], p[2]};
    }
    result.push_back(triangle);
  }
  return result;
}

}  // namespace sdfgrid::testing
