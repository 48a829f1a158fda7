// Damaged files: whatever is in them, they are read or refused, and what is read is a valid soup.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "mesh/mesh_files.h"
#include "mesh/om_files.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/mesh/diagnose.h"
#include "sdfgrid/mesh/orient.h"
#include "sdfgrid/mesh/read.h"

namespace sdfgrid {
namespace {

using namespace testing;

// Flips bits, overwrites, repeats and removes pieces, or cuts the end off.
std::string damaged(std::string bytes, std::mt19937& random) {
  for (std::uint32_t changes = 1 + random() % 4; changes > 0 && !bytes.empty(); --changes) {
    const std::size_t at = random() % bytes.size();
    const std::size_t length = 1 + random() % 8;
    switch (random() % 6) {
      case 0:
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
        break;
      case 2:
        bytes[at] = "0123456789-+.eE#/ \n\\naif\xff\x7f"[random() % 25];
        break;
      case 3:
        bytes.insert(at, bytes.substr(random() % bytes.size(), length));
        break;
      case 4:
        bytes.erase(at, length);
        break;
      default:
        bytes.resize(at);
        break;
    }
  }
  return bytes;
}

void expect_valid(const TriangleSoup& soup) {
  for (const glm::vec3& p : soup.points) {
    ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
  }
  for (const glm::uvec3& t : soup.triangles) {
    for (int k = 0; k < 3; ++k) ASSERT_LT(t[k], soup.points.size());
  }
  ASSERT_FALSE(soup.triangles.empty());
}

// A long run is asked for by SDFGRID_FUZZ_CASES=20000, in a build with the sanitizers.
int number_of_cases() {
  const char* asked = std::getenv("SDFGRID_FUZZ_CASES");
  return asked == nullptr ? 400 : std::atoi(asked);
}

class DamagedMesh : public ::testing::TestWithParam<NamedFile> {};

TEST_P(DamagedMesh, IsReadOrRefused) {
  const int cases = number_of_cases();
  const TempDir folder;
  std::mt19937 random(20240501);
  int read = 0;
  int refused = 0;
  for (int i = 0; i < cases; ++i) {
    const std::string path = folder.write(GetParam().name, damaged(GetParam().bytes, random));
    try {
      MeshFile mesh = read_mesh(path, Job());
      expect_valid(mesh.soup);
      (void)orient_closed_components(mesh.soup, diagnose(mesh.soup));
      ++read;
    } catch (const Error& error) {
      ASSERT_EQ(error.kind(), ErrorKind::input) << error.what();
      ++refused;
    }
  }
  // Both happen, or the damage is not what it is meant to be.
  EXPECT_GT(read, cases / 100);
  EXPECT_GT(refused, cases / 10);
}

std::vector<NamedFile> inputs() {
  PolygonMesh mesh = unit_cube();
  mesh.faces.push_back({0, 1, 3, 7, 6, 2});  // a polygon that is neither flat nor convex
  std::vector<NamedFile> files = all_variants(mesh);
  files.push_back({"float.om", "OM", om_bytes(unit_cube(), false)});
  files.push_back({"double.om", "OM", om_bytes(unit_cube(), true)});
  return files;
}

INSTANTIATE_TEST_SUITE_P(EveryFormat, DamagedMesh, ::testing::ValuesIn(inputs()),
                         [](const auto& test) {
                           std::string name = test.param.name;
                           name[name.find('.')] = '_';
                           return name;
                         });

}  // namespace
}  // namespace sdfgrid
