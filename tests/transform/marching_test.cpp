// Fast marching: what it found solves its equation, by a slow solver of the test's own; and the
// same front in rows and in bricks.
#include "sdfgrid/transform/marching.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/vector_relational.hpp>
#include <limits>
#include <type_traits>
#include <utility>

#include "volumes.h"

namespace sdfgrid {
namespace {

struct Term {
  double nearest;
  double value;
  double weight;
};

// The upwind solution from the neighbours that are nearer than `there`, in double.
class Upwind {
 public:
  Upwind(const Values& values, int order) : values_(values), order_(order) {}

  double solve(const glm::ivec3& at) {
    const double there = distance(at);
    std::vector<Term> terms;
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 step(0);
      step[axis] = 1;
      if (distance(at + step) < distance(at - step)) step = -step;
      const double first = distance(at - step);
      if (!(first < there)) continue;
      const double second = distance(at - 2 * step);
      const double weight = 1 / (values_.spacing[axis] * values_.spacing[axis]);
      if (order_ == 2 && second <= first) {
        terms.push_back({first, (4 * first - second) / 3, 2.25 * weight});
      } else {
        terms.push_back({first, first, weight});
      }
    }
    std::sort(terms.begin(), terms.end(),
              [](const Term& a, const Term& b) { return a.nearest < b.nearest; });
    for (std::size_t count = terms.size(); count > 0; --count) {
      const double t = solution(terms, count);
      if (t >= terms[count - 1].nearest) return t;
    }
    return std::nan("");
  }

 private:
  static double solution(const std::vector<Term>& terms, std::size_t count) {
    double a = 0;
    double b = 0;
    double c = -1;
    for (std::size_t i = 0; i < count; ++i) {
      a += terms[i].weight;
      b += terms[i].weight * terms[i].value;
      c += terms[i].weight * terms[i].value * terms[i].value;
    }
    return (b + std::sqrt(b * b - a * c)) / a;
  }
  // Infinite beyond the volume. All of it is on one side.
  [[nodiscard]] double distance(const glm::ivec3& at) const {
    for (int a = 0; a < 3; ++a) {
      if (at[a] < 0 || at[a] >= values_.dims[a]) return std::numeric_limits<double>::infinity();
    }
    return static_cast<double>(values_.values[values_.index(at.x, at.y, at.z)]);
  }

  const Values& values_;
  int order_;
};

// From exact seeds within so many voxels of the surface.
template <class Field>
std::vector<float> march(const MarchOptions& options, const Values& exact, Field field,
                         float seeded = 2) {
  March<Field> march(options, std::move(field));
  march.reserve();
  const auto for_each = [&](const glm::ivec3& from, const glm::ivec3& to, const auto& visit) {
    for (int x = from.x; x < to.x; ++x) {
      for (int y = from.y; y < to.y; ++y) {
        for (int z = from.z; z < to.z; ++z) visit(glm::ivec3(x, y, z));
      }
    }
  };
  const auto sample = [&](const glm::ivec3& at) {
    if constexpr (std::is_same_v<Field, DenseField>) {
      return march.field().sample(at);
    } else {
      const glm::ivec3 b(at.x >> 3, at.y >> 3, at.z >> 3);
      return march.field().find(b) * 512 +
             static_cast<std::uint32_t>((at.x & 7) << 6 | (at.y & 7) << 3 | (at.z & 7));
    }
  };
  if constexpr (std::is_same_v<Field, DenseField>) {
    for_each(glm::ivec3(-2), exact.dims + 2, [&](const glm::ivec3& at) {
      if (glm::any(glm::lessThan(at, glm::ivec3(0))) ||
          glm::any(glm::greaterThanEqual(at, exact.dims))) {
        march.block(sample(at));
      }
    });
  }
  for_each(glm::ivec3(0), exact.dims, [&](const glm::ivec3& at) {
    const float d = exact.values[exact.index(at.x, at.y, at.z)];
    if (std::abs(d) < seeded) march.seed(sample(at), d);
  });
  march.run(Job{});
  std::vector<float> found;
  for_each(glm::ivec3(0), exact.dims,
           [&](const glm::ivec3& at) { found.push_back(march.value(sample(at))); });
  return found;
}

Values around_a_ball(const glm::ivec3& dims, const glm::dvec3& spacing) {
  return sampled({dims, spacing}, [](const glm::dvec3& p) { return std::abs(ball(p, 5)); });
}

TEST(Marching, SolvesItsEquation) {
  for (const int order : {1, 2}) {
    for (const glm::dvec3& spacing : {glm::dvec3(1), glm::dvec3(1, 1.7, 2.5)}) {
      // Within a bucket a sample solved again may see a neighbour before that one was: what is
      // upwind by a part of the bucket's width w changes a distance by its square.
      for (const double width : {0.0, 1.0 / 16}) {
        const Values exact = around_a_ball({40, 31, 37}, spacing);
        const double tolerance = 2e-5 + 0.25 * width * width;
        Values found = exact;
        found.values = march({.order = order, .spacing = spacing, .bucket_width = width}, exact,
                             DenseField(exact.dims));
        Upwind upwind(found, order);
        int solved = 0;
        for (int x = 0; x < exact.dims.x; ++x) {
          for (int y = 0; y < exact.dims.y; ++y) {
            for (int z = 0; z < exact.dims.z; ++z) {
              const std::size_t i = exact.index(x, y, z);
              if (std::abs(exact.values[i]) < 2) continue;
              ++solved;
              ASSERT_NEAR(upwind.solve({x, y, z}), static_cast<double>(found.values[i]), tolerance)
                  << x << " " << y << " " << z << " order " << order << " width " << width;
            }
          }
        }
        EXPECT_GT(solved, 20000);
      }
    }
  }
}

TEST(Marching, GivesTheSameBitsInRowsAndInBricks) {
  const Values exact = around_a_ball({32, 24, 40}, glm::dvec3(1));
  BrickField bricks;
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 3; ++y) {
      for (int z = 0; z < 5; ++z) bricks.make({x, y, z});
    }
  }
  for (const double width : {0.0, 1.0 / 16, 1.0}) {
    const MarchOptions options{.bucket_width = width};
    EXPECT_EQ(march(options, exact, DenseField(exact.dims)), march(options, exact, bricks));
  }
}

// Mean error of second order at a ball of 0.3 of the volume, voxels.
double error_at(int n, float seeded) {
  const Values exact =
      sampled({glm::ivec3(n)}, [&](const glm::dvec3& p) { return ball(p, 0.3 * n); });
  // Buckets are made for seeds of two voxels.
  return errors(march({.bucket_width = 0}, exact, DenseField(exact.dims), seeded), exact).mean;
}

// The scheme has order two; seeds of two voxels, a smaller share of the way on finer grids, let
// coarse grids look better than they are.
TEST(MarchingOrder, IsTwoFromSeedsOfOneWidth) {
  const auto order = [](double coarse, double fine) { return 1 + std::log2(coarse / fine); };
  const double coarse = error_at(64, 2);
  const double as_wide_in_voxels = order(coarse, error_at(128, 2));
  const double as_wide_in_the_world = order(coarse, error_at(128, 4));
  std::printf("order from 64 to 128: %.2f, from seeds of one width in the world %.2f\n",
              as_wide_in_voxels, as_wide_in_the_world);
  EXPECT_GT(as_wide_in_voxels, 1.75);
  EXPECT_GT(as_wide_in_the_world, 1.95);
}

}  // namespace
}  // namespace sdfgrid
