// The anti-aliased transform against closed forms, from exact coverages. Prints what it measures:
// the figures of docs/stability.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <tuple>
#include <utility>

#include "sdfgrid/core/error.h"
#include "sdfgrid/transform/coverage_surface.h"
#include "sdfgrid/transform/dense_feature.h"
#include "volumes.h"

namespace sdfgrid {
namespace {

// How much of the voxel around each sample is inside, from the lengths inside of lines along z, 24
// squared a voxel: `below(x, y)` is the interval of z inside over a place of the plane.
template <class Inside>
Values coverage(const Shape& shape, const Inside& inside) {
  constexpr int kLines = 24;
  Values v{shape};
  const glm::dvec3 middle = 0.5 * glm::dvec3(shape.dims - 1) * shape.spacing;
  const glm::dvec3 off = shape.spacing * glm::dvec3(0.13, 0.29, -0.31);  // as sampled()
  v.values.resize(v.size());
  for (int i = 0; i < shape.dims.x; ++i) {
    for (int j = 0; j < shape.dims.y; ++j) {
      std::vector<double> sums(static_cast<std::size_t>(shape.dims.z));
      for (int line = 0; line < kLines * kLines; ++line) {
        const glm::ivec2 at(line / kLines, line % kLines);
        const glm::dvec3 in((glm::dvec2(at) + 0.5) / double(kLines) - 0.5, 0);
        const glm::dvec3 p = (glm::dvec3(i, j, 0) + in) * shape.spacing - middle + off;
        const auto [lo, hi] = inside(p.x, p.y);
        for (int k = 0; k < shape.dims.z; ++k) {
          const double z = k * shape.spacing.z - middle.z + off.z;
          const double from = std::max(lo, z - 0.5 * shape.spacing.z);
          const double to = std::min(hi, z + 0.5 * shape.spacing.z);
          sums[static_cast<std::size_t>(k)] += std::max(to - from, 0.0) / shape.spacing.z;
        }
      }
      for (int k = 0; k < shape.dims.z; ++k) {
        v.values[v.index(i, j, k)] =
            static_cast<float>(sums[static_cast<std::size_t>(k)] / (kLines * kLines));
      }
    }
  }
  return v;
}

Values ball_coverage(const Shape& shape, double radius) {
  return coverage(shape, [radius](double x, double y) {
    const double square = radius * radius - x * x - y * y;
    const double half = square > 0 ? std::sqrt(square) : 0.0;
    return std::pair(-half, half);
  });
}

const glm::dvec3 kTilt = glm::normalize(glm::dvec3(0.48, -0.31, 0.82));

Values plane_coverage(const Shape& shape) {
  return coverage(shape, [](double x, double y) {
    return std::pair(-1e9, -(kTilt.x * x + kTilt.y * y) / kTilt.z);
  });
}

struct Measured {
  Errors antialiased, binary;
};

Measured measured(const Values& covered, const Values& exact) {
  Mask mask{{exact.dims, exact.spacing}};
  for (const float c : covered.values) mask.mask.push_back(c > 0.5F ? 1 : 0);
  return {errors(transformed(covered.seeds(SeedKind::coverage),
                             {.method = TransformMethod::antialiased}),
                 exact),
          errors(transformed(mask.seeds(), {.method = TransformMethod::meijster}), exact)};
}

TEST(Antialiased, APlaneIsExact) {
  const Shape shape{{40, 36, 44}};
  const Values exact = sampled(shape, [](const glm::dvec3& p) { return glm::dot(p, kTilt); });
  const Values covered = plane_coverage(shape);
  const std::vector<float> got =
      transformed(covered.seeds(SeedKind::coverage), {.method = TransformMethod::antialiased});
  double largest = 0;
  // The volume's border cuts the plane: what lies nearest to beyond it is a distance to the rim.
  for (int i = 14; i < 26; ++i) {
    for (int j = 12; j < 24; ++j) {
      for (int k = 12; k < 32; ++k) {
        const std::size_t n = exact.index(i, j, k);
        largest = std::max(
            largest, std::abs(static_cast<double>(got[n]) - static_cast<double>(exact.values[n])));
      }
    }
  }
  std::printf("plane: largest %.6f\n", largest);
  EXPECT_LT(largest, 1e-5);
}

TEST(Antialiased, ABallIsNearlyExact) {
  const Shape shape{glm::ivec3(64)};
  // Mean and largest, voxels; half a voxel of error in the mask is three tenths in the mean.
  for (const auto& [radius, mean, largest] :
       {std::tuple(8.0, 0.01, 0.15), std::tuple(20.0, 0.001, 0.03)}) {
    const Values exact = sampled(shape, [r = radius](const glm::dvec3& p) { return ball(p, r); });
    const Measured m = measured(ball_coverage(shape, radius), exact);
    std::printf("ball %g: mean %.5f, largest %.4f; mask: mean %.3f, largest %.3f\n", radius,
                m.antialiased.mean, m.antialiased.max, m.binary.mean, m.binary.max);
    EXPECT_LT(m.antialiased.mean, mean);
    EXPECT_LT(m.antialiased.max, largest);
    EXPECT_LT(30 * m.antialiased.mean, m.binary.mean);
  }
}

// A convex body: its distance, and where the line through (x, y, 0) along z is inside of it.
struct Body {
  std::function<double(const glm::dvec3& p)> distance;
  std::function<std::pair<double, double>(double x, double y)> line;
};

using Interval = std::pair<double, double>;
Interval both(const Interval& a, const Interval& b) {
  return {std::max(a.first, b.first), std::min(a.second, b.second)};
}
// Where |p + t d| <= half.
Interval slab(double p, double d, double half) {
  if (std::abs(d) < 1e-12) return std::abs(p) <= half ? Interval(-1e9, 1e9) : Interval(1, -1);
  const double a = (-half - p) / d;
  const double b = (half - p) / d;
  return {std::min(a, b), std::max(a, b)};
}
Interval pipe(const glm::dvec3& p, const glm::dvec3& d, double radius) {
  const double a = d.x * d.x + d.y * d.y;
  const double b = p.x * d.x + p.y * d.y;
  const double c = p.x * p.x + p.y * p.y - radius * radius;
  if (a < 1e-12) return c <= 0 ? Interval(-1e9, 1e9) : Interval(1, -1);
  const double root = b * b - a * c;
  if (root < 0) return {1, -1};
  return {(-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a};
}

// Turned by so many degrees about (1, 2, 3).
glm::dmat3 turned_by(double degrees) {
  return glm::dmat3(
      glm::rotate(glm::dmat4(1), glm::radians(degrees), glm::normalize(glm::dvec3(1, 2, 3))));
}

Body box_body(const glm::dvec3& half, double degrees) {
  const glm::dmat3 turn = turned_by(degrees);
  return {[=](const glm::dvec3& p) {
            const glm::dvec3 q = glm::abs(turn * p) - half;
            return glm::length(glm::max(q, 0.0)) + std::min(0.0, std::max({q.x, q.y, q.z}));
          },
          [=](double x, double y) {
            const glm::dvec3 p = turn * glm::dvec3(x, y, 0);
            const glm::dvec3 d = turn[2];
            return both(slab(p.x, d.x, half.x),
                        both(slab(p.y, d.y, half.y), slab(p.z, d.z, half.z)));
          }};
}

Body cylinder_body(double radius, double half, double degrees) {
  const glm::dmat3 turn = turned_by(degrees);
  return {[=](const glm::dvec3& p) {
            const glm::dvec3 at = turn * p;
            const glm::dvec2 q(std::hypot(at.x, at.y) - radius, std::abs(at.z) - half);
            return glm::length(glm::max(q, 0.0)) + std::min(0.0, std::max(q.x, q.y));
          },
          [=](double x, double y) {
            const glm::dvec3 p = turn * glm::dvec3(x, y, 0);
            return both(pipe(p, turn[2], radius), slab(p.z, turn[2].z, half));
          }};
}

// Solids and, with the same coverage turned round, hollows in a full volume.
TEST(Antialiased, KeepsEdgesAndCorners) {
  const Shape shape{glm::ivec3(44)};
  const glm::dvec3 half(11.7, 12.2, 10.4);
  const struct {
    const char* name;
    Body body;
    double mean, largest;  // voxels; without corners 0.047 to 0.081 and 0.45 to 0.96
  } bodies[] = {
      {"box, turned by 20 degrees", box_body(half, 20), 0.001, 0.25},
      {"box, turned by 70 degrees", box_body(half, 70), 0.001, 0.15},
      {"cylinder", cylinder_body(13, 10.4, 0), 0.005, 0.2},
      {"cylinder, turned by 40 degrees", cylinder_body(13, 10.4, 40), 0.01, 0.25},
  };
  for (const auto& [name, body, mean, largest] : bodies) {
    Values exact = sampled(shape, body.distance);
    Values covered = coverage(shape, body.line);
    for (const char* form : {"solid", "hollow"}) {
      const Measured m = measured(covered, exact);
      std::printf("%s, %s: mean %.5f, largest %.4f; mask: mean %.3f, largest %.3f\n", name, form,
                  m.antialiased.mean, m.antialiased.max, m.binary.mean, m.binary.max);
      EXPECT_LT(m.antialiased.mean, mean) << name << ", " << form;
      EXPECT_LT(m.antialiased.max, largest) << name << ", " << form;
      for (float& c : covered.values) c = 1 - c;
      for (float& d : exact.values) d = -d;
    }
  }
}

// Errors in voxels of the finer steps; without corners 0.09 and 1.09.
TEST(Antialiased, KeepsEdgesWithUnequalSpacing) {
  Shape shape{{44, 44, 30}};
  shape.spacing = {1, 1, 1.5};
  const Body body = box_body({11.7, 12.2, 13.4}, 20);
  const Measured m = measured(coverage(shape, body.line), sampled(shape, body.distance));
  std::printf("box, 1:1:1.5: mean %.5f, largest %.4f; mask: mean %.3f, largest %.3f\n",
              m.antialiased.mean, m.antialiased.max, m.binary.mean, m.binary.max);
  EXPECT_LT(m.antialiased.mean, 0.001);
  EXPECT_LT(m.antialiased.max, 0.3);
}

// Wherever the box's faces are between the samples.
TEST(Antialiased, ABoxAlongTheAxesIsExact) {
  const Shape shape{glm::ivec3(40)};
  double mean = 0;
  double largest = 0;
  for (const double half : {8.0, 9.1, 9.25, 10.37, 11.5, 11.73}) {
    const Values exact = sampled(shape, [&](const glm::dvec3& p) { return box(p, half); });
    const Values covered = sampled(shape, [&](const glm::dvec3& p) {
      const glm::dvec3 part = glm::clamp(half + 0.5 - glm::abs(p), 0.0, 1.0);
      return part.x * part.y * part.z;
    });
    const Measured m = measured(covered, exact);
    mean = std::max(mean, m.antialiased.mean);
    largest = std::max(largest, m.antialiased.max);
  }
  std::printf("boxes along the axes: mean %.6f, largest %.6f\n", mean, largest);
  EXPECT_LT(largest, 1e-4);
}

// Coverage that is none: the surface is where it passes one half between samples.
TEST(Antialiased, PlateausAndBlursHaveASurface) {
  const Shape shape{{16, 18, 40}};
  for (const int width : {1, 2, 3, 4, 5, 6, 9}) {
    for (const double grey : {0.2, 0.4, 0.6, 0.9}) {
      const Values covered = sampled(shape, [&](const glm::dvec3& p) {
        return p.z < -10 ? 1.0 : p.z < -10 + width ? grey : 0.0;
      });
      const std::vector<float> got =
          transformed(covered.seeds(SeedKind::coverage), {.method = TransformMethod::antialiased});
      for (std::size_t n = 0; n < got.size(); ++n) {
        ASSERT_TRUE(std::isfinite(got[n])) << width << " voxels of " << grey;
        ASSERT_EQ(got[n]<0, covered.values[n]> 0.5F) << width << " voxels of " << grey;
      }
    }
  }
  for (const double width : {4.0, 8.0, 16.0}) {
    const Values exact = sampled(shape, [](const glm::dvec3& p) { return p.z; });
    const Values covered = sampled(
        shape, [&](const glm::dvec3& p) { return std::clamp(0.5 - p.z / width, 0.0, 1.0); });
    const Measured m = measured(covered, exact);
    std::printf("blur of %g voxels: mean %.5f, largest %.4f\n", width, m.antialiased.mean,
                m.antialiased.max);
    EXPECT_LT(m.antialiased.max, 0.01);
  }
}

// Noise and grey on one side of one half make no surface.
TEST(Antialiased, GreyBackgroundIsNoSurface) {
  const Shape shape{glm::ivec3(48)};
  Values covered = ball_coverage(shape, 15);
  std::fill_n(covered.values.begin(), 3 * 48 * 48, 0.35F);  // a slab at the border
  std::mt19937 random(7);
  for (float& c : covered.values) {
    c = std::clamp(c + std::uniform_real_distribution<float>(-0.1F, 0.1F)(random), 0.0F, 1.0F);
  }
  const Values exact = sampled(shape, [](const glm::dvec3& p) { return ball(p, 15); });
  const Measured m = measured(covered, exact);
  std::printf("noise of 0.1: mean %.5f, largest %.4f; mask: mean %.3f, largest %.3f\n",
              m.antialiased.mean, m.antialiased.max, m.binary.mean, m.binary.max);
  EXPECT_LT(m.antialiased.mean, 0.18);
}

TEST(Antialiased, CountsSpacing) {
  Shape shape{{40, 44, 30}};
  shape.spacing = {1, 1, 2};
  const Values exact = sampled(shape, [](const glm::dvec3& p) { return ball(p, 14); });
  const Measured m = measured(ball_coverage(shape, 14), exact);
  std::printf("1:1:2: mean %.5f, largest %.4f\n", m.antialiased.mean, m.antialiased.max);
  EXPECT_LT(m.antialiased.mean, 0.006);
  EXPECT_LT(m.antialiased.max, 0.25);
}

// Plates thinner than two voxels and as far apart: no column of voxels is whole, then empty.
TEST(Antialiased, ThinPlatesAreFound) {
  const Shape shape{{24, 20, 40}};
  const auto plate = [](const glm::dvec3& p) { return std::abs(p.z) - 0.9; };
  const Values exact = sampled(shape, plate);
  const Values covered = coverage(shape, [](double, double) { return std::pair(-0.9, 0.9); });
  const Measured m = measured(covered, exact);
  EXPECT_LT(m.antialiased.max, 0.02);
}

TEST(Antialiased, EightBitsAreEnough) {
  const Shape shape{glm::ivec3(48)};
  Values covered = ball_coverage(shape, 15);
  for (float& c : covered.values) c = std::round(255 * c) / 255;
  const Values exact = sampled(shape, [](const glm::dvec3& p) { return ball(p, 15); });
  const Measured m = measured(covered, exact);
  std::printf("8 bits: mean %.5f, largest %.4f\n", m.antialiased.mean, m.antialiased.max);
  EXPECT_LT(m.antialiased.mean, 0.003);
}

// The fallback at edges cuts the right part off a box, whatever its shape and the plane's
// direction.
TEST(Antialiased, PlanesCutOffTheirCoverage) {
  std::mt19937 random(3);
  const auto unit = [&] { return std::uniform_real_distribution<>(-1, 1)(random); };
  for (int n = 0; n < 40; ++n) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(unit(), unit(), unit()));
    const glm::dvec3 sides(1 + std::abs(unit()), 1, 1 + std::abs(unit()));
    const double coverage = 0.02 + 0.48 * (unit() + 1);
    const double offset = plane_offset(coverage, normal, sides);
    constexpr int kSteps = 60;
    int below = 0;
    for (int i = 0; i < kSteps * kSteps * kSteps; ++i) {
      const glm::dvec3 at(i % kSteps, i / kSteps % kSteps, i / kSteps / kSteps);
      const glm::dvec3 p = ((at + 0.5) / static_cast<double>(kSteps) - 0.5) * sides;
      below += glm::dot(p, normal) < offset ? 1 : 0;
    }
    EXPECT_NEAR(below / std::pow(kSteps, 3), coverage, 0.01);
  }
}

TEST(Antialiased, TakesNoLevels) {
  const Values v = sampled({glm::ivec3(5)}, [](const glm::dvec3& p) { return ball(p, 2); });
  EXPECT_THROW(transformed(v.seeds(SeedKind::level), {.method = TransformMethod::antialiased}),
               Error);
}

// Against trying all sites; equally near ones may differ.
TEST(DenseFeature, MatchesBruteForce) {
  std::mt19937 random(5);
  for (const glm::dvec3& spacing : {glm::dvec3(1), glm::dvec3(1, 2.5, 10), glm::dvec3(3, 1, 1.1)}) {
    for (const int count : {0, 1, 7, 60}) {
      const glm::ivec3 dims(13, 18, 37);
      std::vector<Site> sites;
      for (int n = 0; n < count; ++n) {
        const glm::ivec3 at(random() % 13, random() % 18, random() % 37);
        const bool taken = std::any_of(sites.begin(), sites.end(),
                                       [&](const Site& site) { return site.at == at; });
        if (!taken) sites.push_back({at, glm::vec3(at)});
      }
      std::vector<std::uint32_t> nearest(13 * 18 * 37);
      find_nearest_sites(dims, spacing, sites, nearest, Job{});
      std::size_t n = 0;
      for (int i = 0; i < dims.x; ++i) {
        for (int j = 0; j < dims.y; ++j) {
          for (int k = 0; k < dims.z; ++k, ++n) {
            if (sites.empty()) {
              ASSERT_EQ(nearest[n], kNoFeature);
              continue;
            }
            const auto to = [&](const Site& site) {
              return glm::length(glm::dvec3(site.at - glm::ivec3(i, j, k)) * spacing);
            };
            double least = 1e300;
            for (const Site& site : sites) least = std::min(least, to(site));
            ASSERT_LT(nearest[n], sites.size());
            ASSERT_NEAR(to(sites[nearest[n]]), least, 1e-9);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace sdfgrid
