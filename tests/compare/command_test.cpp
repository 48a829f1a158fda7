// `sdfgrid compare` as scripts use it: either order, any pair, the keys of the contract.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/process.h"

namespace sdfgrid::test {
namespace {

using nlohmann::json;

class CompareCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    mesh_ = folder_.write("cube.off", cube_off());
    grid_ = folder_.path("cube.vdb");
    ASSERT_EQ(run({"convert", mesh_, "-o", grid_, "--dim", "20", "--quiet"}).exit, 0);
  }

  [[nodiscard]] static Outcome compare(const std::string& a, const std::string& b,
                                       std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"compare", a, b, "--samples", "2000", "--quiet", "--json"});
    return run(more);
  }

  Folder folder_;
  std::string mesh_;
  std::string grid_;
};

TEST_F(CompareCommand, MeasuresTheSameInEitherOrder) {
  json first = json::parse(compare(grid_, mesh_).out);
  json second = json::parse(compare(mesh_, grid_).out);
  for (json* result : {&first, &second}) result->erase("seconds");
  EXPECT_EQ(first, second);
  EXPECT_EQ(first["samples"], 2000);
  EXPECT_EQ(first["sign_errors"], 0);
  EXPECT_NEAR(first["voxel"].get<double>(), 0.05, 1e-12);
  for (const char* error : {"max_error", "rms_error", "p99_error", "mean_error"}) {
    const double world = first[error].get<double>();
    EXPECT_GE(world, 0) << error;
    EXPECT_LT(world, 1e-6) << error;
    EXPECT_NEAR(first[std::string(error) + "_voxels"].get<double>(), world / 0.05, 1e-12) << error;
  }
  EXPECT_GT(first["interpolated"]["max_error_voxels"].get<double>(), 0.01) << "edges are cut off";
  EXPECT_TRUE(first["stated_holds"].get<bool>());
}

TEST_F(CompareCommand, AnotherSeedDrawsOtherPlaces) {
  const auto interpolated = [&](const char* seed) {
    return json::parse(compare(grid_, mesh_, {"--seed", seed}).out)["interpolated"];
  };
  EXPECT_EQ(interpolated("3"), interpolated("3"));
  EXPECT_NE(interpolated("3"), interpolated("4"));
}

TEST_F(CompareCommand, TellsAGridThatIsNotOfTheMesh) {
  const std::string other = folder_.write("other.off",
                                          "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
                                          "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
  const Outcome outcome = compare(grid_, other, {"--tolerance", "0.01"});
  EXPECT_EQ(outcome.exit, 3);
  const json result = json::parse(outcome.out);
  EXPECT_FALSE(result["stated_holds"].get<bool>());
  EXPECT_FALSE(result["within_tolerance"].get<bool>());
  EXPECT_GT(result["sign_errors"], 100);
}

TEST_F(CompareCommand, TakesTwoGridsOrTwoMeshes) {
  const json grids = json::parse(compare(grid_, grid_).out);
  EXPECT_LT(grids["max_error"].get<double>(), 1e-12);
  EXPECT_EQ(grids["sign_errors"], 0);
  const Outcome meshes = compare(mesh_, mesh_, {"--tolerance", "1e-9"});
  EXPECT_EQ(meshes.exit, 0);
  const json result = json::parse(meshes.out);
  EXPECT_LT(result["hausdorff"].get<double>(), 1e-12);
  EXPECT_TRUE(result["voxel"].is_null());
  EXPECT_TRUE(result["max_error_voxels"].is_null());
  EXPECT_TRUE(result["sign_errors"].is_null()) << "surfaces have no signs, not none wrong";
}

TEST_F(CompareCommand, RefusesWhatIsNotThere) {
  EXPECT_EQ(compare(grid_, folder_.path("none.off")).exit, 4);
  EXPECT_EQ(compare(grid_, mesh_, {"--tolerance", "-1"}).exit, 2);
  EXPECT_EQ(run({"compare", grid_}).exit, 2);
}

}  // namespace
}  // namespace sdfgrid::test
