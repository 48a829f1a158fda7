// Bands of meshes by every transform, against exact conversion of the same band.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "property/random_meshes.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/transform/brick_table.h"
#include "sdfgrid/transform/nearest_sites.h"
#include "sdfgrid/transform/site_kernel.h"

namespace sdfgrid {
namespace {

Conversion converted(const TriangleSoup& soup, std::optional<TransformMethod> method, double width,
                     SignMethod sign = SignMethod::automatic) {
  ConvertOptions options;
  options.voxel = 0.05;
  options.band = {width, width};
  options.sign = sign;
  if (method) {
    options.transform = TransformOptions{.method = *method};
    if (method == TransformMethod::chamfer_mask) {
      options.transform->steps = {
          {{1, 0, 0}, 1.0}, {{1, 1, 0}, 1.41}, {{1, 1, 1}, 1.73}, {{3, 2, 1}, 3.74}};
    }
  }
  return convert_mesh(soup, options, Job{});
}

struct Difference {
  double max = 0;  // voxels
  double mean = 0;
  double p999 = 0;  // 99.9 % of the samples are nearer
  std::size_t missing = 0;
  std::size_t signs = 0;
  std::size_t samples = 0;
};

// Of all active voxels of `exact` from `got`.
Difference difference(const Grid& got, const Grid& exact) {
  glm::ivec3 lo;
  glm::ivec3 hi;
  exact.active_bounds(lo, hi);
  const double voxel = exact.lattice().voxel;
  const auto background = static_cast<double>(exact.background());
  std::vector<double> all;
  Difference d;
  for (int x = lo.x; x <= hi.x; ++x) {
    for (int y = lo.y; y <= hi.y; ++y) {
      for (int z = lo.z; z <= hi.z; ++z) {
        const double want = exact.value({x, y, z});
        const double have = got.value({x, y, z});
        if ((want < 0) != (have < 0)) ++d.signs;
        if (std::abs(want) >= background) continue;
        all.push_back(std::abs(want - have) / voxel);
      }
    }
  }
  std::sort(all.begin(), all.end());
  d.samples = all.size();
  d.max = all.back();
  for (const double e : all) d.mean += e / static_cast<double>(all.size());
  d.p999 = all[all.size() * 999 / 1000];
  return d;
}

TriangleSoup two_shapes() {
  return shapes::joined(shapes::torus_mesh(1.2, 0.45),
                        shapes::box_mesh({-0.4, -0.3, 1.1}, {0.5, 0.4, 1.9}));
}

TEST(MeshTransform, EveryMethodKeepsItsBoundAndTheSigns) {
  // Largest error and mean, voxels, for a band of 8: what docs/methods.md says of each. The box's
  // corners are samples, and sqrt(3) from the nearest sample inside: a mask is sqrt(3) - 1/2 off
  // there.
  const std::map<std::string_view, std::pair<double, double>> bounds = {
      {"feature", {0.35, 0.002}}, {"cpm", {0.5, 0.01}},        {"fmm2", {0.8, 0.06}},
      {"fmm", {1.6, 0.3}},        {"chamfer345", {1.5, 0.45}}, {"chamfer3", {1.2, 0.4}},
      {"chamfer5", {0.4, 0.12}},  {"chamfer", {0.6, 0.15}},    {"meijster", {1.24, 0.3}}};
  const TriangleSoup soup = two_shapes();
  const Conversion exact = converted(soup, std::nullopt, 8);
  for (const TransformMethodInfo& info : transform_methods()) {
    if (!info.meshes) continue;
    const Conversion made = converted(soup, info.method, 8);
    const Difference d = difference(made.grid, exact.grid);
    const auto [max, mean] = bounds.at(info.name);
    EXPECT_LT(d.max, max) << info.name;
    EXPECT_LT(d.mean, mean) << info.name;
    EXPECT_EQ(d.signs, 0U) << info.name;
    EXPECT_GT(d.samples, 100000U);
  }
}

// Triangles of 1.4 voxels, smaller than a cell. Inside of a ball which cell is nearest says little
// of where the nearest point is, the less so the nearer its centre (20 voxels) is.
TEST(MeshTransform, FeatureIsNearlyExact) {
  const std::pair<double, double> bounds[] = {{2, 0.001}, {5, 0.025}, {10, 0.06}, {22, 0.15}};
  for (const auto& [width, p999] : bounds) {
    const TriangleSoup soup = shapes::icosphere(4, 1.0, {0.3, 0.1, -0.2});
    const Conversion exact = converted(soup, std::nullopt, width);
    const Conversion made = converted(soup, TransformMethod::feature, width);
    const Difference d = difference(made.grid, exact.grid);
    std::printf("feature, width %g: 99.9 %% within %.4f, largest %.3f\n", width, d.p999, d.max);
    EXPECT_LT(d.p999, p999) << width;
    EXPECT_EQ(d.signs, 0U) << width;
    EXPECT_NEAR(static_cast<double>(made.grid.active_voxels()),
                static_cast<double>(exact.grid.active_voxels()),
                1e-3 * static_cast<double>(exact.grid.active_voxels()));
  }
}

// A brick may have more triangles than its lists count.
TEST(MeshTransform, FeatureDoesMeshesMuchFinerThanTheGrid) {
  const TriangleSoup soup = shapes::icosphere(7, 0.15, {0.2, 0.2, 0.2});  // in one brick 327,680
  const Conversion exact = converted(soup, std::nullopt, 2);
  const Conversion made = converted(soup, TransformMethod::feature, 2);
  const Difference d = difference(made.grid, exact.grid);
  std::printf("feature, fine: 99.9 %% within %.4f, largest %.3f\n", d.p999, d.max);
  EXPECT_LT(d.p999, 0.1);
  EXPECT_EQ(d.signs, 0U);
}

TEST(MeshTransform, DoesHolesAndSheets) {
  const TriangleSoup holed = shapes::with_hole(shapes::icosphere(3, 1.0), 100, 40);
  for (const auto sign : {SignMethod::winding, SignMethod::no_sign}) {
    const Conversion exact = converted(holed, std::nullopt, 5, sign);
    const Conversion made = converted(holed, TransformMethod::feature, 5, sign);
    const Difference d = difference(made.grid, exact.grid);
    EXPECT_LT(d.p999, 0.05);
    EXPECT_EQ(d.signs, 0U);
  }
}

TEST(MeshTransform, GivesTheSameGridAtAnyNumberOfThreads) {
  const TriangleSoup soup = two_shapes();
  for (const auto method : {TransformMethod::feature, TransformMethod::closest_point}) {
    Grid one;
    {
      const ThreadLimit limit(1);
      one = converted(soup, method, 6).grid;
    }
    const ThreadLimit limit(4);
    const Grid many = converted(soup, method, 6).grid;
    const Difference d = difference(many, one);
    EXPECT_EQ(d.max, 0.0) << transform_name(method);
    EXPECT_EQ(one.active_voxels(), many.active_voxels());
  }
}

TEST(MeshTransform, RefusesWhatIsNotForMeshes) {
  for (const auto& [method, width] :
       {std::pair(TransformMethod::meijster, 30.0), std::pair(TransformMethod::feature, 100.0)}) {
    try {
      converted(two_shapes(), method, width);
      FAIL() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
    }
  }
}

// The band by bricks is what the dense transform makes of the same mask, in every sample.
TEST(MeshTransform, MeijsterIsTheDenseTransformOfTheMask) {
  const TriangleSoup soup = two_shapes();
  const double width = 6;
  const Grid got = converted(soup, TransformMethod::meijster, width).grid;
  glm::ivec3 lo;
  glm::ivec3 hi;
  got.active_bounds(lo, hi);
  lo -= 2;
  hi += 2;
  const Grid exact = converted(soup, std::nullopt, 3).grid;
  const glm::ivec3 dims = hi - lo + 1;
  std::vector<std::uint8_t> mask;
  for (int x = lo.x; x <= hi.x; ++x) {
    for (int y = lo.y; y <= hi.y; ++y) {
      for (int z = lo.z; z <= hi.z; ++z) mask.push_back(exact.value({x, y, z}) < 0 ? 1 : 0);
    }
  }
  std::vector<float> dense(mask.size());
  const double voxel = got.lattice().voxel;
  distance_transform({dims, glm::dvec3(voxel), mask}, {.window = 100}, dense, Job{});
  std::size_t n = 0;
  std::size_t in_band = 0;
  for (int x = lo.x; x <= hi.x; ++x) {
    for (int y = lo.y; y <= hi.y; ++y) {
      for (int z = lo.z; z <= hi.z; ++z) {
        const auto want = static_cast<double>(dense[n++]);
        const double cut = std::clamp(want, -width * voxel, width * voxel);
        ASSERT_NEAR(got.value({x, y, z}), cut, 1e-6) << x << " " << y << " " << z;
        in_band += std::abs(want) < width * voxel - 1e-9 ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(got.active_voxels(), in_band);
}

TEST(MeshTransform, MeijsterNeedsSigns) {
  EXPECT_THROW((void)converted(two_shapes(), TransformMethod::meijster, 3, SignMethod::no_sign),
               Error);
}

// The nearest site of every sample, against trying all of them; equally near ones may differ.
TEST(NearestSites, MatchBruteForce) {
  shapes::Random random(7);
  for (const int reach : {1, 3, 8, 11, kLargestReach}) {
    const BrickTable table({{0, 0, 0}, {1, 0, 0}, {-1, 2, 0}, {0, 0, 0}});
    ASSERT_EQ(table.size(), 3U);
    std::vector<SiteBits> sites(table.size());
    std::vector<glm::ivec3> all;
    for (std::size_t b = 0; b < table.size(); ++b) {
      for (int n = 0; n < 6; ++n) {
        const int s = random.integer(0, 511);
        sites[b][static_cast<std::size_t>(s >> 6)] |= 1ULL << (s & 63);
        all.push_back(table.coordinates()[b] * 8 + glm::ivec3(s >> 6, s >> 3 & 7, s & 7));
      }
    }
    const NearestSites nearest(table, sites, reach, Job{});
    std::size_t found = 0;
    std::size_t in_reach = 0;
    const auto least = [&](const glm::ivec3& at) {
      int best = 1 << 30;
      for (const glm::ivec3& site : all) {
        const glm::ivec3 d = site - at;
        best = std::min(best, d.x * d.x + d.y * d.y + d.z * d.z);
      }
      return best;
    };
    for (std::size_t i = 0; i < nearest.bricks().size(); ++i) {
      SiteKeys keys;
      const bool any = nearest.keys(i, keys);
      for (int s = 0; s < 512; ++s) {
        const glm::ivec3 at =
            nearest.bricks().coordinates()[i] * 8 + glm::ivec3(s >> 6, s >> 3 & 7, s & 7);
        const int want = least(at);
        if (!any || keys[static_cast<std::size_t>(s)] >= kNoSite) {
          ASSERT_GT(want, reach * reach);
          continue;
        }
        const glm::ivec3 offset = site_offset(keys[static_cast<std::size_t>(s)]);
        ASSERT_EQ(offset.x * offset.x + offset.y * offset.y + offset.z * offset.z, want);
        ASSERT_TRUE(std::find(all.begin(), all.end(), at + offset) != all.end());
        ++found;
      }
    }
    for (int x = -40; x < 40; ++x) {
      for (int y = -30; y < 50; ++y) {
        for (int z = -30; z < 40; ++z) in_reach += least({x, y, z}) <= reach * reach ? 1 : 0;
      }
    }
    EXPECT_EQ(found, in_reach) << reach;
  }
}

}  // namespace
}  // namespace sdfgrid
