// The reference against which grids are measured, itself measured: against minimization in extended
// precision, brute force, the plain sum of solid angles, and closed forms.
#include "sdfgrid/mesh/reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <vector>

#include "property/random_meshes.h"
#include "sdfgrid/core/error.h"

namespace sdfgrid {
namespace {

using glm::dvec3;
using reference::closest_on_triangle;
using reference::Corners;
using reference::TriangleTree;
using shapes::Random;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// ---- closest point on a triangle ----------------------------------------------------------------

using Long = long double;
struct Long3 {
  Long x, y, z;
};
Long3 operator-(const Long3& a, const Long3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Long3 mixed(const Long3& a, const Long3& b, Long t) {
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z)};
}
Long dot(const Long3& a, const Long3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Long3 widened(const dvec3& v) { return {v.x, v.y, v.z}; }

// The distance is convex along the triangle: nested search without any case distinction. The chord
// at s goes from ab(s) to ac(s); on it the nearest point has a closed form.
double minimized_distance(const dvec3& point, const Corners& t) {
  const Long3 p = widened(point);
  const Long3 a = widened(t.a);
  const auto on_chord = [&](Long s) {
    const Long3 from = mixed(a, widened(t.b), s);
    const Long3 way = mixed(a, widened(t.c), s) - from;
    const Long length = dot(way, way);
    const Long at = length > 0 ? std::clamp(dot(p - from, way) / length, Long(0), Long(1)) : 0;
    const Long3 rest = p - mixed(from, mixed(a, widened(t.c), s), at);
    return dot(rest, rest);
  };
  Long lo = 0;
  Long hi = 1;
  for (int i = 0; i < 120; ++i) {
    const Long third = (hi - lo) / 3;
    if (on_chord(lo + third) < on_chord(hi - third)) {
      hi -= third;
    } else {
      lo += third;
    }
  }
  const Long best = std::min({on_chord(lo), on_chord(hi), on_chord(0), on_chord(1)});
  return static_cast<double>(std::sqrt(best));
}

// Triangles as readers deliver them: of floats, some of them without area.
Corners random_corners(Random& random, int kind) {
  const auto corner = [&] { return dvec3(glm::vec3(random.in_box(dvec3(-1.0), dvec3(1.0)))); };
  const dvec3 a = corner();
  const dvec3 b = corner();
  const auto near = [&](const dvec3& p, double by) { return dvec3(glm::vec3(p + by * corner())); };
  switch (kind) {
    case 0:
      return {a, b, corner()};
    case 1:
      return {a, near(a, 1e-6), b};  // a needle
    case 2:
      return {a, b, near(0.5 * (a + b), 1e-7)};  // a cap
    case 3:
      return {a, b, a + 0.25 * (b - a)};  // three points of a line
    case 4:
      return {a, b, b};
    case 5:
      return {a, a, a};
    default:
      return {near(a, 1e-3), near(a, 1e-3), near(a, 1e-3)};  // small, away from zero
  }
}

TEST(ClosestOnTriangle, AgreesWithMinimizationOnAllShapesAndScales) {
  Random random(1);
  for (int i = 0; i < 14000; ++i) {
    const int kind = i % 7;
    Corners t = random_corners(random, kind);
    dvec3 p = random.in_box(dvec3(-1.5), dvec3(1.5));
    const int place = random.integer(0, 3);
    if (place == 1) p = t.a + 1e-3 * p;
    if (place >= 2) {  // above or on the inside, however thin that is
      const double u = random.unit();
      const double v = random.range(0, 1 - u);
      const dvec3 across = t.b + t.c - 2.0 * t.a;
      p = t.a + u * (t.b - t.a) + v * (t.c - t.a) +
          (place == 2 ? 0.1 : 0.0) * glm::cross(across, p);
    }
    const double scale = std::pow(10.0, random.integer(-6, 6));
    for (dvec3* v : {&t.a, &t.b, &t.c, &p}) *v *= scale;
    const double expected = minimized_distance(p, t);
    const double found = glm::length(closest_on_triangle(p, t) - p);
    EXPECT_NEAR(found, expected, 4e-12 * scale + 1e-12 * expected) << "kind " << kind << " #" << i;
  }
}

TEST(ClosestOnTriangle, GivesThePointItselfOnTheTriangle) {
  const Corners t{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (const dvec3& p : {dvec3(0.25, 0.25, 0), dvec3(0.5, 0.5, 0), dvec3(0, 1, 0), dvec3(0)}) {
    EXPECT_EQ(closest_on_triangle(p, t), p);
  }
}

// ---- the tree -----------------------------------------------------------------------------------

std::vector<Corners> corners_of(const TriangleSoup& soup) {
  std::vector<Corners> corners;
  for (const glm::uvec3& t : soup.triangles) {
    corners.push_back({soup.local(t.x), soup.local(t.y), soup.local(t.z)});
  }
  return corners;
}

double brute_distance(const dvec3& p, const std::vector<Corners>& triangles) {
  double best = kInfinity;
  for (const Corners& t : triangles) {
    best = std::min(best, glm::length(closest_on_triangle(p, t) - p));
  }
  return best;
}

// What upsets a builder: everything in one place, sizes from 1e-12 to 1, an exponential row.
std::vector<shapes::NamedMesh> awkward_soups() {
  std::vector<shapes::NamedMesh> soups{{"one triangle", shapes::random_triangles(1, 7)},
                                       {"random", shapes::random_triangles(500, 8)},
                                       {"torus", shapes::torus_mesh(0.7, 0.2)}};
  TriangleSoup same = shapes::random_triangles(1, 9);
  same.triangles.resize(300, same.triangles.front());
  soups.push_back({"300 times the same", same});
  TriangleSoup point = same;
  for (glm::vec3& p : point.points) p = point.points.front();
  soups.push_back({"300 times a point", point});
  TriangleSoup row;
  float at = 1;
  for (std::uint32_t i = 0; i < 120; ++i, at *= 0.5F) {
    for (const glm::vec3& p : {glm::vec3(at, 0, 0), glm::vec3(0, at, 0), glm::vec3(at)}) {
      row.points.push_back(p);
    }
    row.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  soups.push_back({"exponential row", row});
  return soups;
}

TEST(TriangleTree, FindsWhatBruteForceFinds) {
  Random random(2);
  for (const auto& [name, soup] : awkward_soups()) {
    const std::vector<Corners> triangles = corners_of(soup);
    const TriangleTree tree(triangles);
    ASSERT_EQ(tree.triangles().size(), triangles.size()) << name;
    for (int i = 0; i < 400; ++i) {
      const dvec3 p = random.in_box(dvec3(-1.5), dvec3(1.5));
      const double expected = brute_distance(p, triangles);
      const TriangleTree::Nearest found = tree.nearest(p, kInfinity);
      EXPECT_DOUBLE_EQ(std::sqrt(found.squared), expected) << name;
      EXPECT_EQ(tree.nearest(p, 1.0001 * found.squared).squared, found.squared) << name;
      EXPECT_EQ(tree.nearest(p, 0.9999 * found.squared).squared, kInfinity) << name;
    }
  }
}

TEST(TriangleTree, RefusesRaysThroughCornersAndEdges) {
  const TriangleTree tree(corners_of(shapes::box_mesh(dvec3(-1), dvec3(1))));
  const dvec3 along = glm::normalize(dvec3(1, 2, 3));
  const dvec3 across = glm::normalize(glm::cross(along, dvec3(0, 0, 1)));
  const reference::RayFrame frame{across, glm::cross(along, across), along};
  EXPECT_EQ(tree.crossings(dvec3(0.1, -0.2, 0), frame), 1);
  EXPECT_EQ(tree.crossings(dvec3(0.1, -0.2, -1) - along, frame), 0);  // in and out
  EXPECT_EQ(tree.crossings(dvec3(0.1, -0.2, 1) + along, frame), 0);   // behind
  EXPECT_EQ(tree.crossings(dvec3(1, 1, 1) - along, frame), std::nullopt);
  EXPECT_EQ(tree.crossings(dvec3(1, 0.3, 1) - along, frame), std::nullopt);
  EXPECT_EQ(tree.crossings(dvec3(0.2, 0.3, 1), frame), std::nullopt);  // starts on a face
}

TEST(ReferenceDistance, AKnownPointChangesNothing) {
  Random random(3);
  TriangleSoup soup = shapes::torus_mesh(0.7, 0.2);
  soup.origin = {6e5, 4e6, 100};
  const ReferenceDistance reference(soup);
  dvec3 known = reference.closest(soup.origin);
  for (int i = 0; i < 1000; ++i) {
    const dvec3 p = soup.origin + random.in_box(dvec3(-1), dvec3(1));
    const dvec3 expected = reference.closest(p);
    known = reference.closest(p, known);
    EXPECT_EQ(known, expected);
    EXPECT_EQ(reference.closest(p, p), expected) << "a false hint is found out";
  }
}

// ---- the winding number -------------------------------------------------------------------------

// Three half planes on one edge, one of them doubled.
TriangleSoup three_sheets() {
  TriangleSoup soup;
  soup.points = {{0, 0, -1}, {0, 0, 1}, {1, 0, 0}, {-0.5F, 0.8F, 0}, {-0.5F, -0.8F, 0}};
  soup.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {0, 1, 4}};
  return soup;
}

// The same surface with corners of its own for every triangle, as STL files have them.
TriangleSoup unwelded(const TriangleSoup& soup) {
  TriangleSoup apart;
  apart.origin = soup.origin;
  for (const glm::uvec3& t : soup.triangles) {
    const auto base = static_cast<std::uint32_t>(apart.points.size());
    for (int k = 0; k < 3; ++k) apart.points.push_back(soup.points[t[k]]);
    apart.triangles.emplace_back(base, base + 1, base + 2);
  }
  return apart;
}

std::vector<shapes::NamedMesh> open_and_closed() {
  using namespace shapes;
  Random random(4);
  std::vector<NamedMesh> meshes{
      {"sphere", icosphere(3, 1.0)},
      {"sphere without corners in common", unwelded(icosphere(2, 1.0))},
      {"box", box_mesh(dvec3(-0.5), dvec3(0.5))},
      {"box inside out", flipped(box_mesh(dvec3(-0.5), dvec3(0.5)))},
      {"sphere with a hole", with_hole(icosphere(3, 1.0), 100, 60)},
      {"sphere with many holes", unwelded(with_hole(icosphere(3, 1.0), 3, 1))},
      {"box without a side", with_hole(box_mesh(dvec3(-0.5), dvec3(0.5)), 2, 2)},
      {"half flipped", joined(flipped(with_hole(icosphere(2, 1.0), 0, 160)),
                              with_hole(icosphere(2, 1.0), 160, 160))},
      {"overlapping", joined(icosphere(2, 0.6, dvec3(0.3, 0, 0)), icosphere(2, 0.6))},
      {"three sheets", three_sheets()},
      {"one triangle", random_triangles(1, 5)},
      {"soup", random_triangles(60, 6)}};
  TriangleSoup far = with_hole(icosphere(3, 1.0), 10, 40);
  far.origin = {6e5, 4e6, -50};
  meshes.push_back({"far away", far});
  meshes.push_back({"small", scaled(with_hole(torus_mesh(0.7, 0.2), 20, 7), 1e-6)});
  return meshes;
}

TEST(WindingNumber, RayAndBorderAgreeWithTheSumOfSolidAngles) {
  Random random(5);
  for (const auto& [name, soup] : open_and_closed()) {
    const ReferenceDistance reference(soup);
    const Box box = bounds(soup);
    for (int i = 0; i < 500; ++i) {
      const dvec3 p = box.center() + 0.8 * random.in_box(-box.size(), box.size());
      EXPECT_NEAR(reference.winding_number(p), reference.winding_number_by_sum(p), 1e-9) << name;
    }
  }
}

TEST(WindingNumber, HoldsInThePlanesOfTheFaces) {
  // Every angle is a round fraction of pi here, and many terms are +-pi exactly.
  for (const bool open : {false, true}) {
    TriangleSoup soup = shapes::box_mesh(dvec3(-0.5), dvec3(0.5));
    if (open) soup = shapes::with_hole(soup, 0, 2);
    const ReferenceDistance reference(soup);
    const double coordinates[] = {-1.0, -0.5, -0.25, 0.0, 0.25, 0.5, 1.0};
    for (const double x : coordinates) {
      for (const double y : coordinates) {
        for (const double z : coordinates) {
          const dvec3 p(x, y, z);
          if (reference.distance(p) < 1e-15) continue;
          EXPECT_NEAR(reference.winding_number(p), reference.winding_number_by_sum(p), 1e-12);
          if (open) continue;
          const bool inside = std::max({std::abs(x), std::abs(y), std::abs(z)}) < 0.5;
          EXPECT_EQ(reference.winding_number(p), inside ? 1.0 : 0.0);
        }
      }
    }
  }
}

TEST(WindingNumber, OnClosedMeshesIsAWholeNumberEverywhere) {
  Random random(6);
  for (const auto& [name, soup] : shapes::random_closed_meshes(7, 60)) {
    const ReferenceDistance reference(soup);
    EXPECT_TRUE(reference.closed()) << name;
    const Box box = bounds(soup);
    for (int i = 0; i < 50; ++i) {
      const dvec3 p = random.in_box(box.lo, box.hi);
      const double winding = reference.winding_number(p);
      EXPECT_EQ(winding, std::round(winding)) << name;
      EXPECT_NEAR(winding, reference.winding_number_by_sum(p), 1e-6) << name;
    }
  }
}

TEST(ReferenceDistance, KnowsClosedFromOpen) {
  EXPECT_TRUE(ReferenceDistance(unwelded(shapes::icosphere(1, 1.0))).closed());
  EXPECT_FALSE(ReferenceDistance(three_sheets()).closed());
  const TriangleSoup two = shapes::joined(shapes::icosphere(1, 1.0), shapes::icosphere(1, 1.0));
  EXPECT_TRUE(ReferenceDistance(two).closed());
}

// ---- closed forms -------------------------------------------------------------------------------

double box_distance(const dvec3& p, double half) {
  const dvec3 q = glm::abs(p) - half;
  return glm::length(glm::max(q, 0.0)) + std::min(std::max({q.x, q.y, q.z}), 0.0);
}

TEST(SignedDistance, OfABoxIsTheClosedForm) {
  Random random(7);
  const ReferenceDistance reference(shapes::box_mesh(dvec3(-0.5), dvec3(0.5)));
  for (int i = 0; i < 5000; ++i) {
    const dvec3 p = random.in_box(dvec3(-1), dvec3(1));
    EXPECT_NEAR(reference.signed_distance(p), box_distance(p, 0.5), 1e-15);
  }
  EXPECT_NEAR(reference.signed_distance(dvec3(0.5, 0.1, 0.2)), 0.0, 1e-15);
}

TEST(SignedDistance, OfASphereAndATorusLiesWithinTheirFacets) {
  Random random(8);
  const ReferenceDistance sphere(shapes::icosphere(5, 1.0));
  const ReferenceDistance torus(shapes::torus_mesh(0.7, 0.2, 256, 128));
  const double facet = 6e-4;  // edges up to 0.038 and 0.022: sagitta edge^2 / 8 r and its like
  for (int i = 0; i < 3000; ++i) {
    const dvec3 p = random.in_box(dvec3(-1.2), dvec3(1.2));
    EXPECT_NEAR(sphere.signed_distance(p), glm::length(p) - 1.0, facet);
    const double ring = std::hypot(std::hypot(p.x, p.y) - 0.7, p.z) - 0.2;
    EXPECT_NEAR(torus.signed_distance(p), ring, facet);
  }
}

TEST(SignedDistance, NestedAndOverlappingShells) {
  const ReferenceDistance hollow(shapes::nested_shells(2, 1.0, 0.5));
  EXPECT_GT(hollow.signed_distance(dvec3(0.1)), 0);
  EXPECT_LT(hollow.signed_distance(dvec3(0.7, 0, 0)), 0);
  const ReferenceDistance both(
      shapes::joined(shapes::icosphere(2, 0.6, dvec3(0.3, 0, 0)), shapes::icosphere(2, 0.6)));
  EXPECT_NEAR(both.winding_number(dvec3(0.15, 0, 0)), 2.0, 1e-12);
  EXPECT_LT(both.signed_distance(dvec3(0.15, 0, 0)), 0);
}

// ---- refusals -----------------------------------------------------------------------------------

TEST(ReferenceDistance, RefusesWhatIsNoMesh) {
  EXPECT_THROW(ReferenceDistance{TriangleSoup()}, Error);
  TriangleSoup bad = shapes::icosphere(0, 1.0);
  bad.triangles.emplace_back(0, 1, 12);
  EXPECT_THROW(ReferenceDistance{bad}, Error);
  bad = shapes::icosphere(0, 1.0);
  bad.points[5].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(ReferenceDistance{bad}, Error);
}

}  // namespace
}  // namespace sdfgrid
