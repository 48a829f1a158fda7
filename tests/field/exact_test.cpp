// Exact ops at places where their formulas are nearly 0 / 0, or have several branches.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "field/brute_force.h"

namespace {

using sdfgrid::Field;

double sq(double v) { return v * v; }

// The box of a curve far from the origin holds what floats make of the tube around it.
TEST(ExactOps, BoundsOfCurvesFarAway) {
  constexpr double kAway = 10000;
  std::mt19937 random(29);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int curve = 0; curve < 40; ++curve) {
    std::vector<double> points(9);
    for (double& c : points) c = kAway + unit(random);
    const Field f = sdfgrid::make_field("bezier", {{"points", points}, {"radius", 0.05}});
    const sdfgrid::Box box = f.bounds();
    for (int i = 0; i < 20000; ++i) {
      // On one of the faces, or as near as floats are.
      Vec p = box.lo + Vec(unit(random), unit(random), unit(random)) * box.size();
      p[i % 3] = i % 2 == 0 ? box.lo[i % 3] : box.hi[i % 3];
      ASSERT_GE(f(glm::vec3(p)), 0) << curve << ": " << p.x << " " << p.y << " " << p.z;
    }
  }
}

// At random points and at those of a lattice, where the nearest place of symmetric and of straight
// curves is half way or a quarter along.
TEST(ExactOps, CubicCurves) {
  std::mt19937 random(23);
  std::uniform_real_distribution<double> unit(-1.5, 1.5);
  const std::vector<std::vector<double>> curves = {{-1, 0, 0, -0.5, 2, 0.5, 0.5, -2, 0, 1, 0, 0.3},
                                                   {-1, 0, 0, -0.5, 1, 0, 0.5, 1, 0, 1, 0, 0},
                                                   {-1.5, 0, 0, -0.5, 0, 0, 0.5, 0, 0, 1.5, 0, 0}};
  for (const std::vector<double>& v : curves) {
    const Field f = sdfgrid::make_field("bezier", {{"points", v}, {"radius", 0.1}});
    std::vector<Vec> core;
    sdfgrid::Box box;
    for (int k = 0; k <= 20000; ++k) {
      const double t = k / 20000.0;
      const double s = 1 - t;
      const double w[4] = {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
      Vec c(0);
      for (int j = 0; j < 4; ++j) c += w[j] * Vec(v[3 * j], v[3 * j + 1], v[3 * j + 2]);
      core.push_back(c);
      box.add(c);
    }
    for (int i = 0; i < 400; ++i) {
      const Vec p = i < 150 ? Vec(unit(random), unit(random), unit(random))
                            : Vec(random() % 25, random() % 25, random() % 9) / 8.0 - 1.5;
      double nearest = 1e9;
      for (const Vec& c : core) nearest = std::fmin(nearest, norm(p - c));
      ASSERT_NEAR(f(glm::vec3(p)), nearest - 0.1, 2e-6) << p.x << " " << p.y << " " << p.z;
    }
    for (int axis = 0; axis < 3; ++axis) {  // no larger than it must be
      ASSERT_NEAR(f.bounds().lo[axis], box.lo[axis] - 0.1, 1e-6);
      ASSERT_NEAR(f.bounds().hi[axis], box.hi[axis] + 0.1, 1e-6);
    }
  }
}

// How far the solid goes along an axis: a place of its surface, and from there further as long as
// there is some.
double farthest_along(const Inside& inside, const std::vector<Vec>& surface, int axis,
                      double side) {
  std::mt19937 random(49);
  Vec best = surface[0];
  for (const Vec& p : surface) {
    if (side * p[axis] > side * best[axis]) best = p;
  }
  for (double step = 0.1; step > 1e-6; step *= 0.99) {
    Vec q = best + step * random_direction(random);
    q[axis] = best[axis] + side * step * 0.01;
    if (inside(q)) best = q;
  }
  return best[axis];
}

// The boxes of curves are no larger than they must be; nor are those of blobs, but where several
// are as far along an axis and beside each other.
TEST(ExactOps, BoxesOfCurvesAndBlobsAreTight) {
  const std::pair<const char*, double> solids[] = {
      {"bezier: {points: [[-1, -0.5, 0], [0, 1.5, 0.5], [1, -0.5, 0]], radius: 0.2}", 1e-3},
      {"bezier: {points: [[-1, -0.5, 0], [2, 1.5, 0.5], [1, -0.2, 1]], radius: 0.1}", 1e-3},
      {"metaballs: {points: [[-0.5, 0, 0], [0.5, 0, 0], [0.2, 0, 0]], threshold: 0.4}", 0.11},
      {"metaballs: {points: [[0, 0.3, 0]], falloff: gaussian, threshold: 0.7}", 1e-3}};
  for (const auto& [text, loose] : solids) {
    SCOPED_TRACE(text);
    const ExampleNode node = read_node(text);
    const sdfgrid::Box bounds = make_field(node).bounds();
    const Inside inside = solid_of(node);
    const std::vector<Vec> surface = surface_points(inside, bounds);
    for (int axis = 0; axis < 3; ++axis) {
      const double hi = farthest_along(inside, surface, axis, 1);
      const double lo = farthest_along(inside, surface, axis, -1);
      EXPECT_TRUE(hi <= bounds.hi[axis] && hi > bounds.hi[axis] - loose) << hi;
      EXPECT_TRUE(lo >= bounds.lo[axis] && lo < bounds.lo[axis] + loose) << lo;
    }
  }
  const Field none = make_field(read_node("metaballs: {points: [[0, 0, 0]], threshold: 2}"));
  EXPECT_TRUE(none.bounds().empty());
}

// The corners of Platonic and uniform truncated solids, from their coordinates in books: as many as
// books say, all on the surface of the solid with flat faces as near as theirs, and nothing farther
// out is.
TEST(ExactOps, SolidsHaveTheirCorners) {
  const double g = 0.5 * (1 + std::sqrt(5.0));
  const double root = std::sqrt(3.0);
  struct Case {
    const char* solid;
    std::size_t count;
    double nearest;  // face
  };
  const Case cases[] = {
      {"tetrahedron", 4, 1 / root},
      {"cube", 8, 1},
      {"octahedron", 6, 1 / root},
      {"dodecahedron", 20, (1 + g) / std::hypot(1, g)},
      {"icosahedron", 12, (1 + g) / root},
      {"truncated_tetrahedron", 12, root},
      {"truncated_cube", 24, 1},
      {"truncated_octahedron", 24, root},
      {"truncated_dodecahedron", 60, std::sqrt(0.5 * (25 + 11 * std::sqrt(5.0))) / g},
      {"truncated_icosahedron", 60, std::sqrt(1.5 * (7 + 3 * std::sqrt(5.0)))}};
  for (const auto& [solid, count, nearest] : cases) {
    SCOPED_TRACE(solid);
    const std::vector<Vec> corners = solid_corners(solid);
    EXPECT_EQ(corners.size(), count);
    const double largest = norm(corners[0]);
    const Field f =
        sdfgrid::make_field("gdf", {{"solid", solid}, {"exponent", 1e6}, {"radius", nearest}});
    std::mt19937 random(30);
    for (const Vec& c : corners) EXPECT_NEAR(f(glm::vec3(c)), 0, 2e-6 * largest);
    for (int i = 0; i < 5000; ++i) {
      EXPECT_GT(f(glm::vec3(random_direction(random) * largest * 1.0001)), 0);
    }
  }
}

// Thin ellipsoids, and points on their axes and planes, where the formula is nearly 0 / 0.
TEST(ExactOps, ThinEllipsoids) {
  std::mt19937 random(24);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const Vec& radii : {Vec(1, 1, 0.01), Vec(1, 0.02, 0.01), Vec(2, 2, 2), Vec(1, 1.0001, 1)}) {
    const Field f = sdfgrid::make_field("ellipsoid", {{"radii", {radii.x, radii.y, radii.z}}});
    EXPECT_NEAR(f(glm::vec3(0)), -std::fmin(radii.x, std::fmin(radii.y, radii.z)), 1e-6);
    for (int i = 0; i < 400; ++i) {
      Vec p(1.5 * unit(random), 1.5 * unit(random), 1.5 * unit(random));
      for (int a = 0; a < 3; ++a) {
        if (random() % 4 == 0) p[a] = 0;
      }
      const double r = std::fabs(f(glm::vec3(p)));
      const auto inside = [&](const Vec& q) {
        return sq(q.x / radii.x) + sq(q.y / radii.y) + sq(q.z / radii.z) < 1;
      };
      for (int k = 0; k < 100; ++k) {
        const Vec q = p + random_direction(random) * (r * (1 - 1e-5) - 3e-6);
        ASSERT_EQ(inside(q), inside(p)) << p.x << " " << p.y << " " << p.z;
      }
      const auto at = f.gradient(p);
      if (norm(at.gradient) < 0.999 || r < 1e-5) continue;
      const Vec towards = (at.value < 0 ? 1.0 : -1.0) * at.gradient / norm(at.gradient);
      // The foot point lies on the surface: |grad of the quadric| there turns distance to value.
      const Vec q = p + towards * r;
      const double value = sq(q.x / radii.x) + sq(q.y / radii.y) + sq(q.z / radii.z) - 1;
      const double slope = 2 * norm(q / (radii * radii));
      ASSERT_NEAR(value / slope, 0, 2e-5) << p.x << " " << p.y << " " << p.z;
    }
  }
}

// A repetition of a content that is not symmetric, against the nearest of many copies.
TEST(Folds, RepetitionOfAnAsymmetricSolid) {
  const Field one = sdfgrid::make_field("translate", {{"by", {0.6, 0.2, 0}}},
                                        {sdfgrid::make_field("sphere", {{"radius", 0.3}})});
  const Field f = sdfgrid::make_field("repeat", {{"cell", {2, 2, 0}}}, {one});
  std::mt19937 random(28);
  std::uniform_real_distribution<double> unit(-4, 4);
  double best = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec p(unit(random), unit(random), 0.2 * unit(random));
    double nearest = 1e9;
    for (int x = -4; x <= 4; ++x) {
      for (int y = -4; y <= 4; ++y) {
        nearest = std::fmin(nearest, norm(p - Vec(0.6 + 2 * x, 0.2 + 2 * y, 0)) - 0.3);
      }
    }
    const double d = f(glm::vec3(p));
    ASSERT_LE(d, nearest + 2e-6);
    ASSERT_EQ(d < 0, nearest < 0);
    best = std::fmax(best, d / nearest);
  }
  EXPECT_GT(best, 0.99);
}

}  // namespace
