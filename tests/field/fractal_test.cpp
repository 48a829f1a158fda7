// Estimates of sets of orbits: what they promise, which is no bound of the solid that is drawn.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "field/brute_force.h"

namespace {

using sdfgrid::Box;
using sdfgrid::Field;

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

}  // namespace
