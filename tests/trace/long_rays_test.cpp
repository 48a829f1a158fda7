// What only large grids show: rays longer than the stretch over which single precision is trusted,
// tables too large to make, steps, and normals across the borders of bricks.
#include <gtest/gtest.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/vdb.h"
#include "sdfgrid/trace/trace.h"
#include "sdfgrid/trace/walk.h"

namespace sdfgrid {
namespace {

constexpr float kVoxel = 0.5F;

void add_sphere(const openvdb::FloatGrid::Ptr& grid, const glm::vec3& center, float radius) {
  const auto sphere = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(
      radius, {center.x, center.y, center.z}, kVoxel, 3.0F);
  grid->tree().merge(sphere->tree());
}

// Small spheres beside a line of 4,000 voxels, each nearer to it than the one before: a ray along
// it passes many and grazes some.
Grid long_row() {
  openvdb::initialize();
  auto grid =
      openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(5.5F, {0, 45, 0}, kVoxel, 3.0F);
  for (int i = 1; i < 40; ++i) {
    const auto turn = static_cast<float>(2.4 * i);
    const float aside = 45 - 0.9F * static_cast<float>(i);
    add_sphere(grid,
               {50.3F * static_cast<float>(i), aside * std::cos(turn), aside * std::sin(turn)},
               5.5F);
  }
  return from_vdb(grid);
}

TEST(LongRays, PacketsHitWhatSingleRaysHit) {
  const Atlas atlas = make_atlas(long_row(), Job());
  Camera camera;
  camera.eye = {-60, 1, 2};
  camera.target = {2000, 0, 0};
  camera.fov = 5;
  camera.width = 240;
  camera.height = 240;
  const HitBuffer hits = trace_primary(atlas, camera, Job());
  const RayGenerator rays(camera);
  int far = 0;
  for (int i = 0; i < 240 * 240; ++i) {
    const auto single = trace_ray(atlas, rays.ray(i % 240 + 0.5, i / 240 + 0.5));
    ASSERT_EQ(std::isfinite(hits.depth[i]), single.has_value()) << "pixel " << i;
    if (!single) continue;
    far += *single > 1000 ? 1 : 0;
    // Rounding of the picture's floats, and flat hits.
    ASSERT_NEAR(hits.depth[i], *single, 0.02 * kVoxel) << "pixel " << i;
  }
  EXPECT_GT(far, 2000);
}

// Whatever rays share a packet and a queue with it, a ray's steps are its own: from the eye, less
// those that a packet makes together.
TEST(Steps, AreNoMoreThanTheRayMakesAlone) {
  openvdb::initialize();
  const Atlas atlas = make_atlas(
      from_vdb(openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(20, {0, 0, 0}, kVoxel, 3)),
      Job());
  Camera camera;
  camera.eye = {0, 0, 24};
  camera.fov = 120;
  camera.width = 203;
  camera.height = 101;
  const HitBuffer hits = trace_primary(atlas, camera, Job());
  const RayGenerator rays(camera);
  int equal = 0;
  for (int i = 0; i < 203 * 101; ++i) {
    const Ray ray = rays.ray(i % 203 + 0.5, i / 203 + 0.5);
    const Walk alone = walk_ray(atlas, ray, 0, 1e300);
    // Starting elsewhere, it meets other empty cubes.
    ASSERT_LE(hits.steps[i], 1.25 * alone.steps + 4) << "pixel " << i;
    equal += hits.steps[i] == alone.steps ? 1 : 0;
  }
  EXPECT_GT(equal, 1000);
}

TEST(Atlas, RefusesTablesThatWouldFillTheMemory) {
  openvdb::initialize();
  auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(4, {0, 0, 0}, kVoxel, 3.0F);
  grid->tree().setValue({30000, 30000, 30000}, 0.1F);
  try {
    (void)make_atlas(from_vdb(grid), Job());
    FAIL() << "made tables of hundreds of gigabytes";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::failed);
    EXPECT_NE(std::string(error.what()).find("GB"), std::string::npos) << error.what();
  }
}

TEST(Normal, IsRadialOnASphereAndContinuous) {
  openvdb::initialize();
  const Atlas atlas = make_atlas(
      from_vdb(openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(10, {1, 2, 3}, kVoxel, 3)),
      Job());
  const glm::dvec3 center(1, 2, 3);
  glm::vec3 last(0.0F);
  double largest_step = 0;
  constexpr int kSteps = 20000;
  for (int i = 0; i <= kSteps; ++i) {
    // A circle aslant through many cells and bricks, 0.003 voxel a step.
    const double turn = 2 * 3.14159265358979 * i / kSteps;
    const glm::dvec3 out = std::cos(turn) * glm::normalize(glm::dvec3(1, 2, -1)) +
                           std::sin(turn) * glm::normalize(glm::dvec3(1, 0, 1));
    const glm::vec3 normal = normal_at(atlas, center + 10.0 * out);
    ASSERT_NEAR(glm::length(normal), 1, 1e-5);
    ASSERT_GT(glm::dot(glm::dvec3(normal), out), 0.9995);
    if (i > 0) largest_step = std::max<double>(largest_step, glm::length(normal - last));
    last = normal;
  }
  // The circle turns by 3.1e-4 a step; a jump at a border of cells would be a hundred times that.
  EXPECT_LT(largest_step, 1.5e-3);
}

}  // namespace
}  // namespace sdfgrid
