// Meijster's transform against brute force, on small volumes of awkward shapes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "volumes.h"

namespace sdfgrid {
namespace {

// To the nearest sample on the other side, signed, in double, trying all of them.
std::vector<double> brute_force(const Mask& v) {
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

double expected(double exact, const Mask& v, const TransformOptions& options) {
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

void expect_exact(const Mask& v) {
  const std::vector<double> exact = brute_force(v);
  for (const auto side : {TransformSide::both, TransformSide::outside, TransformSide::inside}) {
    for (const double window : {0.0, 1.0, 2.5, 4.0, 30.0}) {
      TransformOptions options;
      options.side = side;
      options.window = window;
      const std::vector<float> distance = transformed(v.seeds(), options);
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
                                         {2, 3, 70}, {35, 6, 4}, {4, 37, 16}, {3, 3, 130}};

TEST(Meijster, MatchesBruteForceOnNoise) {
  for (const glm::ivec3& dims : kShapes) {
    for (const double density : {0.002, 0.05, 0.5, 0.97}) expect_exact(noise(dims, density, 3));
  }
}

TEST(Meijster, MatchesBruteForceOnABall) { expect_exact(ball_mask({23, 20, 25}, 8)); }

TEST(Meijster, MatchesBruteForceWithUnequalSpacing) {
  for (const glm::ivec3& dims : kShapes) {
    Mask v = noise(dims, 0.04, 5);
    for (const glm::dvec3& s : {glm::dvec3(1, 1, 10), glm::dvec3(0.7, 0.3, 0.31),
                                glm::dvec3(1e-3, 1e-3, 1e-3), glm::dvec3(20, 1, 3)}) {
      v.spacing = s;
      expect_exact(v);
    }
  }
}

// Integer squares stay exact where floats no longer hold them (5000^2 + 1 > 2^24); what is left is
// the rounding of the square and of its root.
TEST(Meijster, IsExactBeyondFourThousandVoxels) {
  for (const glm::ivec3& dims : {glm::ivec3(2, 2, 6000), glm::ivec3(6000, 2, 2)}) {
    Mask v{{dims}};
    v.mask.assign(v.size(), 0);
    v.mask[0] = 1;
    TransformOptions options;
    options.side = TransformSide::outside;
    const std::vector<float> distance = transformed(v.seeds(), options);
    for (int i = 0; i < dims.x; ++i) {
      for (int j = 0; j < dims.y; ++j) {
        for (int k = 0; k < dims.z; ++k) {
          const double want = std::sqrt(double(i) * i + double(j) * j + double(k) * k);
          ASSERT_NEAR(distance[v.index(i, j, k)], want, 1.2e-7 * want);
        }
      }
    }
  }
}

// A medial axis oblique to the columns: neighbouring columns have far-apart nearest rows.
TEST(Meijster, MatchesBruteForceAcrossAnObliqueMedialAxis) {
  Mask v{{{40, 3, 40}}};
  v.mask.assign(v.size(), 0);
  for (int k = 0; k < 40; ++k) v.mask[v.index(k / 2, 1, k)] = v.mask[v.index(39, 0, k)] = 1;
  expect_exact(v);
}

}  // namespace
}  // namespace sdfgrid
