// Where the methods fail, by how much, and where they do not. Prints what it
// measures: the figures of docs/stability.md.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

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

// Mean errors in voxels of volumes of `coarse` and `fine` samples a side; the
// order is of the error in world units.
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

void print(const char* what, std::string_view method, const Errors& e) {
  std::printf("%s, %s: mean %.4f, largest %.4f\n", what, std::string(method).c_str(), e.mean,
              e.max);
}

TEST(Marching, BoxEdges) {
  const Values exact = sampled({glm::ivec3(48)}, [](const glm::dvec3& p) { return box(p, 11.7); });
  const Errors second = marched(exact, {.method = TransformMethod::fmm2});
  const Errors points = marched(exact, {.method = TransformMethod::closest_point});
  print("box", "fmm2", second);
  print("box", "cpm", points);
  EXPECT_GT(second.max, 0.2) << "second order at the corners of a box";
  EXPECT_LT(second.max, 0.35);
  EXPECT_LT(points.max, 0.06);
}

TEST(Marching, BucketsUpToAQuarterChangeNothing) {
  const Values exact = ball_values(48);
  const auto with = [&](double width) {
    const Errors e = marched(exact, {.method = TransformMethod::fmm2, .bucket_width = width});
    std::printf("bucket %g: mean %.5f, largest %.4f\n", width, e.mean, e.max);
    return e.mean;
  };
  const double heap = with(0);
  for (const double width : {1.0 / 64, 1.0 / 16, 0.25}) {
    EXPECT_NEAR(with(width), heap, 0.01 * heap) << width;
  }
  for (const double width : {1.0, 2.0}) {
    const double wide = with(width);
    EXPECT_GT(wide, 1.1 * heap) << width;
    EXPECT_LT(wide, 1.3 * heap) << width;
  }
}

// The same front by hand, for the order in a bucket, which options do not
// offer.
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
  for (const double width : {1.0 / 64, 1.0 / 16, 0.25, 1.0, 2.0}) {
    const double good = mean_by_order(BucketQueue::Order::first_in_first_out, width);
    const double bad = mean_by_order(BucketQueue::Order::last_in_first_out, width);
    std::printf("bucket %g: first in, first out %.5f; last in, first out %.5f\n", width, good, bad);
    EXPECT_LT(good, 0.02);
    if (width < 0.1) {
      EXPECT_LT(bad, 0.01) << width;
    } else {
      EXPECT_GT(bad, width < 1 ? 1.5 * good : 20 * good) << width;
    }
  }
}

TEST(Masks, KeepHalfAVoxelOfError) {
  const Values exact = ball_values(48);
  const Mask mask = mask_of(exact);
  for (const auto method : {TransformMethod::meijster, TransformMethod::fmm2}) {
    const Errors e = errors(transformed(mask.seeds(), {.method = method}), exact);
    print("mask of a ball", transform_name(method), e);
    EXPECT_GT(e.max, 0.3) << transform_name(method);
    EXPECT_LT(e.max, 0.9) << transform_name(method);
  }
}

// The ratio to the Euclidean length in the worst directions, found by looking
// at many.
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
    glm::ivec3 under(0);
    glm::ivec3 over(0);
    for (int i = 0; i < 61; ++i) {
      for (int j = 0; j < 61; ++j) {
        for (int k = 0; k < 61; ++k) {
          const double length = std::sqrt(double(i * i + j * j + k * k));
          if (length < 30) continue;
          const double r = static_cast<double>(distance[v.index(i, j, k)]) / length;
          if (r < least) under = {i, j, k};
          if (r > most) over = {i, j, k};
          least = std::min(least, r);
          most = std::max(most, r);
        }
      }
    }
    std::printf("%s: %+.2f %% towards %d %d %d, %+.2f %% towards %d %d %d\n",
                std::string(transform_name(method)).c_str(), 100 * (least - 1), under.x, under.y,
                under.z, 100 * (most - 1), over.x, over.y, over.z);
    EXPECT_GE(least, ratio.smallest - 1e-6) << transform_name(method);
    EXPECT_LE(most, ratio.largest + 1e-6) << transform_name(method);
    EXPECT_NEAR(least, ratio.smallest, 2e-3) << transform_name(method);
    if (method == TransformMethod::chamfer345) {
      EXPECT_TRUE(under.x == 0 && under.y == under.z) << "towards the diagonals of faces";
      EXPECT_TRUE(over.x == over.y && over.z == 3 * over.x) << "between axis and corner";
    }
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

// 1 : 1 : 10 from exact distances, and from the mask.
TEST(Spacing, OneToTen) {
  Shape shape{{40, 40, 24}};
  shape.spacing = {1, 1, 10};
  const Values exact = sampled(shape, [](const glm::dvec3& p) { return ball(p, 14); });
  const Errors second = marched(exact, {.method = TransformMethod::fmm2});
  const Errors points = marched(exact, {.method = TransformMethod::closest_point});
  const Errors mask = errors(transformed(mask_of(exact).seeds(), {}), exact);
  print("1:1:10", "fmm2", second);
  print("1:1:10", "cpm", points);
  print("1:1:10", "meijster from the mask", mask);
  EXPECT_LT(second.max, 1.5);
  EXPECT_LT(points.max, 1.4);
  EXPECT_LT(mask.max, 6.0) << "half a step of the long spacing";
}

// Two plates one and a half voxels apart.
TEST(Gaps, OfOneAndAHalfVoxelsStayOpen) {
  const Values exact = sampled(
      {{24, 12, 12}}, [](const glm::dvec3& p) { return std::abs(std::abs(p.x) - 2) - 1.25; });
  for (const auto method : {TransformMethod::fmm2, TransformMethod::closest_point}) {
    const Errors e = marched(exact, {.method = method});
    print("gap", transform_name(method), e);
    EXPECT_LT(e.max, 1e-4) << transform_name(method);
  }
}

// Six thousand voxels from the only surface: where a float's last digit is
// 0.0005 voxel.
TEST(Far, BeyondFourThousandVoxelsEveryMethodKeepsItsRatio) {
  for (const TransformMethodInfo& info : transform_methods()) {
    if (!info.volumes) continue;
    TransformOptions options{.method = info.method, .side = TransformSide::outside};
    options.steps = {{{1, 0, 0}, 1.0}};
    Mask v{{{1, 2, 6000}}};
    v.mask.assign(v.size(), 0);
    v.mask[0] = v.mask[6000] = 1;
    const std::vector<float> distance = transformed(v.seeds(), options);
    const double ratio = info.method == TransformMethod::chamfer3   ? 0.9398
                         : info.method == TransformMethod::chamfer5 ? 0.9759
                                                                    : 1.0;
    double largest = 0;
    for (int k = 1; k < 6000; ++k) {
      const double got = static_cast<double>(distance[v.index(0, 1, k)]);
      // Marching starts from where the mask's surface is, half a voxel nearer.
      const double half = std::abs(got / k - ratio) * k > 0.4 ? 0.5 : 0.0;
      largest = std::max(largest, std::abs(got + half - ratio * k) / k);
    }
    std::printf("6000 voxels, %s: relative error %.2g\n", std::string(info.name).c_str(), largest);
    EXPECT_LT(largest, 2e-7) << info.name;
  }
}

}  // namespace
}  // namespace sdfgrid
