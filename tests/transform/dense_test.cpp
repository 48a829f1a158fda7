// Every dense transform against brute force and closed forms, on small volumes.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/transform/transform.h"

namespace sdfgrid {
namespace {

struct Volume {
  glm::ivec3 dims;
  glm::dvec3 spacing{1.0};
  std::vector<std::uint8_t> mask{};

  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(dims.x) * dims.y * dims.z;
  }
  [[nodiscard]] std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * dims.y + j) * dims.z + k;
  }
  [[nodiscard]] DenseSeeds seeds() const { return {dims, spacing, mask}; }
};

Volume noise(const glm::ivec3& dims, double density, unsigned seed) {
  Volume v{dims};
  std::mt19937 random(seed);
  v.mask.resize(v.size());
  for (auto& m : v.mask) m = std::uniform_real_distribution<>(0, 1)(random) < density ? 7 : 0;
  return v;
}

Volume ball(const glm::ivec3& dims, double radius) {
  Volume v{dims};
  v.mask.resize(v.size());
  const glm::dvec3 c = 0.5 * glm::dvec3(dims);
  for (int i = 0; i < dims.x; ++i) {
    for (int j = 0; j < dims.y; ++j) {
      for (int k = 0; k < dims.z; ++k) {
        const double r = std::hypot(i - c.x, j - c.y, k - c.z);
        v.mask[v.index(i, j, k)] = r < radius ? 1 : 0;
      }
    }
  }
  return v;
}

// To the nearest sample on the other side, signed, in double, trying all of them.
std::vector<double> brute_force(const Volume& v) {
  std::vector<double> result(v.size());
  std::size_t s = 0;
  for (int i = 0; i < v.dims.x; ++i) {
    for (int j = 0; j < v.dims.y; ++j) {
      for (int k = 0; k < v.dims.z; ++k, ++s) {
        double best = std::numeric_limits<double>::infinity();
        std::size_t t = 0;
        for (int x = 0; x < v.dims.x; ++x) {
          for (int y = 0; y < v.dims.y; ++y) {
            for (int z = 0; z < v.dims.z; ++z, ++t) {
              if ((v.mask[t] != 0) == (v.mask[s] != 0)) continue;
              const glm::dvec3 d = v.spacing * glm::dvec3(x - i, y - j, z - k);
              best = std::min(best, std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z));
            }
          }
        }
        result[s] = v.mask[s] != 0 ? -best : best;
      }
    }
  }
  return result;
}

double expected(double exact, const Volume& v, const TransformOptions& options) {
  const double unit = std::min({v.spacing.x, v.spacing.y, v.spacing.z});
  double d = std::abs(exact);
  const bool inside = exact < 0;
  if (options.side == TransformSide::outside && inside) return 0;
  if (options.side == TransformSide::inside && !inside) return 0;
  if (options.window > 0 && d > options.window * unit) {
    d = options.window * unit;
  } else if (options.side == TransformSide::both) {
    d -= 0.5 * unit;
  }
  return inside && options.side == TransformSide::both ? -d : d;
}

void expect_exact(const Volume& v) {
  const std::vector<double> exact = brute_force(v);
  for (const auto side : {TransformSide::both, TransformSide::outside, TransformSide::inside}) {
    for (const double window : {0.0, 1.0, 2.5, 4.0, 30.0}) {
      TransformOptions options;
      options.side = side;
      options.window = window;
      std::vector<float> distance(v.size(), 12345.0F);
      distance_transform(v.seeds(), options, distance, Job{});
      for (std::size_t i = 0; i < v.size(); ++i) {
        const double want = expected(exact[i], v, options);
        if (std::isinf(want)) {
          ASSERT_EQ(distance[i], want) << i;
        } else {
          ASSERT_NEAR(distance[i], want, 1e-6 * std::abs(want) + 1e-6)
              << i << " side " << static_cast<int>(side) << " window " << window;
        }
      }
    }
  }
}

const std::vector<glm::ivec3> kShapes = {{1, 1, 1},  {1, 1, 40}, {1, 40, 1},  {40, 1, 1},
                                         {1, 9, 33}, {17, 1, 5}, {12, 13, 1}, {9, 18, 17},
                                         {2, 3, 70}, {35, 6, 4}, {4, 37, 16}};

TEST(Meijster, MatchesBruteForceOnNoise) {
  for (const glm::ivec3& dims : kShapes) {
    for (const double density : {0.002, 0.05, 0.5, 0.97}) expect_exact(noise(dims, density, 3));
  }
}

TEST(Meijster, MatchesBruteForceOnABall) { expect_exact(ball({23, 20, 25}, 8)); }

TEST(Meijster, MatchesBruteForceWithUnequalSpacing) {
  for (const glm::ivec3& dims : kShapes) {
    Volume v = noise(dims, 0.04, 5);
    for (const glm::dvec3& s : {glm::dvec3(1, 1, 10), glm::dvec3(0.7, 0.3, 0.31),
                                glm::dvec3(1e-3, 1e-3, 1e-3), glm::dvec3(20, 1, 3)}) {
      v.spacing = s;
      expect_exact(v);
    }
  }
}

TEST(Meijster, EmptyAndFullVolumesAreInfinitelyFar) {
  expect_exact(noise({5, 6, 7}, 0, 1));
  expect_exact(noise({5, 6, 7}, 1, 1));
}

TEST(Meijster, GivesTheSameBytesAtAnyNumberOfThreads) {
  const Volume v = noise({40, 50, 60}, 0.001, 11);
  std::vector<float> one(v.size());
  std::vector<float> many(v.size());
  {
    const ThreadLimit limit(1);
    distance_transform(v.seeds(), {}, one, Job{});
  }
  const ThreadLimit limit(4);
  distance_transform(v.seeds(), {}, many, Job{});
  EXPECT_EQ(one, many);
}

}  // namespace
}  // namespace sdfgrid
