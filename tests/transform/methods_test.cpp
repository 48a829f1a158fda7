// What every dense method must do, looping over the list of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <ostream>
#include <vector>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "volumes.h"

namespace sdfgrid {

// How GoogleTest names a parameter.
// NOLINTNEXTLINE(readability-identifier-naming)
static void PrintTo(const TransformMethodInfo& info, std::ostream* out) { *out << info.name; }

namespace {

TransformOptions options_for(TransformMethod method) {
  TransformOptions options;
  options.method = method;
  if (method == TransformMethod::chamfer_mask) {
    options.steps = {{{1, 0, 0}, 1.0}, {{1, 1, 0}, 1.4}, {{1, 1, 1}, 1.7}, {{3, 2, 1}, 3.74}};
  }
  return options;
}

class EveryMethod : public testing::TestWithParam<TransformMethodInfo> {
 protected:
  [[nodiscard]] TransformOptions options() const { return options_for(GetParam().method); }
};

std::vector<TransformMethodInfo> methods_for_volumes() {
  std::vector<TransformMethodInfo> methods;
  std::ranges::copy_if(transform_methods(), std::back_inserter(methods),
                       &TransformMethodInfo::volumes);
  return methods;
}

// The largest error is 10.6 % (chamfer 3-4-5) of the distance, or 1.4 voxels (first order), and
// half a voxel of the mask; a sign must be right everywhere.
TEST_P(EveryMethod, FindsABallFromAMask) {
  const Values exact = sampled({{41, 44, 39}}, [](const glm::dvec3& p) { return ball(p, 12); });
  const std::vector<float> distance = transformed(mask_of(exact).seeds(), options());
  for (std::size_t i = 0; i < distance.size(); ++i) {
    const auto want = static_cast<double>(exact.values[i]);
    ASSERT_NEAR(distance[i], want, 0.11 * std::abs(want) + 1.9) << i;
    ASSERT_EQ(distance[i] < 0, want < 0) << i;
  }
}

TEST_P(EveryMethod, KeepsToItsSideAndWindow) {
  const Values exact = sampled({{20, 24, 22}}, [](const glm::dvec3& p) { return box(p, 5.4); });
  const Mask mask = mask_of(exact);
  TransformOptions with = options();
  with.side = TransformSide::outside;
  with.window = 4;
  const std::vector<float> outside = transformed(mask.seeds(), with);
  with.side = TransformSide::inside;
  const std::vector<float> inside = transformed(mask.seeds(), with);
  for (std::size_t i = 0; i < outside.size(); ++i) {
    const bool is_inside = mask.mask[i] != 0;
    ASSERT_EQ(outside[i] == 0, is_inside) << i;
    ASSERT_EQ(inside[i] == 0, !is_inside) << i;
    ASSERT_LE(outside[i], 4.0F);
    ASSERT_LE(inside[i], 4.0F);
    ASSERT_GE(outside[i] + inside[i], 0.0F);
    // Beyond the window there is nothing but it.
    const double away = std::abs(static_cast<double>(exact.values[i]));
    if (away > 7) {
      ASSERT_EQ(is_inside ? inside[i] : outside[i], 4.0F) << i;
    }
  }
}

TEST_P(EveryMethod, SaysInfinityWhereThereIsNoSurface) {
  for (const bool full : {false, true}) {
    Mask v{{{5, 9, 18}}};
    v.mask.assign(v.size(), full ? 1 : 0);
    const float infinity = std::numeric_limits<float>::infinity();
    const std::vector<float> far = transformed(v.seeds(), options());
    ASSERT_EQ(far, std::vector<float>(v.size(), full ? -infinity : infinity));
    TransformOptions with = options();
    with.window = 3;
    const std::vector<float> cut = transformed(v.seeds(), with);
    ASSERT_EQ(cut, std::vector<float>(v.size(), full ? -3.0F : 3.0F));
  }
}

// Half space along the one dimension that is not thin: every method is exact there.
TEST_P(EveryMethod, IsExactInThinVolumes) {
  for (int axis = 0; axis < 3; ++axis) {
    Shape shape{glm::ivec3(1)};
    shape.dims[axis] = 30;
    const Values exact = sampled(shape, [&](const glm::dvec3& p) { return p[axis] - 0.5; });
    const Mask mask = mask_of(exact);
    TransformOptions with = options();
    const std::vector<float> distance = transformed(mask.seeds(), with);
    const double step = GetParam().method == TransformMethod::chamfer3   ? 0.9398
                        : GetParam().method == TransformMethod::chamfer5 ? 0.9759
                                                                         : 1.0;
    int first = 0;
    while (mask.mask[static_cast<std::size_t>(first)] != 0) ++first;
    for (int i = 0; i < 30; ++i) {
      const double want = i >= first ? step * (i - first + 1) - 0.5 : 0.5 - step * (first - i);
      ASSERT_NEAR(distance[static_cast<std::size_t>(i)], want, 1e-5) << axis << " " << i;
    }
  }
}

// A plane across the long axis: distances along it are in its spacing.
TEST_P(EveryMethod, CountsSpacing) {
  for (int axis = 0; axis < 3; ++axis) {
    Shape shape{glm::ivec3(9)};
    shape.spacing[axis] = 10;
    const Values exact = sampled(shape, [&](const glm::dvec3& p) { return p[axis]; });
    TransformOptions with = options();
    with.side = TransformSide::outside;
    const std::vector<float> distance = transformed(mask_of(exact).seeds(), with);
    glm::ivec3 at(4);
    at[axis] = 0;
    while (exact.values[exact.index(at.x, at.y, at.z)] < 0) ++at[axis];
    const int first = at[axis];
    at[axis] = 8;
    const double got = distance[exact.index(at.x, at.y, at.z)];
    // From the last sample inside, or from half a step before it; the best real chamfer steps along
    // an axis are up to 6 % short.
    const double want = 10.0 * (9 - first);
    EXPECT_LE(got, want + 1e-4) << axis;
    EXPECT_GE(got, 0.93 * (want - 5)) << axis;
  }
}

TEST_P(EveryMethod, RefusesValuesThatAreNotFinite) {
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Values v = sampled({{6, 5, 7}}, [](const glm::dvec3& p) { return ball(p, 2); });
    v.values[v.index(3, 2, 4)] = bad;
    try {
      transformed(v.seeds(SeedKind::level), options());
      FAIL() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_NE(std::string(error.what()).find("[3, 2, 4]"), std::string::npos) << error.what();
    }
  }
}

TEST_P(EveryMethod, GivesTheSameBytesAtAnyNumberOfThreads) {
  const Mask v = noise({40, 50, 60}, 0.001, 11);
  std::vector<float> one;
  {
    const ThreadLimit limit(1);
    one = transformed(v.seeds(), options());
  }
  const ThreadLimit limit(4);
  EXPECT_EQ(one, transformed(v.seeds(), options()));
}

TEST_P(EveryMethod, StopsWhenCancelled) {
  const Mask v = noise({30, 30, 30}, 0.01, 2);
  std::vector<float> distance(v.size());
  const Job job;
  job.cancel();
  EXPECT_THROW(distance_transform(v.seeds(), options(), distance, job), Error);
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod, testing::ValuesIn(methods_for_volumes()),
                         [](const auto& method) { return std::string(method.param.name); });

TEST(Transform, RefusesWhatMakesNoSense) {
  const Mask v = noise({4, 5, 6}, 0.5, 1);
  std::vector<float> distance(v.size());
  const auto expect_usage = [&](DenseSeeds seeds, const TransformOptions& options,
                                std::span<float> out) {
    try {
      distance_transform(seeds, options, out, Job{});
      ADD_FAILURE() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage) << error.what();
    }
  };
  DenseSeeds seeds = v.seeds();
  expect_usage(seeds, {}, std::span(distance).first(7));
  seeds.dims.z = 0;
  expect_usage(seeds, {}, distance);
  seeds = v.seeds();
  seeds.spacing.y = 0;
  expect_usage(seeds, {}, distance);
  expect_usage(v.seeds(), {.window = -1}, distance);
  expect_usage(v.seeds(), {.method = TransformMethod::feature}, distance);
  expect_usage(v.seeds(), {.method = TransformMethod::fmm, .bucket_width = -1}, distance);
  expect_usage(v.seeds(), {.method = TransformMethod::chamfer_mask}, distance);
  expect_usage(v.seeds(), {.method = TransformMethod::chamfer_mask, .steps = {{{2, 2, 0}, 2.8}}},
               distance);
}

}  // namespace
}  // namespace sdfgrid
