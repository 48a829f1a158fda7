// What light is computed from: points on the surface, coarse distances, curvature.
#include "sdfgrid/trace/far_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "render/scenes.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/trace/curvature.h"

namespace sdfgrid {
namespace {

using test::cuboid;
using test::grid_of;
using test::unit_sphere;

glm::dvec3 world(const Atlas& atlas, const glm::vec3& local) {
  return atlas.lattice.to_world(glm::dvec3(atlas.lo * Atlas::kBrick) + glm::dvec3(local));
}

TEST(SurfacePoints, LieOnTheSphereAllAround) {
  const Atlas atlas = make_atlas(unit_sphere(), Job());
  const std::vector<glm::vec3> points = surface_points(atlas, Job());
  // The sphere's area in blocks of 4^2 voxels; a plane cuts one to three blocks over each.
  const double blocks = 4 * 3.14159 * 32 * 32 / 16;
  EXPECT_GT(points.size(), blocks);
  EXPECT_LT(points.size(), 3 * blocks);
  Box box;
  for (const glm::vec3& point : points) {
    const glm::dvec3 p = world(atlas, point);
    EXPECT_NEAR(glm::length(p), 1.0, 0.1 * atlas.lattice.voxel);
    box.add(p);
  }
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(box.lo[a], -1, 0.2 * atlas.lattice.voxel);
    EXPECT_NEAR(box.hi[a], 1, 0.2 * atlas.lattice.voxel);
  }
}

TEST(FarField, IsTheDistanceToTheSphereInsideAndOut) {
  const Atlas atlas = make_atlas(unit_sphere(), Job());
  const FarField far = make_far_field(atlas, surface_points(atlas, Job()), 24, Job());
  ASSERT_GT(far.values.size(), 0U);
  std::size_t node = 0;
  for (int x = 0; x < far.dims.x; ++x) {
    for (int y = 0; y < far.dims.y; ++y) {
      for (int z = 0; z < far.dims.z; ++z, ++node) {
        const glm::dvec3 p = world(atlas, far.origin + far.spacing * glm::vec3(x, y, z));
        const double exact = (glm::length(p) - 1) / atlas.lattice.voxel;
        EXPECT_GT(far.values[node] * exact, -1.0) << "the sign";
        // No point is nearer than the surface, and one is within l = 4 sqrt(2) voxels of its
        // nearest place: at distance d from a sphere of radius r, an excess of l^2 / 2 (1 / d + 1 /
        // r).
        const double excess = std::abs(far.values[node]) - std::abs(exact);
        EXPECT_GT(excess, -0.1);
        EXPECT_LT(excess, std::min(5.0, 16 / std::abs(exact) + 16.0 / 32 + 0.5)) << exact;
      }
    }
  }
}

TEST(FarField, OfNothingIsEmpty) {
  const Atlas atlas = make_atlas(Grid(), Job());
  EXPECT_TRUE(surface_points(atlas, Job()).empty());
  EXPECT_TRUE(make_far_field(atlas, {}, 24, Job()).values.empty());
}

TEST(FarField, IsTheSameAtAnyNumberOfThreads) {
  const Atlas atlas = make_atlas(unit_sphere(), Job());
  const ThreadLimit one(1);
  const std::vector<glm::vec3> alone = surface_points(atlas, Job());
  const ThreadLimit four(4);
  EXPECT_EQ(surface_points(atlas, Job()), alone);
}

TEST(Curvature, OfASphereIsOneOverItsRadius) {
  const Atlas atlas = make_atlas(unit_sphere(), Job());
  for (int i = 0; i < 200; ++i) {
    const double z = (i + 0.5) / 100 - 1;
    const double r = std::sqrt(1 - z * z);
    EXPECT_NEAR(mean_curvature_at(atlas, {r * std::cos(i), r * std::sin(i), z}), 1.0, 0.02);
  }
}

TEST(Curvature, OfAFlatFaceIsZero) {
  const Grid box = grid_of(cuboid(glm::dvec3(-0.5), glm::dvec3(0.5)),
                           {glm::dvec3(-0.8), glm::dvec3(0.8)}, 1.0 / 16);
  const Atlas atlas = make_atlas(box, Job());
  EXPECT_NEAR(mean_curvature_at(atlas, {0.5, 0.03, -0.02}), 0.0, 1e-3);
  EXPECT_GT(mean_curvature_at(atlas, {0.5, 0.5, 0.0}), 1.0) << "an edge bulges";
}

}  // namespace
}  // namespace sdfgrid
