// Exact ops against descriptions of their solids that share nothing with the formulas: membership
// by the solid's definition, or dense points of its core.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <random>

#include "field/examples.h"

namespace {

using sdfgrid::Box;
using sdfgrid::Field;
using Vec = glm::dvec3;

double norm(const Vec& v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }
double sq(double v) { return v * v; }

// Whether a point is in the solid of an op's example.
using Inside = std::function<bool(const Vec&)>;

const std::map<std::string, Inside>& solids() {
  static const std::map<std::string, Inside> all = {
      {"sphere", [](const Vec& p) { return sq(p.x) + sq(p.y) + sq(p.z) < 1; }},
      {"box",
       [](const Vec& p) {
         return std::fabs(p.x) < 1 && std::fabs(p.y) < 0.7 && std::fabs(p.z) < 0.5;
       }},
      {"plane", [](const Vec& p) { return p.z < 0; }},
      {"torus", [](const Vec& p) { return sq(std::hypot(p.x, p.y) - 1) + sq(p.z) < 0.3 * 0.3; }},
      {"cylinder", [](const Vec& p) { return std::hypot(p.x, p.y) < 0.8 && std::fabs(p.z) < 0.8; }},
      {"infinite_cylinder", [](const Vec& p) { return std::hypot(p.x, p.y) < 0.5; }},
      {"cone",
       [](const Vec& p) { return p.z > -0.9 && std::hypot(p.x, p.y) < 0.9 * (0.9 - p.z) / 1.8; }},
      {"infinite_cone",
       [](const Vec& p) { return std::hypot(p.x, p.y) < -p.z * std::tan(M_PI / 6); }},
      {"lozenge",
       [](const Vec& p) {
         const double x = std::fmax(std::fabs(p.x) - 0.8, 0);
         const double y = std::fmax(std::fabs(p.y) - 0.5, 0);
         return sq(x) + sq(y) + sq(p.z) < 0.2 * 0.2;
       }},
      {"ellipsoid", [](const Vec& p) { return sq(p.x / 1.2) + sq(p.y / 0.8) + sq(p.z / 0.5) < 1; }},
      {"ellipsoid_bound",
       [](const Vec& p) { return sq(p.x / 1.2) + sq(p.y / 0.8) + sq(p.z / 0.5) < 1; }},
  };
  return all;
}

Vec random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal(0, 1);
  const Vec v(normal(random), normal(random), normal(random));
  return v / norm(v);
}

// No point of the open ball around p with radius |f(p)| is on the other side; for exact ops one
// just beyond the ball, where the gradient points, is.
TEST(ExactOps, BallsAroundPointsTouchTheSolid) {
  for (const auto& [name, inside] : solids()) {
    const Example* example = nullptr;
    for (const Example& e : examples()) {
      if (e.op->info->name == name && example == nullptr) example = &e;
    }
    ASSERT_NE(example, nullptr) << name;
    const bool exact = example->op->info->guarantee == sdfgrid::OpGuarantee::exact;
    const Box box = example_box(example->field);
    std::mt19937 random(21);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < 1500; ++i) {
      const Vec p = box.lo + Vec(unit(random), unit(random), unit(random)) * box.size();
      const auto at = example->field.gradient(p);
      const double r = std::fabs(example->field(glm::vec3(p)));
      ASSERT_TRUE(inside(p) == (at.value < 0) || r < 1e-6) << name;
      const double sign = at.value < 0 ? 1 : -1;
      const Vec towards = sign * at.gradient;
      for (int k = 0; k < 60; ++k) {
        const Vec u = random_direction(random);
        const Vec near = towards + 0.3 * u;
        const Vec q = p + (k % 2 == 0 ? u : near / norm(near)) * (r * (1 - 1e-5) - 2e-6);
        ASSERT_EQ(inside(q), inside(p)) << name << " overestimates";
      }
      if (!exact || norm(at.gradient) < 0.999) continue;
      // Around the foot point both sides are found: behind a sharp apex the ray is outside again.
      const Vec foot = p + towards * r;
      bool other = false;
      for (int k = 0; k < 200 && !other; ++k) {
        other = inside(foot + random_direction(random) * 1e-5) != inside(p);
      }
      ASSERT_TRUE(other) << name << " falls short";
    }
  }
}

// The distance to the nearest of many points of a solid's core, less the radius.
void expect_distance_to_core(const std::string& name, const std::vector<Vec>& core, double radius,
                             double spacing) {
  for (const Example& e : examples()) {
    if (e.op->info->name != name) continue;
    std::mt19937 random(22);
    std::uniform_real_distribution<double> unit(0, 1);
    const Box box = example_box(e.field);
    for (int i = 0; i < 300; ++i) {
      const Vec p = box.lo + Vec(unit(random), unit(random), unit(random)) * box.size();
      double nearest = 1e9;
      for (const Vec& c : core) nearest = std::fmin(nearest, norm(p - c));
      const double d = e.field(glm::vec3(p));
      ASSERT_LE(d, nearest - radius + 3e-6) << name;
      // Between two points of the core, `spacing` apart, it may be nearer by this.
      const double slack = std::fmin(0.5 * spacing, sq(spacing) / std::fmax(nearest, 1e-9));
      ASSERT_GE(d, nearest - radius - slack - 3e-6) << name;
    }
    return;
  }
  FAIL() << name;
}

TEST(ExactOps, DistanceToACore) {
  std::vector<Vec> segment;
  std::vector<Vec> curve;
  const Vec a(-1, -0.5, 0);
  const Vec b(0, 1.5, 0.5);
  const Vec c(1, -0.5, 0);
  for (int i = 0; i <= 4000; ++i) {
    const double t = i / 4000.0;
    segment.emplace_back(-0.7 + 1.4 * t, 0, 0.4 * t);
    curve.push_back((1 - t) * (1 - t) * a + 2 * t * (1 - t) * b + t * t * c);
  }
  expect_distance_to_core("capsule", segment, 0.4, 5e-4);
  expect_distance_to_core("bezier", curve, 0.2, 2e-3);
  std::vector<Vec> triangle;
  for (int i = 0; i <= 150; ++i) {
    for (int j = 0; i + j <= 150; ++j) {
      const double u = i / 150.0;
      const double v = j / 150.0;
      triangle.push_back(Vec(-1, -0.5, 0) * (1 - u - v) + Vec(1, -0.5, 0.2) * u +
                         Vec(0, 0.9, 0) * v);
    }
  }
  expect_distance_to_core("triangle", triangle, 0.1, 0.02);
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

// Graphs of constant, linear and quadratic functions against dense points of their border.
TEST(ExactOps, GraphsOfConstantLinearAndQuadraticFunctions) {
  struct Case {
    const char* f;
    double c[3];
  };
  const Case cases[] = {{"0.6", {0.6, 0, 0}},
                        {"0.7 - 0.3*x", {0.7, -0.3, 0}},
                        {"0.2 + 0.5*x^2", {0.2, 0, 0.5}},
                        {"1 + 0.3*x - x*x/2", {1, 0.3, -0.5}}};
  for (const Case& each : cases) {
    const auto f = [&](double x) { return each.c[0] + x * (each.c[1] + x * each.c[2]); };
    for (const char* mode : {"revolve_z", "revolve_x", "extrude"}) {
      SCOPED_TRACE(std::string(each.f) + " " + mode);
      const double from = -0.9;
      const double to = 1.1;
      const Field field = sdfgrid::make_field("function", {{"f", each.f},
                                                           {"mode", mode},
                                                           {"from", from},
                                                           {"to", to},
                                                           {"floor", -0.4},
                                                           {"depth", 0.8}});
      EXPECT_EQ(field.size(), 1U);  // no region around it: a closed form
      const bool extruded = std::string(mode) == "extrude";
      std::vector<std::array<double, 2>> border;
      const double low = extruded ? -0.4 : 0;
      constexpr int kMany = 2000;
      for (int i = 0; i <= kMany; ++i) {
        const double t = static_cast<double>(i) / kMany;
        const double u = from + (to - from) * t;
        border.push_back({u, f(u)});
        border.push_back({from, low + (f(from) - low) * t});
        border.push_back({to, low + (f(to) - low) * t});
        if (extruded) border.push_back({u, low});
      }
      std::mt19937 random(29);
      std::uniform_real_distribution<double> unit(-2, 2);
      for (int k = 0; k < 250; ++k) {
        const Vec p(unit(random), unit(random), unit(random));
        const bool z = std::string(mode) == "revolve_z";
        const double u = z ? p.z : p.x;
        const double r = extruded ? p.y : (z ? std::hypot(p.x, p.y) : std::hypot(p.y, p.z));
        double flat = 1e9;
        for (const auto& b : border) flat = std::fmin(flat, std::hypot(b[0] - u, b[1] - r));
        if (u > from && u < to && r < f(u) && r > (extruded ? low : -1)) flat = -flat;
        double expected = flat;
        if (extruded) {
          const double h = std::fabs(p.z) - 0.4;
          expected =
              std::hypot(std::fmax(flat, 0), std::fmax(h, 0)) + std::fmin(std::fmax(flat, h), 0);
        }
        // The border's points are at most 1.9e-3 apart: an eighth of that squared over the
        // distance.
        const double slack = 4e-6 + std::fmin(1e-3, 4.6e-7 / std::fmax(std::fabs(flat), 1e-9));
        ASSERT_NEAR(field(glm::vec3(p)), expected, slack) << p.x << " " << p.y << " " << p.z;
      }
    }
  }
}

// The corners of the uniform truncated solids, from their coordinates in books: all on the surface
// of the solid with flat faces, at the same distance from the centre, and nothing farther out is.
TEST(ExactOps, TruncatedSolidsHaveTheirCorners) {
  const double g = 0.5 * (1 + std::sqrt(5.0));
  const double s = std::sqrt(2.0) - 1;
  struct Case {
    const char* solid;
    std::vector<Vec> corners;  // with even permutations and all signs
    double nearest;            // face
    std::size_t count;
  };
  const Case cases[] = {{"truncated_cube", {Vec(1, 1, s)}, 1, 24},
                        {"truncated_octahedron", {Vec(0, 1, 2), Vec(0, 2, 1)}, std::sqrt(3.0), 24},
                        {"truncated_dodecahedron",
                         {Vec(0, 2 + g, 1 / g), Vec(1 / g, 2 * g, g), Vec(g, g + 1, 2)},
                         std::sqrt(0.5 * (25 + 11 * std::sqrt(5.0))) / g,
                         60},
                        {"truncated_icosahedron",
                         {Vec(0, 1, 3 * g), Vec(1, 2 + g, 2 * g), Vec(g, 2, 2 * g + 1)},
                         std::sqrt(1.5 * (7 + 3 * std::sqrt(5.0))),
                         60}};
  for (const Case& each : cases) {
    SCOPED_TRACE(each.solid);
    std::vector<Vec> corners;
    double largest = 0;
    for (const Vec& c : each.corners) {
      for (int k = 0; k < 24; ++k) {
        Vec p(c[k % 3], c[(k + 1) % 3], c[(k + 2) % 3]);
        for (int a = 0; a < 3; ++a) p[a] *= (k / 3 >> a & 1) != 0 ? -1 : 1;
        const bool known = std::any_of(corners.begin(), corners.end(),
                                       [&](const Vec& q) { return norm(q - p) < 1e-9; });
        if (!known) corners.push_back(p);
        largest = std::fmax(largest, norm(p));
      }
    }
    EXPECT_EQ(corners.size(), each.count);
    const Field f = sdfgrid::make_field(
        "gdf", {{"solid", each.solid}, {"exponent", 1e6}, {"radius", each.nearest}});
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

// Whether the orbit of 0 under z^2 + c stays, for 400 iterations.
bool in_mandelbrot(double re, double im) {
  double x = 0;
  double y = 0;
  for (int i = 0; i < 400 && x * x + y * y < 1e3; ++i) {
    const double next = x * x - y * y + re;
    y = 2 * x * y + im;
    x = next;
  }
  return x * x + y * y < 1e3;
}

// The true distance at c = -2.5 is 0.5; without the + 1 in the derivative's recurrence, or with
// twice the bound, the value is larger than that.
TEST(Fractals, MandelbrotIsNoLargerThanTheDistance) {
  const Field f = sdfgrid::make_field("mandelbrot", {{"iterations", 30}});
  EXPECT_NEAR(f(glm::vec3(-2.5F, 0, 0)), 0.478, 2e-3);
  EXPECT_LT(f(glm::vec3(-0.1F, 0.1F, 0)), 0);
  std::mt19937 random(25);
  std::uniform_real_distribution<double> unit(-2.2, 2.2);
  int outside = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec p(unit(random), unit(random), unit(random));
    const double r = f(glm::vec3(p));
    if (r <= 0) continue;
    ++outside;
    for (int k = 0; k < 20; ++k) {
      const Vec q = p + random_direction(random) * r * 0.999;
      ASSERT_FALSE(in_mandelbrot(q.x, std::hypot(q.y, q.z)));
    }
  }
  EXPECT_GT(outside, 3000);
}

// Beyond the box of a level the estimates of sets of orbits are above it, near and far: grids of
// them end somewhere.
TEST(Fractals, EstimatesGrowWithTheDistance) {
  std::mt19937 random(32);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const char* name : {"julia", "mandelbrot", "mandelbulb"}) {
    for (int set = 0; set < 12; ++set) {
      std::vector<sdfgrid::Argument> arguments = {{"iterations", static_cast<double>(1 + 2 * set)}};
      if (name == std::string("julia")) {
        arguments.emplace_back("c", std::vector<double>{unit(random), unit(random), unit(random)});
        arguments.emplace_back("w", unit(random));
      }
      if (name == std::string("mandelbulb")) arguments.emplace_back("power", 2.0 + set);
      const Field f = sdfgrid::make_field(name, arguments);
      for (const double level : {0.003, 0.05, 0.4, 3.0}) {
        const Box box = f.bounds(level);
        for (int i = 0; i < 1000; ++i) {
          const double far = std::pow(10.0, 1 + unit(random)) * box.hi.x;
          const Vec p = random_direction(random) * far;
          const double most = std::fmax(std::fabs(p.x), std::fmax(std::fabs(p.y), std::fabs(p.z)));
          if (most <= box.hi.x) continue;
          ASSERT_GE(f(glm::vec3(p)), level) << name << " " << norm(p);
        }
      }
    }
  }
}

// A Menger sponge of one generation is a cube less three square bars.
TEST(Fractals, MengerHoldsWhatItShould) {
  const Field f = sdfgrid::make_field("menger", {{"iterations", 2}, {"size", 2}});
  std::mt19937 random(26);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 20000; ++i) {
    const Vec p(unit(random), unit(random), unit(random));
    bool inside = true;
    Vec q = (p + Vec(1)) * 0.5;  // the unit cube
    for (int generation = 0; generation < 2; ++generation) {
      int middle = 0;
      for (int a = 0; a < 3; ++a) {
        q[a] *= 3;
        const double digit = std::fmin(std::floor(q[a]), 2);
        middle += digit == 1 ? 1 : 0;
        q[a] -= digit;
      }
      inside = inside && middle < 2;
    }
    const double d = f(glm::vec3(p));
    ASSERT_TRUE((d < 0) == inside || std::fabs(d) < 1e-6);
  }
}

// The corners of every generation of Sierpinski's tetrahedron are in it, its middle is not.
TEST(Fractals, SierpinskiHoldsItsCorners) {
  const Field f = sdfgrid::make_field("sierpinski", {{"iterations", 6}, {"size", 2}});
  const Vec corners[] = {Vec(1, 1, 1), Vec(1, -1, -1), Vec(-1, 1, -1), Vec(-1, -1, 1)};
  std::mt19937 random(27);
  for (int i = 0; i < 2000; ++i) {
    Vec p(0.3, 0.2, 0.1);
    for (int k = 0; k < 60; ++k) p = 0.5 * (p + corners[random() % 4]);
    ASSERT_LE(f(glm::vec3(p)), 1e-6);
  }
  EXPECT_GT(f(glm::vec3(0)), 0.1F);
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
