// A measuring tool must read zero on what is right and the right number on what is wrong. Grids are
// made here from closed forms, which neither the converter nor the reference knows, and then
// broken.
#include "sdfgrid/grid/compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "property/random_meshes.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/compare_summary.h"
#include "sdfgrid/grid/vdb.h"
#include "sdfgrid/mesh/reference.h"

namespace sdfgrid {
namespace {

using glm::dvec3;
using Distance = std::function<double(const dvec3&)>;

constexpr double kVoxel = 0.05;
const CompareOptions kAll{20000, 1};  // more than a grid here has voxels: every one is measured
constexpr double kFloat = 3e-8;       // of the mesh's points and the grid's values

double box_distance(const dvec3& p, const dvec3& half) {
  const dvec3 q = glm::abs(p) - half;
  return glm::length(glm::max(q, 0.0)) + std::min(std::max({q.x, q.y, q.z}), 0.0);
}

const dvec3 kHalf(0.51, 0.32, 0.43);  // no face of the box is on the lattice
const Distance kBox = [](const dvec3& p) { return box_distance(p, kHalf); };
const Distance kSphere = [](const dvec3& p) { return glm::length(p) - 0.5; };

TriangleSoup box() { return shapes::box_mesh(-kHalf, kHalf); }

struct Widths {
  double out = 3;
  double in = 3;
};

// A narrow band of float values, as a converter stores it, in index space [-edge, edge]^3.
Grid make_grid(const Distance& distance, Widths widths = {}, double voxel = kVoxel, int edge = 24,
               const dvec3& origin = dvec3(0.0)) {
  openvdb::initialize();
  const auto out = static_cast<float>(widths.out * voxel);
  const auto in = static_cast<float>(widths.in * voxel);
  auto grid = openvdb::FloatGrid::create(out);
  auto transform = openvdb::math::Transform::createLinearTransform(voxel);
  transform->postTranslate({origin.x, origin.y, origin.z});
  grid->setTransform(transform);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  auto accessor = grid->getAccessor();
  for (int i = -edge; i <= edge; ++i) {
    for (int j = -edge; j <= edge; ++j) {
      for (int k = -edge; k <= edge; ++k) {
        const auto d = static_cast<float>(distance(voxel * dvec3(i, j, k)));
        const openvdb::Coord at(i, j, k);
        if (d >= out) continue;
        if (d > -in) {
          accessor.setValueOn(at, d);
        } else {
          accessor.setValueOff(at, -in);
        }
      }
    }
  }
  return from_vdb(grid);
}

Comparison measured(const Grid& grid, const TriangleSoup& mesh) {
  return compare(grid, mesh, kAll, Job());
}

void set(const Grid& grid, const glm::ivec3& at, float value) {
  vdb(grid)->tree().setValueOnly(openvdb::Coord(at.x, at.y, at.z), value);
}

// ---- many errors in a few numbers ---------------------------------------------------------------

TEST(Summary, OfOneToTwoHundred) {
  std::vector<SampleError> samples(250);  // fifty found no place
  for (int i = 0; i < 200; ++i) {
    const int shuffled = 1 + (i * 77) % 200;
    samples[i] = {true, shuffled % 10 == 0, static_cast<double>(shuffled), dvec3(shuffled)};
  }
  const ErrorSummary summary = summarize(samples);
  EXPECT_EQ(summary.samples, 200U);
  EXPECT_EQ(summary.max_error, 200);
  EXPECT_EQ(summary.worst, dvec3(200));
  EXPECT_EQ(summary.p99_error, 198);
  EXPECT_EQ(summary.mean_error, 100.5);
  EXPECT_DOUBLE_EQ(summary.rms_error, std::sqrt(201.0 * 401.0 / 6.0));
  EXPECT_EQ(summary.sign_errors, 20U);
  EXPECT_EQ(summarize({}).samples, 0U);
}

// ---- what is right reads zero -------------------------------------------------------------------

TEST(Compare, AnExactGridHasNoErrorButInterpolations) {
  const Grid grid = make_grid(kBox);
  const Comparison c = measured(grid, box());
  EXPECT_EQ(c.voxel, kVoxel);
  EXPECT_TRUE(c.signs);
  EXPECT_TRUE(c.warnings.empty());
  EXPECT_EQ(c.voxels.samples, grid.active_voxels());
  EXPECT_LT(c.voxels.max_error, kFloat);  // float
  EXPECT_GT(c.voxels.max_error, 0);
  EXPECT_EQ(c.sign_errors(), 0U);
  EXPECT_EQ(c.inactive.samples, kAll.samples / 4 + 1);
  EXPECT_LT(c.inactive.max_error, kFloat);
  EXPECT_EQ(c.wrong_constants, 0U);
  EXPECT_EQ(c.undecided_signs, 0U);
  EXPECT_TRUE(c.within(kFloat));
  EXPECT_FALSE(c.within(1e-12));
  // The edges of the box are cut off between the voxels.
  EXPECT_EQ(c.interpolated.samples, kAll.samples);
  EXPECT_GT(c.interpolated.max_error, 0.1 * kVoxel);
  EXPECT_LT(c.interpolated.max_error, std::sqrt(3.0) / 2 * kVoxel);
  EXPECT_EQ(c.interpolated.sign_errors, 0U);
}

TEST(Compare, SeesTheCurvatureThatInterpolationMisses) {
  // On a sphere interpolation misses by (sum of w (1 - w) h^2 over the two axes along it) / 2 r, at
  // most h^2 / 4 r: r is 7 voxels at the inner end of the band.
  const Comparison c = measured(make_grid(kSphere), shapes::icosphere(6, 0.5));
  const double facets = 0.5 * 2e-4;
  EXPECT_LT(c.voxels.max_error, facets);
  EXPECT_LT(c.interpolated.max_error, kVoxel / (4 * 7) * 1.15);
  EXPECT_GT(c.interpolated.max_error, kVoxel / (4 * 7) * 0.85);
}

TEST(Compare, FarFromZero) {
  const dvec3 origin(6e5, 4e6, -120);
  TriangleSoup mesh = box();
  mesh.origin = origin;
  const Comparison c = measured(make_grid(kBox, {}, kVoxel, 24, origin), mesh);
  EXPECT_LT(c.voxels.max_error, kFloat);
  EXPECT_EQ(c.sign_errors(), 0U);
}

TEST(Compare, BandsOfTwoWidths) {
  const Comparison c = measured(make_grid(kBox, {2, 5}), box());
  EXPECT_LT(c.voxels.max_error, kFloat);
  EXPECT_LT(c.inactive.max_error, kFloat);
  EXPECT_EQ(c.wrong_constants, 0U);
  EXPECT_EQ(c.sign_errors(), 0U);
}

TEST(Compare, ActiveValuesClampedToTheBackgroundAreBounds) {
  // Outside all is active; inside is a band as ever.
  const auto clamped = [](const dvec3& p) { return std::min(kBox(p), 0.15); };
  const Grid grid = make_grid(clamped, {100, 3}, kVoxel, 15);
  EXPECT_GT(measured(grid, box()).voxels.max_error, 1.0 * kVoxel) << "the background is 100";
  vdb(grid)->tree().root().setBackground(0.15F, false);
  const Comparison c = measured(grid, box());
  EXPECT_LT(c.voxels.max_error, kFloat);
  EXPECT_LT(c.interpolated.max_error, kVoxel);
}

// ---- what is wrong is found ---------------------------------------------------------------------

TEST(Compare, OneWrongValue) {
  const Grid grid = make_grid(kBox);
  const glm::ivec3 at(11, 2, -3);
  set(grid, at, grid.value(at) + static_cast<float>(0.3 * kVoxel));
  const Comparison c = measured(grid, box());
  EXPECT_NEAR(c.voxels.max_error, 0.3 * kVoxel, kFloat);
  EXPECT_EQ(c.voxels.worst, kVoxel * dvec3(at));
  EXPECT_EQ(c.sign_errors(), 0U);
  const auto count = static_cast<double>(c.voxels.samples);
  EXPECT_NEAR(c.voxels.rms_error, 0.3 * kVoxel / std::sqrt(count), 1e-7);
  EXPECT_NEAR(c.voxels.mean_error, 0.3 * kVoxel / count, kFloat);
  EXPECT_LT(c.voxels.p99_error, kFloat);
}

TEST(Compare, OneWrongSign) {
  const Grid grid = make_grid(kBox);
  const glm::ivec3 at(9, 2, -3);
  const float value = grid.value(at);
  ASSERT_LT(value, 0);
  set(grid, at, -value);
  const Comparison c = measured(grid, box());
  EXPECT_EQ(c.voxels.sign_errors, 1U);
  EXPECT_NEAR(c.voxels.max_error, -2 * value, kFloat);
  EXPECT_FALSE(c.within(1.0)) << "no tolerance forgives a wrong sign";
}

TEST(Compare, NotANumber) {
  const Grid grid = make_grid(kBox);
  set(grid, {11, 2, -3}, std::numeric_limits<float>::quiet_NaN());
  const Comparison c = measured(grid, box());
  EXPECT_EQ(c.voxels.max_error, std::numeric_limits<double>::infinity());
  EXPECT_FALSE(c.within(1.0));
}

TEST(Compare, HalfAVoxelAside) {
  const Grid grid = make_grid(kBox, {}, kVoxel, 24, dvec3(0.5 * kVoxel, 0, 0));
  const Comparison c = measured(grid, box());
  EXPECT_NEAR(c.voxels.max_error, 0.5 * kVoxel, 1e-7);
  EXPECT_GT(c.voxels.rms_error, 0.1 * kVoxel);
  EXPECT_GT(c.interpolated.rms_error, 0.1 * kVoxel);
  EXPECT_GT(c.sign_errors(), 0U);
}

TEST(Compare, AxesSwapped) {
  const Comparison c = measured(make_grid([](const dvec3& p) {
                                  return kBox({p.y, p.x, p.z});
                                }),
                                box());
  EXPECT_GT(c.voxels.max_error, 2 * kVoxel);
  EXPECT_GT(c.sign_errors(), 500U);
}

TEST(Compare, InteriorWithoutSign) {
  const Grid grid = make_grid(kBox);
  for (auto off = vdb(grid)->tree().beginValueOff(); off; ++off) {
    off.setValue(std::abs(*off));
  }
  const Comparison c = measured(grid, box());
  EXPECT_EQ(c.voxels.sign_errors, 0U);
  EXPECT_GT(c.inactive.sign_errors, 100U);
  EXPECT_FALSE(c.within(1e-6));
}

TEST(Compare, OutsideFilled) {
  const Grid grid = make_grid(kBox);
  const auto background = static_cast<float>(3 * kVoxel);
  vdb(grid)->tree().fill(openvdb::CoordBBox({16, 8, 8}, {23, 15, 15}), -background, false);
  const Comparison c = measured(grid, box());
  EXPECT_GT(c.inactive.sign_errors, 0U);
  EXPECT_FALSE(c.within(1e-6));
}

TEST(Compare, HolesInTheBand) {
  // Voxels that should be active say "three voxels or more".
  const Grid grid = make_grid(kBox);
  const auto background = static_cast<float>(3 * kVoxel);
  for (int k = -5; k <= 5; ++k) {
    for (int j = -3; j <= 3; ++j) {
      vdb(grid)->tree().setValueOff(openvdb::Coord(11, j, k), background);
    }
  }
  const Comparison c = measured(grid, box());
  EXPECT_EQ(c.sign_errors(), 0U);
  EXPECT_NEAR(c.inactive.max_error, background - kBox(kVoxel * dvec3(11, 0, 0)), 1e-7);
  EXPECT_FALSE(c.within(0.1 * kVoxel));
}

TEST(Compare, WrongConstantsBeyondTheBand) {
  const Grid grid = make_grid(kBox);
  vdb(grid)->tree().fill(openvdb::CoordBBox({16, 8, 8}, {23, 15, 15}), 0.01F, false);
  EXPECT_GT(measured(grid, box()).wrong_constants, 0U);
}

// ---- meshes as they are -------------------------------------------------------------------------

TEST(Compare, TurnsMeshesAsTheConverterDoes) {
  const Grid grid = make_grid(kBox);
  const Comparison inside_out = measured(grid, shapes::flipped(box()));
  EXPECT_LT(inside_out.voxels.max_error, kFloat);
  EXPECT_FALSE(inside_out.warnings.empty());

  const dvec3 inner = 0.4 * kHalf;
  const Grid hollow =
      make_grid([&](const dvec3& p) { return std::max(kBox(p), -box_distance(p, inner)); });
  const TriangleSoup both_outward = shapes::joined(box(), shapes::box_mesh(-inner, inner));
  const Comparison nested = measured(hollow, both_outward);
  EXPECT_LT(nested.voxels.max_error, 1e-7);
  EXPECT_EQ(nested.sign_errors(), 0U);
  EXPECT_FALSE(nested.warnings.empty());
}

TEST(Compare, OpenMeshesHaveNoSideInTheirOpenings) {
  const TriangleSoup open = shapes::with_hole(shapes::icosphere(3, 0.5), 0, 320);
  const ReferenceDistance reference(open);
  // The side by the sum of solid angles, everywhere exact.
  const auto distance = [&](const dvec3& p) {
    const double d = reference.distance(p);
    return reference.winding_number_by_sum(p) > 0.5 ? -d : d;
  };
  const Grid grid = make_grid(distance, {}, 0.1, 9);
  const Comparison c = measured(grid, open);
  EXPECT_LT(c.voxels.max_error, 1e-7);
  EXPECT_EQ(c.sign_errors(), 0U);
  EXPECT_GT(c.undecided_signs, 0U);
  EXPECT_LT(c.undecided_signs, c.interpolated.samples / 50);
}

TEST(Compare, GridsWithoutSignsByAbsoluteValue) {
  const Grid grid = make_grid([](const dvec3& p) { return std::abs(kBox(p)); });
  vdb(grid)->setGridClass(openvdb::GRID_UNKNOWN);
  const Comparison c = measured(grid, box());
  EXPECT_FALSE(c.signs);
  EXPECT_LT(c.voxels.max_error, kFloat);
  EXPECT_LT(c.inactive.max_error, kFloat);
  EXPECT_EQ(c.sign_errors(), 0U);
  EXPECT_EQ(c.wrong_constants, 0U);
}

// ---- sampling -----------------------------------------------------------------------------------

void expect_same(const ErrorSummary& a, const ErrorSummary& b) {
  EXPECT_EQ(a.samples, b.samples);
  EXPECT_EQ(a.max_error, b.max_error);
  EXPECT_EQ(a.rms_error, b.rms_error);
  EXPECT_EQ(a.p99_error, b.p99_error);
  EXPECT_EQ(a.mean_error, b.mean_error);
  EXPECT_EQ(a.sign_errors, b.sign_errors);
  EXPECT_EQ(a.worst, b.worst);
}

TEST(Compare, TheSameAtAnyNumberOfThreads) {
  const Grid grid = make_grid(kSphere);
  const TriangleSoup mesh = shapes::icosphere(3, 0.5);
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return compare(grid, mesh, {5000, 7}, Job());
  };
  const Comparison one = with_threads(1);
  const Comparison four = with_threads(4);
  EXPECT_EQ(one.voxels.samples, 5000U);
  expect_same(one.voxels, four.voxels);
  expect_same(one.interpolated, four.interpolated);
  expect_same(one.inactive, four.inactive);
  const Comparison other_seed = compare(grid, mesh, {5000, 8}, Job());
  EXPECT_NE(one.voxels.rms_error, other_seed.voxels.rms_error);
  EXPECT_NEAR(one.interpolated.rms_error, other_seed.interpolated.rms_error,
              0.05 * one.interpolated.rms_error);
}

TEST(Compare, RefusesEmptyGridsAndStopsWhenCancelled) {
  EXPECT_THROW((void)compare(Grid(), box(), kAll, Job()), Error);
  EXPECT_THROW((void)compare(make_grid(kBox), TriangleSoup(), kAll, Job()), Error);
  Job job;
  job.cancel();
  EXPECT_THROW((void)compare(make_grid(kBox), box(), kAll, job), Error);
}

// ---- grid against grid, mesh against mesh -------------------------------------------------------

TEST(CompareGrids, FindsADifferenceOnEitherSide) {
  const Grid grid = make_grid(kBox);
  const Comparison same = compare(grid, grid.clone(), kAll, Job());
  EXPECT_LT(same.voxels.max_error, 1e-12);
  EXPECT_LT(same.interpolated.max_error, 1e-12);
  EXPECT_LT(same.inactive.max_error, 1e-12);
  EXPECT_EQ(same.voxels.samples, 2 * grid.active_voxels());
  EXPECT_EQ(same.sign_errors(), 0U);

  const Grid changed = grid.clone();
  set(changed, {9, 2, -3}, -grid.value({9, 2, -3}));
  for (const Comparison& c :
       {compare(grid, changed, kAll, Job()), compare(changed, grid, kAll, Job())}) {
    EXPECT_EQ(c.voxels.sign_errors, 2U);  // seen from both
    EXPECT_NEAR(c.voxels.max_error, 2 * std::abs(grid.value({9, 2, -3})), 1e-9);
  }

  const Grid more = grid.clone();  // a voxel that the other does not have
  vdb(more)->tree().setValueOn(openvdb::Coord(20, 20, 20), 0.01F);
  EXPECT_NEAR(compare(grid, more, kAll, Job()).voxels.max_error, 3 * kVoxel - 0.01, 1e-7);
}

TEST(CompareGrids, OfTwoResolutionsAndWidths) {
  const Grid coarse = make_grid(kSphere, {3, 3}, 0.05, 24);
  const Grid fine = make_grid(kSphere, {4, 4}, 0.02, 40);
  const Comparison c = compare(coarse, fine, kAll, Job());
  EXPECT_LT(c.voxels.max_error, 0.1 * 0.05);
  EXPECT_GT(c.voxels.max_error, 0);
  EXPECT_EQ(c.sign_errors(), 0U);
}

TEST(CompareMeshes, HausdorffOfConcentricSpheres) {
  const TriangleSoup small = shapes::icosphere(4, 1.0);
  const SurfaceComparison c = compare(small, shapes::scaled(small, 1.1), {20000, 1}, Job());
  EXPECT_NEAR(c.a_to_b.max_error, 0.1, 0.002);
  EXPECT_NEAR(c.b_to_a.max_error, 0.1, 0.002);
  EXPECT_NEAR(c.a_to_b.mean_error, 0.1, 0.002);
  EXPECT_LT(compare(small, small, {20000, 1}, Job()).hausdorff(), 1e-15);
}

TEST(CompareMeshes, IsOneSidedWhereOneIsAPart) {
  const TriangleSoup whole = shapes::icosphere(3, 1.0);
  const TriangleSoup part = shapes::with_hole(whole, 0, 80);
  const SurfaceComparison c = compare(part, whole, {20000, 1}, Job());
  EXPECT_LT(c.a_to_b.max_error, 1e-15);
  EXPECT_GT(c.b_to_a.max_error, 0.1);
  EXPECT_EQ(c.hausdorff(), c.b_to_a.max_error);
}

}  // namespace
}  // namespace sdfgrid
