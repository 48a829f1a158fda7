// The winding number against the direct sum, and what it promises for soups of every kind.
#include "sdfgrid/mesh/winding.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "property/random_meshes.h"
#include "sdfgrid/core/parallel.h"
#include "winding/direct_sum.h"

namespace sdfgrid {
namespace {

using shapes::Random;

Box local_bounds(const TriangleSoup& soup) {
  Box box = bounds(soup);
  box.lo -= soup.origin;
  box.hi -= soup.origin;
  return box;
}

double size_of(const Box& box) { return std::max({box.size().x, box.size().y, box.size().z}); }

glm::dvec3 point_on_triangle(const TriangleSoup& soup, Random& random) {
  const int last = static_cast<int>(soup.triangles.size()) - 1;
  const glm::uvec3 t = soup.triangles[static_cast<std::size_t>(random.integer(0, last))];
  const double u = std::sqrt(random.unit());
  const double v = u * random.unit();
  return (1.0 - u) * soup.local(t.x) + (u - v) * soup.local(t.y) + v * soup.local(t.z);
}

// Positions beside the triangles (1e-4 to 1e-1 sizes off), in and around the box, and far away.
std::vector<glm::dvec3> probes(const TriangleSoup& soup, int count, std::uint64_t seed) {
  Random random(seed);
  const Box box = local_bounds(soup);
  const double size = size_of(box);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < count; ++i) {
    const double off = size * std::pow(10.0, random.range(-4.0, -1.0));
    points.push_back(point_on_triangle(soup, random) + off * random.direction());
    points.push_back(random.in_box(box.lo - 0.2 * size, box.hi + 0.2 * size));
    const double away = size * std::pow(10.0, random.range(0.0, 6.0));
    points.push_back(box.center() + away * random.direction());
  }
  return points;
}

double worst_error(const TriangleSoup& soup, int count, std::uint64_t seed) {
  const WindingNumber winding(soup);
  const std::vector<glm::dvec3> points = probes(soup, count, seed);
  std::vector<double> values(points.size());
  winding.at(points, values);
  double worst = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double error = std::abs(values[i] - direct_winding(soup, points[i]));
    worst = error <= worst ? worst : error;  // a NaN sticks
  }
  return worst;
}

struct Case {
  const char* name;
  TriangleSoup soup;
};

std::vector<Case> cases() {
  Random random(11);
  const TriangleSoup sphere = shapes::icosphere(4, 1.0);
  TriangleSoup slivers = shapes::random_triangles(300, 5);
  for (std::size_t i = 0; i < slivers.triangles.size(); ++i) {  // third corner almost on an edge
    const glm::uvec3 t = slivers.triangles[i];
    const glm::vec3 middle = 0.5F * (slivers.points[t.x] + slivers.points[t.y]);
    slivers.points[t.z] = middle + 1e-4F * (slivers.points[t.z] - middle);
  }
  TriangleSoup mixed = shapes::box_mesh({-2, -2, -2}, {2, 2, 2});  // large beside very small
  mixed = shapes::joined(mixed, shapes::icosphere(3, 1e-3, {1.9, 1.9, 1.9}));
  return {{"tetrahedron", shapes::tetrahedron_mesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})},
          {"box", shapes::box_mesh({0, 0, 0}, {1, 2, 3})},
          {"sphere", sphere},
          {"open sphere", shapes::with_hole(sphere, 100, 900)},
          {"half of a sphere", shapes::with_hole(sphere, 0, sphere.triangles.size() / 2)},
          {"flipped sphere", shapes::flipped(sphere)},
          {"the same sphere twice", shapes::joined(sphere, sphere)},
          {"nested shells", shapes::nested_shells(3, 1.0, 0.5)},
          {"two spheres", shapes::two_spheres(3, 1.0, 0.01)},
          {"perturbed sphere", shapes::perturbed(sphere, random, 0.2)},
          {"torus", shapes::torus_mesh(1.0, 0.3, 60, 30)},
          {"thin plate", shapes::plate_mesh({0, 0, 0}, 1.0, 1e-3)},
          {"slivers", slivers},
          {"large and small", mixed},
          {"1000 random triangles", shapes::random_triangles(1000, 3)},
          {"1000 large triangles", shapes::random_triangles(1000, 4, 0.9)},
          {"20000 small triangles", shapes::random_triangles(20000, 6, 0.05)}};
}

TEST(Winding, AgreesWithTheDirectSumOnSoupsOfEveryKind) {
  for (const Case& c : cases()) {
    const int count = c.soup.triangles.size() > 10000 ? 100 : 500;
    EXPECT_LT(worst_error(c.soup, count, 1), WindingNumber::tolerance()) << c.name;
  }
}

TEST(Winding, AgreesWithTheDirectSumOnRandomClosedMeshes) {
  for (const shapes::NamedMesh& mesh : shapes::random_closed_meshes(2, 60)) {
    EXPECT_LT(worst_error(mesh.soup, 30, 3), WindingNumber::tolerance()) << mesh.name;
  }
}

// Cubes that the triangles cross, that are as large as the soup or lie beside and far away from it.
TEST(Winding, OfCubesOfPointsAgreesWithTheDirectSum) {
  for (const Case& c : cases()) {
    const WindingNumber winding(c.soup);
    const Box box = bounds(c.soup);
    const double size = glm::length(box.size());
    Random random(7);
    std::array<double, WindingNumber::kCubePoints> w;
    for (int cube = 0; cube < 30; ++cube) {
      const double step = size * std::pow(10.0, random.range(-4.0, -0.5));
      const glm::dvec3 corner = box.center() - c.soup.origin +
                                size * random.range(0.0, 1.5) * random.direction() - 3.5 * step;
      winding.at_cube(corner, step, w);
      for (int i = 0; i < 12; ++i) {
        const auto at = static_cast<std::size_t>(random.range(0.0, 511.99));
        const glm::dvec3 p = corner + step * glm::dvec3(at >> 6, at >> 3 & 7, at & 7);
        EXPECT_NEAR(w[at], direct_winding(c.soup, p), WindingNumber::tolerance())
            << c.name << ", step " << step << ", sample " << at;
      }
    }
  }
}

TEST(Winding, IsOneInsideAndZeroOutsideOfAClosedSphere) {
  for (const double radius : {1e-30, 1e-6, 1.0, 1e6, 1e30}) {
    const WindingNumber winding(shapes::icosphere(4, radius));
    Random random(4);
    for (int i = 0; i < 500; ++i) {
      const glm::dvec3 direction = random.direction();
      const double inside = winding.at(direction * radius * random.range(0.0, 0.99));
      EXPECT_NEAR(inside, 1.0, WindingNumber::tolerance()) << radius;
      const double far = std::pow(10.0, random.range(0.01, 6.0));
      EXPECT_NEAR(winding.at(direction * radius * far), 0.0, WindingNumber::tolerance()) << radius;
    }
  }
}

// From the middle of concentric shells thousands of patches are seen from the front and at once,
// and the errors of their expansions have one sign; leaves hold parts of several shells.
TEST(Winding, StaysExactInTheMiddleOfManyLayers) {
  TriangleSoup eight;
  for (int k = 0; k < 8; ++k) eight = shapes::joined(eight, shapes::icosphere(4, 1.0 - 0.1 * k));
  const WindingNumber eight_times(eight);
  const WindingNumber hollow(shapes::nested_shells(5, 1.0, 0.5));
  Random random(6);
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 p = 0.25 * random.unit() * random.direction();
    EXPECT_NEAR(eight_times.at(p), 8.0, WindingNumber::tolerance());
    EXPECT_NEAR(hollow.at(p), 0.0, 0.5 * WindingNumber::tolerance());
  }
}

TEST(Winding, CountsDirectionAndCopies) {
  const TriangleSoup sphere = shapes::icosphere(3, 1.0);
  const TriangleSoup twice = shapes::joined(sphere, sphere);
  const glm::dvec3 inside(0.1, 0.2, 0.3);
  EXPECT_NEAR(WindingNumber(shapes::flipped(sphere)).at(inside), -1.0, 1e-3);
  EXPECT_NEAR(WindingNumber(twice).at(inside), 2.0, 2e-3);
  EXPECT_NEAR(WindingNumber(shapes::joined(sphere, shapes::flipped(sphere))).at(inside), 0.0, 1e-3);
}

// A unit square seen from height h above its middle covers 4 asin(1 / (1 + 4 h^2)).
TEST(Winding, OfASquareIsKnownInClosedForm) {
  TriangleSoup square;
  square.points = {{-0.5, -0.5, 0}, {0.5, -0.5, 0}, {0.5, 0.5, 0}, {-0.5, 0.5, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  const WindingNumber winding(square);
  for (const double h : {1e-7, 1e-3, 0.1, 1.0, 10.0, 1e3}) {
    const double expected = std::asin(1.0 / (1.0 + 4.0 * h * h)) / std::numbers::pi;
    EXPECT_NEAR(winding.at({0, 0, -h}), expected, 1e-2 * expected) << h;
    EXPECT_NEAR(winding.at({0, 0, h}), -expected, 1e-2 * expected) << h;
  }
}

TEST(Winding, IsFiniteOnTheTrianglesThemselves) {
  for (const Case& c : cases()) {
    const WindingNumber winding(c.soup);
    for (std::size_t i = 0; i < c.soup.points.size(); i += 7) {
      EXPECT_TRUE(std::isfinite(winding.at(c.soup.local(static_cast<std::uint32_t>(i))))) << c.name;
    }
    Random random(9);
    for (int i = 0; i < 100; ++i) {
      EXPECT_TRUE(std::isfinite(winding.at(point_on_triangle(c.soup, random)))) << c.name;
    }
  }
}

// The jump across a triangle is found within 1e-6 of its size, whatever the triangle's shape.
TEST(Winding, JumpsByOneAcrossATriangle) {
  const WindingNumber box(shapes::box_mesh({-1, -1, -1}, {1, 1, 1}));
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const double u = random.range(-1.0, 1.0);
    const double v = random.range(-1.0, 1.0);
    EXPECT_NEAR(box.at({u, v, 1.0 - 1e-6}), 1.0, 1e-3);
    EXPECT_NEAR(box.at({u, v, 1.0 + 1e-6}), 0.0, 1e-3);
  }
}

TEST(Winding, OfNothingIsZero) {
  EXPECT_EQ(WindingNumber(TriangleSoup{}).at({1, 2, 3}), 0.0);
  EXPECT_TRUE(WindingNumber(TriangleSoup{}).closed());
  TriangleSoup flat;  // no triangle has an area: a point, a repeated index, three in a line
  flat.points = {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {1, 1, 1}};
  flat.triangles = {{0, 0, 0}, {0, 1, 1}, {0, 1, 2}, {0, 3, 2}};
  const WindingNumber winding(flat);
  EXPECT_EQ(winding.at({1, 1, 1}), 0.0);
  EXPECT_EQ(winding.at({2, 2, 2.00001}), 0.0);
}

TEST(Winding, DegenerateTrianglesChangeNothing) {
  TriangleSoup sphere = shapes::icosphere(3, 1.0);
  const WindingNumber without(sphere);
  const std::vector<glm::dvec3> points = probes(sphere, 200, 8);
  const auto corners = static_cast<std::uint32_t>(sphere.points.size());
  for (std::uint32_t i = 0; i + 1 < corners; ++i) sphere.triangles.emplace_back(i, i, i + 1);
  const WindingNumber with(sphere);
  for (const glm::dvec3& p : points) EXPECT_EQ(with.at(p), without.at(p));
}

TEST(Winding, OfAPositionThatIsNotFiniteIsZero) {
  const WindingNumber winding(shapes::icosphere(2, 1.0));
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(winding.at({std::numeric_limits<double>::quiet_NaN(), 0, 0}), 0.0);
  EXPECT_EQ(winding.at({0, infinity, 0}), 0.0);
  EXPECT_EQ(winding.at({0, 0, 1e300}), 0.0);
}

TEST(Winding, HasTheSameBitsAtAnyThreadCountAndInAnyBatch) {
  const TriangleSoup soup = shapes::random_triangles(40000, 12, 0.05);
  const std::vector<glm::dvec3> points = probes(soup, 300, 13);
  std::vector<double> first(points.size());
  {
    const ThreadLimit limit(1);
    WindingNumber(soup).at(points, first);
  }
  for (const int threads : {2, 8}) {
    const ThreadLimit limit(threads);
    const WindingNumber winding(soup);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double value = winding.at(points[i]);
      EXPECT_EQ(std::memcmp(&value, &first[i], sizeof value), 0) << threads;
    }
  }
}

TEST(Winding, StopsWhenCancelled) {
  const Job job;
  job.cancel();
  EXPECT_ANY_THROW(WindingNumber(shapes::icosphere(3, 1.0), job));
}

TEST(Winding, RefusesSpansOfDifferentSizes) {
  const WindingNumber winding(shapes::icosphere(1, 1.0));
  const std::vector<glm::dvec3> points(3);
  std::vector<double> values(2);
  EXPECT_THROW(winding.at(points, values), std::invalid_argument);
}

}  // namespace
}  // namespace sdfgrid
