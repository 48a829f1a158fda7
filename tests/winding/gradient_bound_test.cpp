// The bound on the winding number's gradient: above every finite difference, never far too large.
#include <gtest/gtest.h>

#include "property/random_meshes.h"
#include "sdfgrid/mesh/winding.h"
#include "winding/direct_sum.h"

namespace sdfgrid {
namespace {

using shapes::Random;

// The exact gradient by central differences of each triangle's solid angle, taken modulo a full
// turn so that crossing a triangle does not count.
glm::dvec3 gradient(const TriangleSoup& soup, const glm::dvec3& p, double step) {
  glm::dvec3 sum(0.0);
  for (const glm::uvec3& t : soup.triangles) {
    for (int a = 0; a < 3; ++a) {
      glm::dvec3 q = p;
      q[a] = p[a] + step;
      const double above = solid_angle(soup.local(t.x), soup.local(t.y), soup.local(t.z), q);
      q[a] = p[a] - step;
      const double below = solid_angle(soup.local(t.x), soup.local(t.y), soup.local(t.z), q);
      sum[a] += std::remainder(above - below, 4.0 * std::numbers::pi) / (2.0 * step);
    }
  }
  return 0.25 * std::numbers::inv_pi * sum;
}

struct Tightness {
  double smallest_ratio = 1e300;  // bound / gradient over all probes: must stay above one
  int finite = 0;
};

Tightness check(const TriangleSoup& soup, int count, std::uint64_t seed) {
  const WindingNumber winding(soup);
  Random random(seed);
  Tightness result;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 center = random.in_box(glm::dvec3(-2.0), glm::dvec3(2.0));
    const double radius = std::pow(10.0, random.range(-3.0, -0.3));
    const double bound = winding.gradient_bound(center, radius);
    if (std::isinf(bound)) continue;
    ++result.finite;
    for (int j = 0; j < 4; ++j) {
      const double off = j == 0 ? 0.0 : radius * random.range(0.9, 1.0);
      const double slope = glm::length(gradient(soup, center + off * random.direction(), 1e-5));
      result.smallest_ratio = std::min(result.smallest_ratio, (bound + 1e-7) / slope);
    }
  }
  return result;
}

TEST(GradientBound, IsAboveEveryFiniteDifference) {
  const TriangleSoup sphere = shapes::icosphere(2, 1.0);
  const TriangleSoup soups[] = {shapes::random_triangles(1, 1, 0.9),
                                shapes::random_triangles(10, 2, 0.5),
                                shapes::random_triangles(150, 3, 0.2),
                                shapes::with_hole(sphere, 20, 1),
                                shapes::with_hole(sphere, 0, 160),
                                shapes::joined(sphere, shapes::with_hole(sphere, 5, 40)),
                                shapes::with_hole(shapes::torus_mesh(1.0, 0.3), 0, 50)};
  for (const TriangleSoup& soup : soups) {
    const Tightness t = check(soup, 150, 7);
    EXPECT_GT(t.finite, 20) << soup.triangles.size();
    EXPECT_GE(t.smallest_ratio, 1.0 - 1e-4) << soup.triangles.size();
  }
}

// The field in the middle of a ring of radius R is 1 / (2 R) of a winding number per unit, and all
// of the ring adds up there: the bound is attained.
TEST(GradientBound, IsAttainedInTheMiddleOfARing) {
  TriangleSoup disk;
  disk.points.emplace_back(0.0F);
  constexpr std::uint32_t kCorners = 1000;
  for (std::uint32_t i = 0; i < kCorners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kCorners;
    disk.points.emplace_back(2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.0);
    disk.triangles.emplace_back(0U, 1 + i, 1 + (i + 1) % kCorners);
  }
  const WindingNumber winding(disk);
  EXPECT_GE(winding.gradient_bound({0, 0, 0}, 0.0), 0.2499);
  EXPECT_LE(winding.gradient_bound({0, 0, 0}, 0.0), 0.25 * 1.3);
  EXPECT_LE(winding.gradient_bound({0, 0, 0}, 0.2), 0.25 / (0.9 * 0.9) * 1.3);
}

// Where the ball comes close to the boundary the gradient is many times that at its centre.
TEST(GradientBound, HoldsOnTheSideOfTheBallNextToTheBoundary) {
  for (const double size : {0.02, 0.2, 2.0, 20.0}) {  // far less than the distance to far more
    TriangleSoup corner;  // a corner, or the middle of an edge, is nearest to the ball
    corner.points = {{1, 0, 0}, {1 + size, -size, 0}, {1 + size, size, 0}};
    corner.triangles = {{0, 1, 2}};
    TriangleSoup edge = corner;
    edge.points = {{1 + size, 0, 0}, {1, size, 0}, {1, -size, 0}};
    for (const TriangleSoup& soup : {corner, edge}) {
      const WindingNumber winding(soup);
      for (const double radius : {0.0, 0.5, 0.9, 0.95}) {
        const double slope = glm::length(gradient(soup, {radius, 0.0, 0.0}, 1e-6));
        EXPECT_GE(winding.gradient_bound(glm::dvec3(0.0), radius), slope) << size << " " << radius;
      }
    }
  }
}

// A thousand loops of little holes, seen from far away, must not add up their whole length.
TEST(GradientBound, OfClosedLoopsFallsFasterThanOfTheirLength) {
  TriangleSoup holes;
  const TriangleSoup sphere = shapes::icosphere(3, 1.0);
  for (std::size_t i = 0; i < sphere.triangles.size(); ++i) {
    if (i % 4 != 3) holes.triangles.push_back(sphere.triangles[i]);
  }
  holes.points = sphere.points;
  const WindingNumber winding(holes);
  const double near = winding.gradient_bound({10, 0, 0}, 0.0);
  const double far = winding.gradient_bound({1000, 0, 0}, 0.0);
  EXPECT_LT(far, near * 2e-6);
  EXPECT_GT(far, 0.0);
}

TEST(GradientBound, IsInfiniteWhereABoundaryEdgeEntersTheBall) {
  const TriangleSoup triangle = shapes::random_triangles(1, 9, 0.9);
  const WindingNumber winding(triangle);
  const glm::dvec3 middle = 0.5 * (triangle.local(0) + triangle.local(1));
  EXPECT_TRUE(std::isinf(winding.gradient_bound(middle, 1e-9)));
  EXPECT_TRUE(std::isinf(winding.gradient_bound(middle + glm::dvec3(0.1, 0, 0), 0.1001)));
  EXPECT_TRUE(std::isinf(winding.gradient_bound(glm::dvec3(0.0), 10.0)));
  EXPECT_FALSE(std::isinf(winding.gradient_bound(glm::dvec3(5.0), 1.0)));
}

// gradient_below() may look less closely, but says yes wherever the tight bound does, and no where
// it is far from it.
TEST(GradientBound, IsBelowWhatItIsBelow) {
  const WindingNumber winding(shapes::random_triangles(300, 3, 0.2));
  Random random(4);
  int finite = 0;
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 center = random.in_box(glm::dvec3(-3.0), glm::dvec3(3.0));
    const double bound = winding.gradient_bound(center, 0.01);
    if (std::isinf(bound)) {
      EXPECT_FALSE(winding.gradient_below(center, 0.01, 1e12));
      continue;
    }
    EXPECT_FALSE(winding.gradient_below(center, 0.01, 0.9 * bound));
    EXPECT_TRUE(winding.gradient_below(center, 0.01, 1.0001 * bound));
    ++finite;
  }
  EXPECT_GT(finite, 200);
}

TEST(Closed, IsToldByTheNetBoundary) {
  const TriangleSoup sphere = shapes::icosphere(2, 1.0);
  EXPECT_TRUE(WindingNumber(sphere).closed());
  EXPECT_EQ(WindingNumber(sphere).gradient_bound({1, 0, 0}, 1.0), 0.0);
  EXPECT_FALSE(WindingNumber(shapes::with_hole(sphere, 3, 1)).closed());
  for (const shapes::NamedMesh& mesh : shapes::random_closed_meshes(8, 40)) {
    EXPECT_TRUE(WindingNumber(mesh.soup).closed()) << mesh.name;
  }
  // One triangle turned: the boundary counts twice.
  TriangleSoup turned = sphere;
  std::swap(turned.triangles[7].x, turned.triangles[7].y);
  EXPECT_FALSE(WindingNumber(turned).closed());
  // A triangle and its back cancel; every edge has two triangles, but the sum is what counts.
  TriangleSoup sheet = shapes::random_triangles(5, 3);
  EXPECT_FALSE(WindingNumber(sheet).closed());
  EXPECT_TRUE(WindingNumber(shapes::joined(sheet, shapes::flipped(sheet))).closed());
}

// Every triangle with corners of its own, as in a file of facets.
TEST(Closed, CountsPointsAtOnePositionAsOne) {
  const TriangleSoup sphere = shapes::icosphere(2, 1.0);
  TriangleSoup facets;
  for (const glm::uvec3& t : sphere.triangles) {
    const auto base = static_cast<std::uint32_t>(facets.points.size());
    for (int k = 0; k < 3; ++k) facets.points.push_back(sphere.points[t[k]]);
    facets.triangles.emplace_back(base, base + 1, base + 2);
  }
  EXPECT_TRUE(WindingNumber(facets).closed());
}

}  // namespace
}  // namespace sdfgrid
