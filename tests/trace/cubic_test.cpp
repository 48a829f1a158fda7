// The cubic of a cell and its first change of sign against bisection in long double.
//
// Rounding makes a value uncertain by kRounding of its scale. So the answer must lie between where
// the truth first comes within that of zero and where it is that far beyond; there must be one if
// the second place exists, and none if the first does not.
#include "sdfgrid/trace/cubic.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <random>

#include "trace/bisection.h"

namespace sdfgrid {
namespace {

using Real = long double;

constexpr Real kRounding = 1e-14L;
constexpr Real kPlace = 4e-15L;  // of the length: to where the root finder goes on

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()(double lo, double hi) {
    return lo + (hi - lo) * std::uniform_real_distribution<double>()(engine_);
  }
  int below(int n) { return static_cast<int>((*this)(0, n)); }
  glm::dvec3 point() { return {(*this)(0, 1), (*this)(0, 1), (*this)(0, 1)}; }

 private:
  std::mt19937_64 engine_;
};

// A ray's way through a cell: from one place in it to another.
struct Segment {
  glm::dvec3 from, direction;
  double length;
};

Segment random_segment(Random& random) {
  for (;;) {
    glm::dvec3 from = random.point();
    glm::dvec3 to = random.point();
    if (random.below(2) == 0) from[random.below(3)] = random.below(2);
    if (random.below(4) == 0) {  // parallel to an axis or a face
      const int axis = random.below(3);
      to[axis] = from[axis];
    }
    const double length = glm::length(to - from);
    if (length > 1e-6) return {from, (to - from) / length, length};
  }
}

Real trilinear(const double (&v)[8], const Segment& segment, Real s) {
  const Real x = segment.from.x + s * segment.direction.x;
  const Real y = segment.from.y + s * segment.direction.y;
  const Real z = segment.from.z + s * segment.direction.z;
  Real sum = 0;
  for (int n = 0; n < 8; ++n) {
    sum +=
        v[n] * ((n & 4) != 0 ? x : 1 - x) * ((n & 2) != 0 ? y : 1 - y) * ((n & 1) != 0 ? z : 1 - z);
  }
  return sum;
}

// How many answers were hits, so that a test can say that it has seen both kinds.
struct Count {
  int hits = 0;
  int misses = 0;
};

template <class F>
void expect_first_crossing(const Cubic& cubic, const F& truth, double length, double scale,
                           bool inside, Count& count) {
  const auto found = first_crossing(cubic, length, inside);
  const auto side = [&](Real s) { return inside ? -truth(s) : truth(s); };
  const Real doubt = kRounding * scale;
  const auto early = test::first_at_most<Real>(side, 0, length, doubt);
  const auto late = test::first_at_most<Real>(side, 0, length, -doubt);
  ++(found ? count.hits : count.misses);
  if (!found) {
    ASSERT_FALSE(late) << "missed a root at " << double(*late) << " of " << length;
    return;
  }
  ASSERT_TRUE(early) << "invented a root at " << *found;
  ASSERT_GE(*found, *early - kPlace * length);
  ASSERT_LE(*found, (late ? *late : Real(length)) + kPlace * length);
}

double largest(const double (&v)[8]) {
  double result = 0;
  for (const double x : v) result = std::max(result, std::abs(x));
  return result;
}

void expect_voxel(const double (&v)[8], const Segment& segment, bool inside, Count& count) {
  const Cubic cubic = cell_cubic(v, segment.from, segment.direction);
  const auto truth = [&](Real s) { return trilinear(v, segment, s); };
  expect_first_crossing(cubic, truth, segment.length, largest(v), inside, count);
}

TEST(Cubic, FirstCrossingInRandomVoxels) {
  Random random(1);
  Count count;
  for (int i = 0; i < 200000; ++i) {
    const double bias = random(-1, 1);
    double v[8];
    for (double& x : v) x = random(-1, 1) + bias;
    expect_voxel(v, random_segment(random), random.below(2) == 0, count);
    if (HasFatalFailure()) FAIL() << "voxel " << i;
  }
  EXPECT_GT(count.hits, 50000);
  EXPECT_GT(count.misses, 50000);
}

// Voxels lifted until the field's least value on the segment is zero, and a little more or less.
TEST(Cubic, VoxelsGrazedOnPurpose) {
  Random random(2);
  Count count;
  for (int i = 0; i < 60000; ++i) {
    const Segment segment = random_segment(random);
    double v[8];
    for (double& x : v) x = random(-1, 1);
    const auto truth = [&](Real s) { return trilinear(v, segment, s); };
    const Real length = segment.length;
    const Real g[4] = {truth(0), truth(length / 3), truth(2 * length / 3), truth(length)};
    Real turns[2];
    const int turning = test::turning_points(g, turns);
    if (turning == 0) continue;
    const Real lift = truth(turns[random.below(turning)] * length);
    const double touch = std::pow(10.0, -random(2, 17)) * (random.below(3) - 1);
    for (double& x : v) x = static_cast<double>(x - lift) + touch;
    expect_voxel(v, segment, random.below(2) == 0, count);
    if (HasFatalFailure()) FAIL() << "voxel " << i;
  }
  EXPECT_GT(count.hits, 5000);
  EXPECT_GT(count.misses, 1000);
}

TEST(Cubic, DoubleAndTripleRoots) {
  Random random(3);
  Count count;
  for (int i = 0; i < 60000; ++i) {
    const double a = random(-0.2, 1.2);
    const double b = random.below(4) == 0 ? a : random(-0.5, 1.5);
    const double k = random(-2, 2);
    const double touch = std::pow(10.0, -random(3, 17)) * (random.below(3) - 1);
    Cubic cubic{-a * a * b * k + touch, (a * a + 2 * a * b) * k, -(2 * a + b) * k, k};
    if (random.below(5) == 0) cubic = {a * a * k + touch, -2 * a * k, k, 0};
    if (random.below(20) == 0) cubic = {-a * k, k, 0, random.below(2) * 1e-30};
    const auto truth = [&](Real s) {
      return ((cubic.c3 * s + cubic.c2) * s + cubic.c1) * s + cubic.c0;
    };
    const double scale =
        std::abs(cubic.c0) + std::abs(cubic.c1) + std::abs(cubic.c2) + std::abs(cubic.c3);
    expect_first_crossing(cubic, truth, 1, scale, random.below(2) == 0, count);
    if (HasFatalFailure()) FAIL() << "a " << a << " b " << b << " k " << k << " touch " << touch;
  }
  EXPECT_GT(count.hits, 5000);
  EXPECT_GT(count.misses, 5000);
}

TEST(Cubic, ConstantAndWrongSideAtTheStart) {
  EXPECT_FALSE(first_crossing({1, 0, 0, 0}, 1, false));
  EXPECT_FALSE(first_crossing({0, 0, 0, 0}, 1, false));
  EXPECT_FALSE(first_crossing({-1, 0, 0, 0}, 1, true));
  EXPECT_EQ(first_crossing({-1, 2, 0, 0}, 1, false), 0.0);
  EXPECT_EQ(first_crossing({0, 2, 0, 0}, 1, true), 0.0);
  EXPECT_NEAR(first_crossing({-1, 2, 0, 0}, 1, true).value(), 0.5, double(kPlace));
}

}  // namespace
}  // namespace sdfgrid
