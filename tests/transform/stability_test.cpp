// Where the methods fail, by how much, and where they do not: the figures of docs/stability.md.
#include <gtest/gtest.h>

#include <cmath>

#include "sdfgrid/transform/chamfer.h"
#include "sdfgrid/transform/marching.h"
#include "volumes.h"

namespace sdfgrid {
namespace {

Values ball_values(int n) {
  return sampled({glm::ivec3(n)}, [n](const glm::dvec3& p) { return ball(p, 0.3 * n); });
}

Errors marched(const Values& exact, const TransformOptions& options,
               SeedKind kind = SeedKind::distance) {
  return errors(transformed(exact.seeds(kind), options), exact);
}

// Mean errors in voxels of volumes of `coarse` and `fine` samples a side; the order is of the error
// in world units.
double order(int coarse, int fine) {
  const TransformOptions options{.method = TransformMethod::fmm2};
  const double low = marched(ball_values(coarse), options).mean;
  const double high = marched(ball_values(fine), options).mean;
  return 1 + std::log(low / high) / std::log(double(fine) / coarse);
}

TEST(Marching, SecondOrderConvergesFromExactSeeds) {
  EXPECT_LT(marched(ball_values(128), {.method = TransformMethod::fmm2}).mean, 0.0045);
  EXPECT_GT(order(32, 64), 1.55);
  EXPECT_GT(order(64, 128), 1.78);
  EXPECT_GT(order(128, 192), 1.9);
}

TEST(Marching, LinearSeedsCostAnOrder) {
  TransformOptions options{.method = TransformMethod::fmm2};
  const Values exact = ball_values(64);
  const double good = marched(exact, options, SeedKind::distance).mean;
  const double linear = marched(exact, options, SeedKind::level).mean;
  EXPECT_GT(linear, 2 * good);
  EXPECT_LT(linear, 0.1);
}

TEST(Marching, FirstOrderIsMoreThanAVoxelOff) {
  const Values exact = ball_values(64);
  const Errors first = marched(exact, {.method = TransformMethod::fmm});
  EXPECT_GT(first.mean, 0.1);
  EXPECT_LT(first.max, 1.5);
}

TEST(Marching, BoxEdges) {
  const Values exact = sampled({glm::ivec3(48)}, [](const glm::dvec3& p) { return box(p, 11.7); });
  const Errors second = marched(exact, {.method = TransformMethod::fmm2});
  EXPECT_GT(second.max, 0.2) << "second order at the corners of a box";
  EXPECT_LT(second.max, 0.5);
  EXPECT_LT(marched(exact, {.method = TransformMethod::closest_point}).max, 0.1);
}

TEST(Marching, BucketsUpToAQuarterChangeNothing) {
  const Values exact = ball_values(64);
  const auto with = [&](double width) {
    return marched(exact, {.method = TransformMethod::fmm2, .bucket_width = width}).mean;
  };
  const double heap = with(0);
  for (const double width : {1.0 / 64, 1.0 / 16, 0.25}) {
    EXPECT_NEAR(with(width), heap, 0.005 * heap) << width;
  }
  EXPECT_GT(with(1), 1.1 * heap);
  EXPECT_LT(with(2), 2 * heap);
}

// The same front by hand, for the order in a bucket, which options do not offer.
double mean_by_order(BucketQueue::Order order, double width) {
  MarchOptions options;
  options.order = 2;
  options.bucket_width = width;
  options.bucket_order = order;
  options.out_limit = options.in_limit = 20;
  options.grow = true;
  March march(options);
  const auto exact = [](const glm::ivec3& at) {
    return ball(glm::dvec3(at) + glm::dvec3(0.13, 0.29, -0.31), 20);
  };
  for (int x = -4; x < 4; ++x) {
    for (int y = -4; y < 4; ++y) {
      for (int z = -4; z < 4; ++z) march.field().make({x, y, z});
    }
  }
  march.reserve();
  const auto made = static_cast<std::uint32_t>(march.field().size() * 512);
  for (std::uint32_t s = 512; s < made; ++s) {
    const double d = exact(march.field().index(s));
    if (std::abs(d) < 2) march.seed(s, static_cast<float>(d));
  }
  march.run(Job{});
  double sum = 0;
  int count = 0;
  for (std::uint32_t s = 512; s < march.field().size() * 512; ++s) {
    const float v = march.value(s);
    if (std::isnan(v)) continue;
    sum += std::abs(static_cast<double>(v) - exact(march.field().index(s)));
    ++count;
  }
  EXPECT_GT(count, 100000);
  return sum / count;
}

TEST(Marching, LastInFirstOutIsBrokenByWideBuckets) {
  const double good = mean_by_order(BucketQueue::Order::first_in_first_out, 1.0);
  const double bad = mean_by_order(BucketQueue::Order::last_in_first_out, 1.0);
  EXPECT_LT(good, 0.05);
  EXPECT_GT(bad, 2 * good);
}

TEST(Masks, KeepHalfAVoxelOfError) {
  const Values exact = ball_values(48);
  const Mask mask = mask_of(exact);
  for (const auto method : {TransformMethod::meijster, TransformMethod::fmm2}) {
    const Errors e = errors(transformed(mask.seeds(), {.method = method}), exact);
    EXPECT_GT(e.max, 0.3) << transform_name(method);
    EXPECT_LT(e.max, 0.9) << transform_name(method);
  }
}

// The ratio to the Euclidean length in the worst directions, found by looking at many.
TEST(Chamfer, RatioIsTheWorstOfAllDirections) {
  for (const auto method :
       {TransformMethod::chamfer345, TransformMethod::chamfer3, TransformMethod::chamfer5}) {
    const TransformOptions options{.method = method, .side = TransformSide::outside};
    const ChamferRatio ratio = chamfer_ratio(chamfer_steps(options));
    Mask v{{{61, 61, 61}}};
    v.mask.assign(v.size(), 0);
    v.mask[0] = 1;
    const std::vector<float> distance = transformed(v.seeds(), options);
    double least = 9;
    double most = 0;
    for (int i = 0; i < 61; ++i) {
      for (int j = 0; j < 61; ++j) {
        for (int k = 0; k < 61; ++k) {
          const double length = std::sqrt(double(i * i + j * j + k * k));
          if (length < 30) continue;
          const double r = static_cast<double>(distance[v.index(i, j, k)]) / length;
          least = std::min(least, r);
          most = std::max(most, r);
        }
      }
    }
    EXPECT_GE(least, ratio.smallest - 1e-6) << transform_name(method);
    EXPECT_LE(most, ratio.largest + 1e-6) << transform_name(method);
    EXPECT_NEAR(least, ratio.smallest, 2e-3) << transform_name(method);
    EXPECT_NEAR(most, ratio.largest, 2e-3) << transform_name(method);
  }
}

TEST(Chamfer, WorstErrorsAreThePublishedOnes) {
  const auto worst = [](TransformMethod method) {
    return chamfer_ratio(chamfer_steps({.method = method}));
  };
  EXPECT_NEAR(worst(TransformMethod::chamfer345).smallest, 1 - 0.057, 1e-3);
  EXPECT_NEAR(worst(TransformMethod::chamfer345).largest, 1.106, 1e-3);
  EXPECT_NEAR(worst(TransformMethod::chamfer3).largest, 1.0602, 1e-3);
  EXPECT_NEAR(worst(TransformMethod::chamfer3).smallest, 1 - 0.0602, 1e-3);
  EXPECT_NEAR(worst(TransformMethod::chamfer5).largest, 1.0241, 1e-3);
  EXPECT_NEAR(worst(TransformMethod::chamfer5).smallest, 1 - 0.0241, 1e-3);
}

// 1 : 1 : 10 from exact distances.
TEST(Spacing, OneToTen) {
  Shape shape{{40, 40, 24}};
  shape.spacing = {1, 1, 10};
  const Values exact = sampled(shape, [](const glm::dvec3& p) { return ball(p, 14); });
  EXPECT_LT(marched(exact, {.method = TransformMethod::fmm2}).max, 10.0);
  EXPECT_LT(marched(exact, {.method = TransformMethod::closest_point}).max, 4.0);
}

// Two plates one and a half voxels apart.
TEST(Gaps, OfOneAndAHalfVoxelsStayOpen) {
  const Values exact = sampled(
      {{24, 12, 12}}, [](const glm::dvec3& p) { return std::abs(std::abs(p.x) - 2) - 1.25; });
  for (const auto method : {TransformMethod::fmm2, TransformMethod::closest_point}) {
    EXPECT_LT(marched(exact, {.method = method}).max, 0.02) << transform_name(method);
  }
}

}  // namespace
}  // namespace sdfgrid
