// The vector kernels of edits against slow references, on every instruction set of this machine.
#include "sdfgrid/edit/combine_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <random>
#include <vector>

#include "sdfgrid/core/isa.h"
#include "sdfgrid/edit/nearest_kernel.h"

namespace sdfgrid {
namespace {

template <class Kernel>
struct Named {
  const char* name;
  const Kernel* kernel;
};

std::vector<Named<CombineKernel>> combine_kernels() {
  std::vector<Named<CombineKernel>> all = {{"baseline", &baseline::kCombineKernel}};
#if defined(__x86_64__)
  if (active_isa() >= Isa::avx2) all.push_back({"avx2", &avx2::kCombineKernel});
  if (active_isa() >= Isa::avx512) all.push_back({"avx512", &avx512::kCombineKernel});
#endif
  return all;
}

std::vector<Named<NearestKernel>> nearest_kernels() {
  std::vector<Named<NearestKernel>> all = {{"baseline", &baseline::kNearestKernel}};
#if defined(__x86_64__)
  if (active_isa() >= Isa::avx2) all.push_back({"avx2", &avx2::kNearestKernel});
  if (active_isa() >= Isa::avx512) all.push_back({"avx512", &avx512::kNearestKernel});
#endif
  return all;
}

glm::dvec3 sample(int i) { return {i >> 6, i >> 3 & 7, i & 7}; }

struct Hull {
  glm::dvec3 a, b;
  double ra, rb;

  // The least over the balls of the sweep, by golden sections: the function is convex in t.
  [[nodiscard]] double distance(const glm::dvec3& p) const {
    const auto to_ball = [&](double t) {
      return glm::length(p - glm::mix(a, b, t)) - glm::mix(ra, rb, t);
    };
    double lo = 0;
    double hi = 1;
    for (int i = 0; i < 80; ++i) {
      const double left = lo + 0.381966 * (hi - lo);
      const double right = hi - 0.381966 * (hi - lo);
      (to_ball(left) < to_ball(right) ? hi : lo) = to_ball(left) < to_ball(right) ? right : left;
    }
    return std::min({to_ball(lo), to_ball(0), to_ball(1)});
  }

  [[nodiscard]] RoundSegment segment() const {
    RoundSegment s{};
    const glm::dvec3 axis = b - a;
    const double length = glm::length(axis);
    for (int i = 0; i < 3; ++i) s.a[i] = static_cast<float>(a[i]);
    s.radius = static_cast<float>(ra);
    if (length == 0) return s;
    const double sine = (ra - rb) / length;
    for (int i = 0; i < 3; ++i) s.axis[i] = static_cast<float>(axis[i]);
    s.over_length2 = static_cast<float>(1 / (length * length));
    s.across = static_cast<float>(sine / (length * std::sqrt(1 - sine * sine)));
    s.growth = static_cast<float>(rb - ra);
    return s;
  }
};

std::vector<Hull> random_hulls(int count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-15, 22);
  std::uniform_real_distribution<double> radius(0.5, 9);
  std::vector<Hull> hulls;
  while (static_cast<int>(hulls.size()) < count) {
    Hull h{{place(random), place(random), place(random)},
           {place(random), place(random), place(random)},
           radius(random),
           radius(random)};
    if (hulls.size() % 3 == 0) {
      h.b = h.a;
      h.rb = h.ra;
    }
    if (hulls.size() % 3 == 1) h.rb = h.ra;
    if (h.a != h.b && glm::length(h.a - h.b) <= 1.05 * std::abs(h.ra - h.rb)) continue;
    hulls.push_back(h);
  }
  return hulls;
}

TEST(CombineKernel, SweptBallsAreExactDistances) {
  const std::vector<Hull> hulls = random_hulls(60);
  for (const auto& [name, kernel] : combine_kernels()) {
    for (std::size_t first = 0; first < hulls.size(); first += 3) {
      const std::size_t count = 1 + first % 3;
      RoundSegment segments[3];
      for (std::size_t i = 0; i < count; ++i) segments[i] = hulls[first + i].segment();
      float distances[512];
      kernel->sweep(segments, static_cast<std::int32_t>(count), distances);
      for (int i = 0; i < 512; i += 7) {
        double expected = 1e300;
        for (std::size_t h = 0; h < count; ++h) {
          expected = std::min(expected, hulls[first + h].distance(sample(i)));
        }
        ASSERT_NEAR(distances[i], expected, 2e-5) << name << " hull " << first << " sample " << i;
      }
    }
  }
}

TEST(CombineKernel, AllInstructionSetsGiveTheSameBits) {
  const std::vector<Hull> hulls = random_hulls(60);
  std::vector<RoundSegment> segments;
  for (const Hull& h : hulls) segments.push_back(h.segment());
  std::vector<float> expected(512);
  std::vector<float> distances(512);
  for (const auto& [name, kernel] : combine_kernels()) {
    for (std::size_t i = 0; i + 2 < segments.size(); ++i) {
      baseline::kCombineKernel.sweep(&segments[i], 2, expected.data());
      kernel->sweep(&segments[i], 2, distances.data());
      ASSERT_EQ(0, std::memcmp(distances.data(), expected.data(), 512 * sizeof(float))) << name;
    }
  }
}

struct Combination {
  float after[512];
  CombineOutput made;
};

// As combine_kernel.h says, one sample at a time.
void expect_combination(const CombineInput& in, const Combination& got, const char* name) {
  bool any_changed = false;
  int inside = 0;
  int outside = 0;
  for (int i = 0; i < 512; ++i) {
    const float before = in.before != nullptr ? in.before[i] : in.constant;
    const float a = in.extended != nullptr ? in.extended[i] : before;
    const float brush = in.brush[i] * in.voxel;
    const float b = in.op == CombineOp::subtract ? -brush : brush;
    const float h = in.smooth > 0 ? std::max(in.smooth - std::abs(a - b), 0.0F) / in.smooth : 0.0F;
    const float blend = h * h * 0.25F * in.smooth;
    const bool unite = in.op == CombineOp::unite;
    const float value = unite ? std::min(a, b) - blend : std::max(a, b) + blend;
    const float after = std::clamp(value, in.inside, in.outside);
    ASSERT_NEAR(got.after[i], after, 1e-6F) << name << " sample " << i;
    const auto bit = [&](const std::uint64_t* words) {
      return (words[i >> 6] >> (i & 63) & 1) != 0;
    };
    const bool active = got.after[i] > in.inside && got.after[i] < in.outside;
    ASSERT_EQ(bit(got.made.active), active) << name << " sample " << i;
    ASSERT_EQ(bit(got.made.changed), got.after[i] != before) << name << " sample " << i;
    const float thin = 1.7320508F * in.voxel;
    const float sharp = unite ? std::min(a, b) : std::max(a, b);
    const bool doubtful = (unite ? a + b < thin && sharp < 0 : a + b > -thin && sharp > 0) ||
                          (in.bound_inside && brush < 0);
    ASSERT_EQ(bit(got.made.suspect), doubtful && active) << name << " sample " << i;
    any_changed = any_changed || got.after[i] != before;
    inside += got.after[i] <= in.inside ? 1 : 0;
    outside += got.after[i] >= in.outside ? 1 : 0;
  }
  EXPECT_EQ(got.made.any_changed, any_changed) << name;
  EXPECT_EQ(got.made.all_inside, inside == 512) << name;
  EXPECT_EQ(got.made.all_outside, outside == 512) << name;
}

TEST(CombineKernel, CombinesAsItSays) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> value(-0.4F, 0.4F);
  for (int trial = 0; trial < 60; ++trial) {
    float before[512];
    float brush[512];
    const float shift = trial % 5 == 0 ? -9.0F : 0.0F;  // wholly within the brush
    for (int i = 0; i < 512; ++i) {
      before[i] = std::clamp(value(random), -0.3F, 0.3F);
      brush[i] = 10 * value(random) + shift;
    }
    CombineInput in{};
    in.op = static_cast<CombineOp>(trial % 3);
    in.brush = brush;
    in.before = trial % 4 == 3 ? nullptr : before;
    in.constant = 0.3F;
    in.voxel = 0.1F;
    in.smooth = trial % 2 == 0 ? 0.0F : 0.2F;
    in.inside = -0.3F;
    in.outside = 0.3F;
    in.bound_inside = trial % 7 == 0;
    for (const auto& [name, kernel] : combine_kernels()) {
      Combination got;
      got.made.after = got.after;
      kernel->combine(in, got.made);
      expect_combination(in, got, name);
    }
  }
}

TEST(NearestKernel, FindsTheFirstNearest) {
  std::mt19937 random(9);
  std::uniform_int_distribution<int> place(-4, 4);  // whole numbers: many are equally near
  std::vector<float> x(96);
  std::vector<float> y(96);
  std::vector<float> z(96);
  for (int trial = 0; trial < 300; ++trial) {
    for (int i = 0; i < 96; ++i) {
      x[i] = static_cast<float>(place(random));
      y[i] = static_cast<float>(place(random));
      z[i] = static_cast<float>(place(random));
    }
    const float p[3] = {static_cast<float>(place(random)), 0.5F, static_cast<float>(place(random))};
    const std::int32_t count = 16 * (1 + trial % 6);
    std::int32_t expected = 0;
    float least = 1e30F;
    for (std::int32_t i = 0; i < count; ++i) {
      const float dx = x[i] - p[0];
      const float dy = y[i] - p[1];
      const float dz = z[i] - p[2];
      const float squared = dx * dx + dy * dy + dz * dz;
      if (squared >= least) continue;
      least = squared;
      expected = i;
    }
    for (const auto& [name, kernel] : nearest_kernels()) {
      NearPoints got;
      kernel->nearest({x.data(), y.data(), z.data(), count}, p, got);
      ASSERT_EQ(got.index[0], expected) << name;
      ASSERT_EQ(got.squared[0], least) << name;
      for (int i = 1; i < NearPoints::kMost; ++i) {
        ASSERT_GE(got.squared[i], got.squared[i - 1]) << name;
        ASSERT_NE(got.index[i] % 16, got.index[i - 1] % 16) << name;
      }
    }
  }
}

// The field of a ball of radius 9, in a block with an apron of 4, seen from around it.
struct BallBlock {
  static constexpr int kEdge = 16;
  static constexpr int kApron = 4;
  static constexpr float kRadius = 9;
  glm::vec3 middle{-3.2F, -1.7F, 1.4F};
  std::vector<float> values = std::vector<float>(kEdge * kEdge * kEdge + 15);
  std::vector<float> x, y, z;  // samples

  BallBlock() {
    for (int i = 0; i < kEdge * kEdge * kEdge; ++i) {
      const glm::vec3 p(glm::ivec3(i / (kEdge * kEdge), i / kEdge % kEdge, i % kEdge) - kApron);
      values[i] = glm::length(p - middle) - kRadius;
    }
    for (int i = 0; i < 512; ++i) {
      x.push_back(static_cast<float>(sample(i).x));
      y.push_back(static_cast<float>(sample(i).y));
      z.push_back(static_cast<float>(sample(i).z));
    }
  }
  [[nodiscard]] BlockSamples samples() const { return {values.data(), kEdge, kApron}; }
  [[nodiscard]] Positions positions() const { return {x.data(), y.data(), z.data(), 512}; }
  [[nodiscard]] float distance(int i) const {
    return glm::length(glm::vec3(x[i], y[i], z[i]) - middle) - kRadius;
  }
};

TEST(NearestKernel, SignsAreThoseOfTheRows) {
  const BallBlock ball;
  for (const auto& [name, kernel] : nearest_kernels()) {
    std::vector<std::uint64_t> rows(BallBlock::kEdge * BallBlock::kEdge);
    kernel->signs(ball.samples(), rows.data());
    for (std::size_t row = 0; row < rows.size(); ++row) {
      for (int z = 0; z < 64; ++z) {
        const bool negative =
            z < BallBlock::kEdge && ball.values[row * BallBlock::kEdge + std::size_t(z)] < 0;
        ASSERT_EQ((rows[row] >> z & 1) != 0, negative) << name;
      }
    }
  }
}

TEST(NearestKernel, AgreesWithDistancesAndNotWithBounds) {
  for (const float factor : {1.0F, 0.8F}) {
    BallBlock ball;
    // Where 0.03 voxel does not tell them apart, or the surface is outside the block.
    const auto counts = [&](int i) {
      return std::abs(ball.distance(i)) > 0.5F && std::abs(ball.distance(i)) < 3;
    };
    std::vector<float> bounds = ball.values;
    for (float& v : bounds) v = std::abs(v) > 0.4F ? v * factor : v;
    const BlockSamples samples = {bounds.data(), BallBlock::kEdge, BallBlock::kApron};
    std::vector<std::uint16_t> first;
    for (const auto& [name, kernel] : nearest_kernels()) {
      std::vector<std::uint16_t> bits(32);
      kernel->agree(samples, ball.positions(), 0.03F, bits.data());
      for (int i = 0; i < 512; ++i) {
        if (!counts(i)) continue;
        ASSERT_EQ((bits[i / 16] >> i % 16 & 1) != 0, factor == 1) << name << " " << i;
      }
      if (first.empty()) first = bits;
      EXPECT_EQ(bits, first) << name;
    }
  }
}

TEST(NearestKernel, ImprovesToTheSurfaceWithTheSameBits) {
  const BallBlock ball;
  // From points of the ball turned a little away from the nearest one.
  std::vector<float> to[3];
  for (int i = 0; i < 512; ++i) {
    const glm::vec3 out = glm::normalize(glm::vec3(ball.x[i], ball.y[i], ball.z[i]) - ball.middle);
    const glm::vec3 turned = glm::normalize(out + glm::vec3(0.04F, -0.03F, 0.05F));
    for (int a = 0; a < 3; ++a) {
      to[a].push_back(ball.middle[a] + BallBlock::kRadius * turned[a]);
    }
  }
  std::vector<float> first;
  for (const auto& [name, kernel] : nearest_kernels()) {
    std::vector<float> found(512);
    kernel->improve(ball.samples(), ball.positions(),
                    {to[0].data(), to[1].data(), to[2].data(), 512}, found.data());
    for (int i = 0; i < 512; ++i) {
      if (std::abs(ball.distance(i)) > 3) continue;
      ASSERT_NEAR(found[i], std::abs(ball.distance(i)), 1 / (4 * BallBlock::kRadius)) << name;
    }
    if (first.empty()) first = found;
    EXPECT_EQ(std::memcmp(found.data(), first.data(), sizeof(float) * 512), 0) << name;
  }
}

}  // namespace
}  // namespace sdfgrid
