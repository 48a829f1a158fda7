// Good files of every format: what they hold arrives, whatever the format and however odd the file.
#include "sdfgrid/mesh/read.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "mesh/mesh_files.h"
#include "mesh/om_files.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/mesh/diagnose.h"

namespace sdfgrid {
namespace {

using namespace testing;

MeshFile read(const NamedFile& file) {
  const TempDir folder;
  return read_mesh(folder.write(file.name, file.bytes), Job());
}

glm::dvec3 world(const TriangleSoup& soup, std::uint32_t i) { return soup.origin + soup.local(i); }

// The triangles' corners in world units.
std::vector<glm::dvec3> corners(const TriangleSoup& soup) {
  std::vector<glm::dvec3> result;
  for (const glm::uvec3& t : soup.triangles) {
    for (int k = 0; k < 3; ++k) result.push_back(world(soup, t[k]));
  }
  return result;
}

std::vector<NamedFile> variants_with_om(const PolygonMesh& mesh) {
  std::vector<NamedFile> files = all_variants(mesh);
  files.push_back({"float.om", "OM", om_bytes(mesh, false)});
  files.push_back({"double.om", "OM", om_bytes(mesh, true)});
  return files;
}

TEST(ReadMesh, GivesTheSameCubeFromEveryFormat) {
  std::vector<glm::dvec3> expected;
  const PolygonMesh triangles = fans(unit_cube());
  for (const auto& face : triangles.faces) {
    for (const std::uint32_t i : face) expected.push_back(triangles.points[i]);
  }
  for (const NamedFile& file : variants_with_om(unit_cube())) {
    SCOPED_TRACE(file.name);
    const MeshFile mesh = read(file);
    EXPECT_EQ(mesh.format, file.format);
    EXPECT_EQ(mesh.soup.points.size(), 8U);
    EXPECT_EQ(mesh.soup.origin, glm::dvec3(0.0));
    EXPECT_TRUE(mesh.warnings.empty());
    if (file.format != "OM") {
      EXPECT_EQ(corners(mesh.soup), expected);
    }
    const MeshDiagnosis diagnosis = diagnose(mesh.soup);
    EXPECT_EQ(diagnosis.triangles, 12U);
    EXPECT_TRUE(diagnosis.closed());
    EXPECT_TRUE(diagnosis.consistently_oriented());
    EXPECT_DOUBLE_EQ(diagnosis.volume, 1.0);
  }
}

// A cube of 1 m in UTM zone 33 with its corners on odd millimetres.
PolygonMesh surveyed_cube() {
  PolygonMesh mesh = unit_cube();
  for (glm::dvec3& p : mesh.points) p += glm::dvec3(612345.123, 4123456.789, 312.017);
  return mesh;
}

TEST(ReadMesh, KeepsMillimetresFarFromZero) {
  for (const NamedFile& file : variants_with_om(surveyed_cube())) {
    SCOPED_TRACE(file.name);
    const bool single = file.bytes.find("double") == std::string::npos &&
                        file.bytes.find('\0') != std::string::npos && file.name != "double.om";
    if (single) continue;  // such a file has lost them before it is read
    const MeshFile mesh = read(file);
    EXPECT_EQ(mesh.soup.points.size(), 8U);
    const PolygonMesh expected = surveyed_cube();
    for (const glm::dvec3& p : expected.points) {
      double nearest = 1e300;
      for (std::uint32_t i = 0; i < mesh.soup.points.size(); ++i) {
        nearest = std::min(nearest, glm::length(world(mesh.soup, i) - p));
      }
      EXPECT_LT(nearest, 1e-7);
    }
  }
}

// A point that no face uses, such as a pivot at zero, is no part of the surface: it must not move
// the origin away from it.
TEST(ReadMesh, AnUnusedPointCostsNoMillimetres) {
  PolygonMesh mesh = surveyed_cube();
  mesh.points.insert(mesh.points.begin(), glm::dvec3(0));
  mesh.points.emplace_back(1e30);  // nor is the mesh as large as it is far away
  for (auto& face : mesh.faces) {
    for (std::uint32_t& corner : face) ++corner;
  }
  for (const NamedFile& file :
       {NamedFile{"a.obj", "OBJ", obj_text(mesh)}, NamedFile{"a.off", "OFF", off_text(mesh)}}) {
    SCOPED_TRACE(file.name);
    const MeshFile read_back = read(file);
    EXPECT_EQ(read_back.points, 10U);
    ASSERT_EQ(read_back.soup.points.size(), 8U);
    const glm::dvec3 size = bounds(read_back.soup).size();
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(size[a], 1.0, 1e-7);
  }
}

TEST(ReadMesh, FloatsFarFromZeroStayExactly) {
  PolygonMesh mesh = unit_cube();
  for (glm::dvec3& p : mesh.points) p = p * 37.5 + glm::dvec3(612345.0625, 4123456.25, 1e-3F);
  for (const NamedFile& file : all_variants(mesh)) {
    SCOPED_TRACE(file.name);
    const MeshFile read_back = read(file);
    ASSERT_EQ(read_back.soup.points.size(), 8U);
    EXPECT_NE(read_back.soup.origin.x, 0.0);
    EXPECT_EQ(read_back.soup.origin.z, 0.0);
    std::vector<glm::dvec3> points;
    for (std::uint32_t i = 0; i < 8; ++i) points.push_back(world(read_back.soup, i));
    for (glm::dvec3 p : mesh.points) {
      const bool text = file.bytes.find('\0') == std::string::npos;
      if (text) p.z = static_cast<float>(p.z);  // z needs more digits than a float has
      p = text ? p : glm::dvec3(glm::vec3(p));
      EXPECT_NE(std::find(points.begin(), points.end(), p), points.end()) << p.x << ' ' << p.y;
    }
  }
}

TEST(ReadMesh, KeepsEveryFaceOfANonManifoldEdge) {
  PolygonMesh fan;
  fan.points = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0}};
  fan.faces = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}};
  for (const NamedFile& file : all_variants(fan)) {
    SCOPED_TRACE(file.name);
    const MeshFile mesh = read(file);
    EXPECT_EQ(mesh.soup.triangles.size(), 3U);
    EXPECT_EQ(diagnose(mesh.soup).nonmanifold_edges, 1U);
  }
}

TEST(ReadMesh, KeepsRepeatedAndZeroAreaFaces) {
  PolygonMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}};
  mesh.faces = {{0, 1, 2}, {0, 1, 2}, {0, 1, 3}, {0, 1, 1}};
  for (const NamedFile& file : all_variants(mesh)) {
    SCOPED_TRACE(file.name);
    const MeshDiagnosis diagnosis = diagnose(read(file).soup);
    EXPECT_EQ(diagnosis.triangles, 4U);
    EXPECT_EQ(diagnosis.duplicate_faces, 1U);
    EXPECT_EQ(diagnosis.zero_area_faces, 2U);
  }
}

TEST(ReadMesh, MergesPointsInOnePlace) {
  PolygonMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-0.0, 1, -0.0}, {1, 1, 0}};
  mesh.faces = {{0, 1, 2}, {3, 5, 4}};
  const MeshFile file = read({"a.obj", "OBJ", obj_text(mesh)});
  EXPECT_EQ(file.points, 6U);
  EXPECT_EQ(file.soup.points.size(), 4U);
  EXPECT_EQ(diagnose(file.soup).components, 1U);
}

TEST(ReadMesh, CountsFacesThatItDrops) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const MeshFile obj = read({"a.obj", "OBJ", points + "f 1 2\nf 1 2 3\nf 1\nl 1 2\np 1\n"});
  EXPECT_EQ(obj.soup.triangles.size(), 1U);
  ASSERT_EQ(obj.warnings.size(), 2U);
  EXPECT_NE(obj.warnings[0].find("ignored 2 point, line"), std::string::npos) << obj.warnings[0];
  EXPECT_NE(obj.warnings[1].find("dropped 2 faces"), std::string::npos) << obj.warnings[1];
}

TEST(ReadObj, TakesWhatTheWorldWrites) {
  const std::string text =
      "\xef\xbb\xbf# Windows line ends, tabs, and a name with f in it\r\n"
      "mtllib /dev/zero\r\nusemtl none\r\n"
      "v\t+0 0 0 1.0 0.5 0.5\r\n  v 1e0 0 -0\r\nv 0 1 0 # a comment\r\nvt 0.5\r\nvn 0 0 1\r\n"
      "g f\r\nf 1/1/1 2/1/1 \\\r\n 3/1/1\r\nf -3//1 -2//1 -1//1\r\nf 4 1 2\r\nv 0 0 1";
  const MeshFile mesh = read({"a.OBJ", "OBJ", text});
  EXPECT_TRUE(mesh.warnings.empty());
  ASSERT_EQ(mesh.soup.triangles.size(), 3U);
  EXPECT_EQ(mesh.soup.triangles[0], glm::uvec3(0, 1, 2));
  EXPECT_EQ(mesh.soup.triangles[1], glm::uvec3(0, 1, 2));
  EXPECT_EQ(mesh.soup.triangles[2], glm::uvec3(3, 0, 1));
}

TEST(ReadObj, TakesLinesThatEndInCarriageReturns) {
  const MeshFile mesh = read({"a.obj", "OBJ", "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r"});
  EXPECT_EQ(mesh.soup.triangles.size(), 1U);
}

TEST(ReadObj, CountsRecordsOfUnknownKind) {
  const MeshFile mesh =
      read({"a.obj", "OBJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvertex 9\nf 1 2 3\nwhat 1\n"});
  ASSERT_EQ(mesh.warnings.size(), 1U);
  EXPECT_EQ(mesh.warnings[0], "ignored 2 records of unknown kind, the first at line 4");
}

TEST(ReadOff, TakesWhatTheWorldWrites) {
  const std::vector<std::string> texts = {
      "# a comment first\n\nOFF\n# counts\n3 1 0\n\n0 0 0\n# between\n1 0 0\n0 1 0\n3 0 1 2\n",
      "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2", "OFF3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
      "COFF\n3 1\n0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n0 1 0 255 0 0 255\n3 0 1 2 0.5 0.5 0.5\n",
      "STCNOFF\n3 1 0\n0 0 0 0 0 1 255 0 0 0 0\n1 0 0 0 0 1 9 9 9 0 0\n0 1 0 0 0 1 9 9 9 0 0\n"
      "3 0 1 2\n"};
  for (const std::string& text : texts) {
    SCOPED_TRACE(text);
    const MeshFile mesh = read({"a.off", "OFF", text});
    ASSERT_EQ(mesh.soup.triangles.size(), 1U);
    EXPECT_EQ(corners(mesh.soup)[1], glm::dvec3(1, 0, 0));
  }
}

TEST(ReadPly, StepsOverListsAndElementsThatItDoesNotNeed) {
  const std::string text =
      "ply\r\nformat ascii 1.0\r\nelement camera 1\r\nproperty list char float pose\r\n"
      "element face 1\r\nproperty uchar flags\r\nproperty list uint32 uint16 vertex_index\r\n"
      "property list uint8 float texcoord\r\nelement vertex 3\r\nproperty short z\r\n"
      "property list int int rings\r\nproperty float32 x\r\nproperty float64 y\r\nend_header\r\n"
      "2 0.5 nan\r\n7 3 0 1 2 6 0 0 1 0 0 1\r\n4 1 9 1 2\r\n4 0 2 2\r\n4 0 1 3\r\n";
  const MeshFile mesh = read({"a.ply", "PLY text", text});
  ASSERT_EQ(mesh.soup.triangles.size(), 1U);
  const std::vector<glm::dvec3> expected = {{1, 2, 4}, {2, 2, 4}, {1, 3, 4}};
  EXPECT_EQ(corners(mesh.soup), expected);
}

TEST(ReadPly, StepsOverBinaryLists) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    std::string bytes =
        std::string("ply\nformat binary_") + (order == std::endian::little ? "little" : "big") +
        "_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nproperty list ushort double rings\nelement face 1\n"
        "property list uchar float texcoord\nproperty list int uint vertex_indices\n"
        "end_header\n";
    for (int i = 0; i < 3; ++i) {
      bytes += bytes_of(i == 1 ? 1.0F : 0.0F, order) + bytes_of(i == 2 ? 1.0F : 0.0F, order) +
               bytes_of(0.0F, order) + bytes_of(std::uint16_t{1}, order) + bytes_of(7.0, order);
    }
    bytes += "\x02" + bytes_of(0.5F, order) + bytes_of(0.5F, order) + bytes_of(3, order) +
             bytes_of(0U, order) + bytes_of(1U, order) + bytes_of(2U, order);
    const MeshFile mesh = read({"a.ply", "", bytes});
    ASSERT_EQ(mesh.soup.triangles.size(), 1U);
    EXPECT_EQ(corners(mesh.soup)[2], glm::dvec3(0, 1, 0));
  }
}

TEST(ReadStl, TakesSeveralSolidsAndAnyCase) {
  const std::string facet =
      "FACET NORMAL nan nan nan\nOUTER LOOP\n\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 0\nENDLOOP\n"
      "ENDFACET\n";
  const std::string text = "SOLID one\n" + facet + "ENDSOLID one\nsolid two\n" + facet + "endsolid";
  EXPECT_EQ(read({"a.stl", "STL text", text}).soup.triangles.size(), 2U);
}

TEST(ReadStl, CountsBytesAfterTheTriangles) {
  const MeshFile mesh = read({"a.stl", "", stl_binary(unit_cube()) + std::string(7, '\0')});
  EXPECT_EQ(mesh.soup.triangles.size(), 12U);
  ASSERT_EQ(mesh.warnings.size(), 1U);
  EXPECT_EQ(mesh.warnings[0], "ignored 7 bytes after the triangles");
}

TEST(ReadMesh, StopsWhenItsJobIsCancelled) {
  const TempDir folder;
  const std::string path = folder.write("a.obj", obj_text(unit_cube()));
  const Job job;
  job.cancel();
  try {
    (void)read_mesh(path, job);
    FAIL() << "it read on";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::cancelled);
  }
}

}  // namespace
}  // namespace sdfgrid
