// Estimates of sets of orbits: what they promise beside the right sign.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "field/brute_force.h"

namespace {

using sdfgrid::Box;
using sdfgrid::Field;

// Outside the value is at most the distance to the solid as it is drawn; half of the points are
// near its surface. What the largest ratio of both is; 0 of dust that no lattice meets.
double largest_ratio_outside(const std::string& text) {
  SCOPED_TRACE(text);
  const ExampleNode node = read_node(text);
  const Field f = make_field(node);
  const Inside inside = solid_of(node);
  const std::vector<Vec> surface = surface_points(inside, f.bounds());
  if (surface.empty()) return 0;
  std::mt19937 random(45);
  const Box box = example_box(f);
  double largest = 0;
  for (int i = 0; i < 400; ++i) {
    const Vec& foot = surface[random() % surface.size()];
    const Vec p = i % 2 == 0 ? foot + random_direction(random) * 0.02 : random_point(box, random);
    const double value = f(glm::vec3(p));
    const double d = nearest_found(inside, surface, p, random);
    constexpr double kFar = 1e-3;  // as against what single precision leaves of orbits
    if (value < 0 || d < kFar) continue;
    EXPECT_LE(value, d * (1 + 1e-4)) << p.x << " " << p.y << " " << p.z;
    largest = std::fmax(largest, value / d);
  }
  return largest;
}

TEST(Fractals, MandelbrotSetsAreNoNearerThanTheValue) {
  for (const int iterations : {1, 2, 3, 5, 8, 12, 20, 40}) {
    EXPECT_GT(largest_ratio_outside(fmt::format("mandelbrot: {{iterations: {}}}", iterations)),
              0.6);
  }
}

TEST(Fractals, MandelbulbsOfWholePowersAreNoNearerThanTheValue) {
  for (const int power : {2, 5, 8, 16}) {
    for (const int iterations : {1, 4, 9}) {
      const auto text = fmt::format("mandelbulb: {{power: {}, iterations: {}}}", power, iterations);
      EXPECT_GT(largest_ratio_outside(text), 0.6) << text;
    }
  }
}

// Those are bounds by proof; the list's example is one of many: dust, and constants above 2.
TEST(Fractals, JuliaSetsAreNoNearerThanTheValue) {
  std::mt19937 random(46);
  std::uniform_real_distribution<double> unit(-1, 1);
  int met = 0;
  for (const int iterations : {1, 2, 4, 9, 16}) {
    for (int set = 0; set < 5; ++set) {
      const double size = set < 3 ? 0.6 : 1.6;
      const auto part = [&] { return size * unit(random); };
      const double ratio = largest_ratio_outside(
          fmt::format("julia: {{iterations: {}, c: [{:.2f}, {:.2f}, {:.2f}], w: {:.2f}}}",
                      iterations, part(), part(), part(), part()));
      met += ratio > 0.3 ? 1 : 0;
    }
  }
  EXPECT_GT(met, 15);
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

}  // namespace
