// What holds for every op: tests over the list, so that an op is tested by being in it.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <span>

#include "field/examples.h"
#include "field/pairs.h"
#include "sdfgrid/field/batch_kernel.h"

namespace {

using sdfgrid::Box;
using sdfgrid::Field;

bool same_bits(std::span<const float> a, std::span<const float> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](float u, float v) {
    return std::bit_cast<std::uint32_t>(u) == std::bit_cast<std::uint32_t>(v);
  });
}

// Those that this machine has, the baseline's left out.
std::vector<const sdfgrid::FieldKernel*> wider_kernels() {
  std::vector<const sdfgrid::FieldKernel*> all;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    all.push_back(&sdfgrid::avx2::kFieldKernel);
  }
  if (__builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) {
    all.push_back(&sdfgrid::avx512::kFieldKernel);
  }
#endif
  return all;
}

// Points where rounding is unusual: on axes, at signed zeros, tiny, huge, and where the float is a
// small whole number or half of one.
void add_odd_points(Points& p, std::mt19937& random) {
  const auto odd = [&]() -> float {
    const auto whole = static_cast<float>(static_cast<int>(random() % 17) - 8);
    switch (random() % 6) {
      case 0:
        return whole;
      case 1:
        return whole / 2;
      case 2:
        return random() % 2 == 0 ? 0.0F : -0.0F;
      case 3:
        return whole * 1e-25F;
      case 4:
        return whole * 1e12F;
      default:
        return std::ldexp(whole, static_cast<int>(random() % 60) - 30);
    }
  };
  for (int i = 0; i < 4000; ++i) {
    p.x.push_back(odd());
    p.y.push_back(odd());
    p.z.push_back(odd());
  }
  p.value.resize(p.x.size());
}

// Pairs near and far: |f(p) - f(q)| <= |p - q|.
TEST(EveryOps, IsOneLipschitz) {
  for (const Example& e : examples()) {
    SCOPED_TRACE(e.text);
    if (e.estimate) continue;
    EXPECT_LE(pair_excess(e.field, example_box(e.field)), kRounding) << e.op->info->name;
  }
}

// A value does not depend on the batch, the lane, or whether it is asked alone.
TEST(EveryOps, GivesTheSameBitsInEveryLane) {
  for (const Example& e : examples()) {
    SCOPED_TRACE(e.text);
    std::mt19937 random(8);
    const Points p = random_points(600, example_box(e.field), random);
    Points batch = p;
    batch.evaluate(e.field);
    for (std::size_t first = 0; first < 40; ++first) {
      const std::size_t n = 600 - first * 3;
      std::vector<float> shifted(n);
      e.field.evaluate(n, p.x.data() + first, p.y.data() + first, p.z.data() + first,
                       shifted.data());
      ASSERT_TRUE(same_bits(shifted, std::span(batch.value).subspan(first, n)))
          << e.op->info->name << " from " << first;
    }
    for (std::size_t i = 0; i < 64; ++i) {
      const float alone = e.field(glm::vec3(p.x[i], p.y[i], p.z[i]));
      ASSERT_TRUE(same_bits({&alone, 1}, {&batch.value[i], 1})) << e.op->info->name;
    }
  }
}

// A stroke file, or a scene that is converted, gives the same bytes on every machine: the kernels
// of all instruction sets that this one has, at points in the example's box and all over the
// floats.
TEST(EveryOps, GivesTheSameBitsOnEveryInstructionSet) {
  const std::vector<const sdfgrid::FieldKernel*> others = wider_kernels();
  for (const Example& e : examples()) {
    SCOPED_TRACE(e.text);
    std::mt19937 random(21);
    Points expected = random_points(20000, example_box(e.field), random);
    add_odd_points(expected, random);
    Points p = expected;
    const auto run = [&](const sdfgrid::FieldKernel& kernel, Points& at) {
      sdfgrid::evaluate(kernel, e.field, at.x.size(), at.x.data(), at.y.data(), at.z.data(),
                        at.value.data());
    };
    run(sdfgrid::baseline::kFieldKernel, expected);
    for (const sdfgrid::FieldKernel* kernel : others) {
      run(*kernel, p);
      for (std::size_t i = 0; i < p.x.size(); ++i) {
        if (std::isnan(expected.value[i]) && std::isnan(p.value[i])) continue;
        ASSERT_TRUE(same_bits({&p.value[i], 1}, {&expected.value[i], 1}))
            << e.op->info->name << " at " << p.x[i] << " " << p.y[i] << " " << p.z[i] << ": "
            << p.value[i] << " and " << expected.value[i];
      }
    }
  }
}

TEST(EveryOps, IntervalHoldsTheSamples) {
  for (const Example& e : examples()) {
    SCOPED_TRACE(e.text);
    std::mt19937 random(9);
    const Box whole = example_box(e.field);
    std::uniform_real_distribution<double> exponent(-3, 0);
    for (int i = 0; i < 300; ++i) {
      const Points ends = random_points(2, whole, random);
      Box box;
      box.add(ends.at(0));
      box.add(ends.at(0) + std::pow(10.0, exponent(random)) * (ends.at(1) - ends.at(0)));
      const sdfgrid::ValueRange range = e.field.range(box);
      const Field pruned = e.field.pruned(box);
      Points p = random_points(64, box, random);
      // Rounded to float they may lie outside by a bit.
      for (std::size_t k = 0; k < p.x.size(); ++k) {
        p.x[k] = std::fmin(std::fmax(p.x[k], static_cast<float>(box.lo.x)),
                           static_cast<float>(box.hi.x));
        p.y[k] = std::fmin(std::fmax(p.y[k], static_cast<float>(box.lo.y)),
                           static_cast<float>(box.hi.y));
        p.z[k] = std::fmin(std::fmax(p.z[k], static_cast<float>(box.lo.z)),
                           static_cast<float>(box.hi.z));
      }
      Points same = p;
      p.evaluate(e.field);
      same.evaluate(pruned);
      ASSERT_TRUE(same_bits(p.value, same.value))
          << e.op->info->name << ": a pruned program gives other bits";
      for (const float v : p.value) {
        ASSERT_GE(v, range.lo - 1e-6) << e.op->info->name;
        ASSERT_LE(v, range.hi + 1e-6) << e.op->info->name;
      }
    }
  }
}

TEST(EveryOps, GradientIsThatOfFiniteDifferences) {
  for (const Example& e : examples()) {
    SCOPED_TRACE(e.text);
    std::mt19937 random(10);
    const Points p = random_points(400, example_box(e.field), random);
    // A Sampler gives floats, and differences over a step of its own: of grids 0.1 voxel, as here.
    const double h = e.sampled ? 8e-3 : 1e-6;
    const double tolerance = e.sampled ? 2e-2 : 2e-3;
    int compared = 0;
    for (std::size_t i = 0; i < p.x.size(); ++i) {
      const sdfgrid::ValueGradient here = e.field.gradient(p.at(i));
      ASSERT_NEAR(here.value, e.field(glm::vec3(p.x[i], p.y[i], p.z[i])), 1e-5) << e.op->info->name;
      for (int a = 0; a < 3; ++a) {
        glm::dvec3 lo = p.at(i);
        glm::dvec3 hi = lo;
        lo[a] -= h;
        hi[a] += h;
        const sdfgrid::ValueGradient below = e.field.gradient(lo);
        const sdfgrid::ValueGradient above = e.field.gradient(hi);
        // A kink between the two: the slopes of both sides differ.
        if (std::fabs(above.gradient[a] - below.gradient[a]) > 0.5 * tolerance) continue;
        ASSERT_NEAR((above.value - below.value) / (2 * h), here.gradient[a], tolerance)
            << e.op->info->name << " axis " << a;
        ++compared;
      }
    }
    EXPECT_GT(compared, e.sampled ? 400 : 900) << e.op->info->name;
  }
}

TEST(EveryOps, BoundsHoldTheInside) {
  for (const Example& e : examples()) {
    SCOPED_TRACE(e.text);
    std::mt19937 random(11);
    Points p = random_points(20000, example_box(e.field), random);
    p.evaluate(e.field);
    for (const double level : {-0.05, 0.0, 0.1}) {
      const Box box = e.field.bounds(level);
      for (std::size_t i = 0; i < p.x.size(); ++i) {
        if (p.value[i] >= level) continue;
        for (int a = 0; a < 3; ++a) {
          ASSERT_GE(p.at(i)[a], box.lo[a] - 1e-5) << e.op->info->name << " level " << level;
          ASSERT_LE(p.at(i)[a], box.hi[a] + 1e-5) << e.op->info->name << " level " << level;
        }
      }
    }
  }
}

// Points that no scene means, but files of points hold: nothing is read out of bounds, no reading
// goes on for ever, and what is finite stays so.
TEST(Ops, TakePointsAtTheEndOfTheWorld) {
  std::vector<Field> fields;
  for (const Example& example : examples()) fields.push_back(example.field);
  std::string samples = "0";
  for (int i = 1; i < 1000; ++i) samples += i % 2 == 0 ? ", 0" : ", 1";
  fields.push_back(
      read_example("texture_displace: {width: 1000, size: [1, 1], amplitude: 0.1, samples: [" +
                   samples + "], of: {box: {size: [2, 2, 2]}}}"));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> ends = {5726.999F, 11074.999F, 1e6F, -1e9F, 1e15F, nan, inf, -inf, 0};
  for (const Field& field : fields) {
    for (const float x : ends) {
      for (const float y : ends) {
        const float value = field(glm::vec3(x, y, 0.5F));
        const bool near = std::fabs(x) < 1e7F && std::fabs(y) < 1e7F;
        EXPECT_TRUE(!near || std::isfinite(value)) << x << ' ' << y;
        if (std::isfinite(x) && std::isfinite(y)) {
          (void)field.range(Box{{x, y, 0}, {x + 1.0, y + 1.0, 1}});
        }
      }
    }
  }
}

}  // namespace
