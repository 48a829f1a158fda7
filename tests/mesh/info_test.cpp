// `sdfgrid info`, run as a user's script would.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/process.h"
#include "mesh/mesh_files.h"

namespace sdfgrid {
namespace {

using nlohmann::json;
using testing::obj_text;
using testing::PolygonMesh;
using testing::unit_cube;

json info(const std::string& path) {
  const test::Outcome outcome = test::run({"info", "--json", path});
  EXPECT_EQ(outcome.exit, 0) << outcome.error;
  return json::parse(outcome.out);
}

TEST(Info, SaysWhatACubeIs) {
  const test::Folder folder;
  const json result = info(folder.write("cube.obj", obj_text(unit_cube())));
  EXPECT_EQ(result["kind"], "mesh");
  EXPECT_EQ(result["format"], "OBJ");
  EXPECT_EQ(result["bounds"], json::parse("[[0, 0, 0], [1, 1, 1]]"));
  EXPECT_EQ(result["triangles"], 12);
  EXPECT_EQ(result["file_faces"], 6);
  EXPECT_EQ(result["components"], 1);
  EXPECT_EQ(result["closed"], true);
  EXPECT_EQ(result["orientation"], "outward");
  EXPECT_DOUBLE_EQ(result["area"], 6.0);
  EXPECT_DOUBLE_EQ(result["volume"], 1.0);
  for (const char* defect : {"boundary_edges", "nonmanifold_edges", "flipped_neighbours",
                             "zero_area_faces", "duplicate_faces"}) {
    EXPECT_EQ(result[defect], 0) << defect;
  }
}

TEST(Info, CountsWhatIsWrong) {
  PolygonMesh mesh = unit_cube();
  mesh.faces.pop_back();                // open
  mesh.faces.push_back(mesh.faces[4]);  // twice
  mesh.faces.push_back({0, 0, 1});      // no area
  mesh.faces.push_back({0, 1});         // no face
  std::reverse(mesh.faces[1].begin(), mesh.faces[1].end());
  const test::Folder folder;
  const json result = info(folder.write("broken.obj", obj_text(mesh)));
  EXPECT_EQ(result["closed"], false);
  EXPECT_EQ(result["orientation"], "inconsistent");
  EXPECT_EQ(result["boundary_edges"], 4);
  EXPECT_EQ(result["duplicate_faces"], 2);
  EXPECT_EQ(result["zero_area_faces"], 1);
  EXPECT_GT(result["flipped_neighbours"], 0);
  ASSERT_EQ(result["warnings"].size(), 1U);
  EXPECT_EQ(result["warnings"][0], "dropped 1 face with fewer than three corners");
}

TEST(Info, SaysWhatAGridIs) {
  const test::Folder folder;
  const std::string mesh = folder.write("cube.off", test::cube_off());
  const std::string grid = folder.path("cube.vdb");
  ASSERT_EQ(test::run({"convert", mesh, "-o", grid, "--voxel", "0.125"}).exit, 0);
  const json result = info(grid);
  EXPECT_EQ(result["kind"], "grid");
  EXPECT_EQ(result["class"], "level set");
  EXPECT_EQ(result["name"], "surface");
  EXPECT_DOUBLE_EQ(result["voxel"], 0.125);
  EXPECT_DOUBLE_EQ(result["background"], 0.375);
  EXPECT_DOUBLE_EQ(result["band"], 3.0);
  EXPECT_EQ(result["dims"].size(), 3U);
  EXPECT_GT(result["active_voxels"], 1000);
  EXPECT_GT(result["bricks"], 0);
  EXPECT_EQ(result["metadata"]["sdfgrid:source"], "cube.off");
  EXPECT_GT(result["max_error"], 0.0);
  for (int a = 0; a < 3; ++a) {
    EXPECT_LT(result["bounds"][0][a], 0.0);
    EXPECT_GT(result["bounds"][1][a], 1.0);
  }
}

TEST(Info, RefusesWithFilePlaceAndRemedy) {
  const test::Folder folder;
  const std::string path = folder.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n");
  const test::Outcome outcome = test::run({"info", path});
  EXPECT_EQ(outcome.exit, 4);
  EXPECT_TRUE(outcome.out.empty()) << outcome.out;
  EXPECT_NE(outcome.error.find(path + ": line 3: a coordinate is not finite: 'nan'; remove"),
            std::string::npos)
      << outcome.error;
}

}  // namespace
}  // namespace sdfgrid
