// The readers beside OpenMesh's own, on files that OpenMesh 9 reads right.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "mesh/om_files.h"
#include "property/random_meshes.h"
#include "sdfgrid/mesh/read.h"

namespace sdfgrid {
namespace {

using namespace testing;

using Triangle = OpenMeshTriangle;

// In an order that does not depend on where files begin faces, or on which they begin with.
std::vector<Triangle> sorted(std::vector<Triangle> triangles) {
  for (Triangle& t : triangles) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

std::vector<Triangle> triangles_by_us(const std::string& path) {
  const MeshFile mesh = read_mesh(path, Job());
  EXPECT_EQ(mesh.soup.origin, glm::dvec3(0.0));
  std::vector<Triangle> result;
  for (const glm::uvec3& corner : mesh.soup.triangles) {
    Triangle& t = result.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const glm::vec3& p = mesh.soup.points[corner[k]];
      t.at(k) = {p.x, p.y, p.z};
    }
  }
  return result;
}

PolygonMesh polygons(const TriangleSoup& soup) {
  PolygonMesh mesh;
  for (const glm::vec3& p : soup.points) mesh.points.emplace_back(p);
  for (const glm::uvec3& t : soup.triangles) mesh.faces.push_back({t.x, t.y, t.z});
  return mesh;
}

TEST(ReadMeshAndOpenMesh, AgreeOnEveryVariant) {
  shapes::Random random(3);
  const PolygonMesh mesh = polygons(shapes::perturbed(shapes::icosphere(3, 1.0), random, 0.2));
  std::vector<NamedFile> files = all_variants(mesh);
  files.push_back({"float.om", "OM", om_bytes(mesh, false)});
  files.push_back({"double.om", "OM", om_bytes(mesh, true)});
  for (const NamedFile& file : files) {
    if (file.name == "big.off") continue;  // OpenMesh knows only its own byte order
    SCOPED_TRACE(file.name);
    const TempDir folder;
    const std::string path = folder.write(file.name, file.bytes);
    const std::vector<Triangle> expected = sorted(triangles_by_openmesh(path));
    EXPECT_EQ(expected.size(), 1280U);
    EXPECT_EQ(sorted(triangles_by_us(path)), expected);
  }
}

}  // namespace
}  // namespace sdfgrid
