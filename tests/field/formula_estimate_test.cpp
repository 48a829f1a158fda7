// What orders 1 and 2 of formulas promise, which is no bound: the distance to first order beside a
// smooth surface, and of quadrics, whose second derivatives are the same everywhere, a bound.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "field/brute_force.h"

namespace {

using sdfgrid::Field;

const char* const kSmooth[] = {"x^2 + y^2 + z^2 - 0.7", "x^2/0.8 + y^2/0.5 + z^2/0.1 - 1",
                               "x^4 + y^4 + z^4 - x^2*y - 0.3", "exp(-x^2)*cos(2*y) - z - 0.4",
                               "(sqrt(x^2 + y^2) - 0.6)^2 + z^2 - 0.06"};

ExampleNode node_of(const std::string& f, const char* order) {
  return read_node(fmt::format(
      "formula: {{f: \"{}\", bounds: [[-1, -1, -1], [1, 1, 1]], order: {}}}", f, order));
}

// At a depth t beside a place of the surface the value is t (1 + c t): twice as near, half of the
// relative error.
TEST(FormulaEstimates, AreTheDistanceToFirstOrderBesideTheSurface) {
  for (const char* text : kSmooth) {
    const Field certified = make_field(node_of(text, "certified"));
    const sdfgrid::Box within{Vec(-0.9), Vec(0.9)};  // off the faces of the region
    const std::vector<Vec> surface = surface_points(solid_of(node_of(text, "certified")), within);
    ASSERT_GT(surface.size(), 200U) << text;
    for (const char* order : {"1", "2"}) {
      SCOPED_TRACE(fmt::format("{} order {}", text, order));
      const Field f = make_field(node_of(text, order));
      for (const Vec& s : surface) {
        const Vec gradient = certified.gradient(s).gradient;
        const Vec normal = gradient / norm(gradient);
        for (const double side : {-1.0, 1.0}) {
          const auto error = [&](double t) {
            return f.gradient(s + side * t * normal).value / (side * t) - 1;
          };
          ASSERT_NEAR(error(0.002), 0, 0.05) << s.x << " " << s.y << " " << s.z;
          ASSERT_NEAR(error(0.001), 0.5 * error(0.002), 0.003) << s.x << " " << s.y << " " << s.z;
        }
      }
    }
  }
}

TEST(FormulaEstimates, SecondOrderIsNeverMoreThanFirst) {
  std::mt19937 random(47);
  for (const char* text : kSmooth) {
    const Field first = make_field(node_of(text, "1"));
    const Field second = make_field(node_of(text, "2"));
    for (int i = 0; i < 3000; ++i) {
      const Vec p = random_point({Vec(-0.99), Vec(0.99)}, random);
      const double a = first.gradient(p).value;
      const double b = second.gradient(p).value;
      ASSERT_EQ(a < 0, b < 0) << text;
      ASSERT_LE(std::fabs(b), std::fabs(a) * (1 + 1e-9)) << text;
    }
  }
}

TEST(FormulaEstimates, SecondOrderOfQuadricsIsABound) {
  std::mt19937 random(48);
  for (const char* text : {kSmooth[0], kSmooth[1], "x*y - 2*z*x + 0.3*z - 0.1"}) {
    SCOPED_TRACE(text);
    const ExampleNode node = node_of(text, "2");
    const Field f = make_field(node);
    const Inside inside = solid_of(node);
    const std::vector<Vec> surface = surface_points(inside, f.bounds());
    for (int i = 0; i < 400; ++i) {
      const Vec p = random_point(f.bounds(), random);
      ASSERT_LE(std::fabs(f.gradient(p).value), nearest_found(inside, surface, p, random) + 1e-6);
    }
  }
}

}  // namespace
