// Noise against its definition with whole numbers, cell by cell.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "field/brute_force.h"
#include "field/pairs.h"

namespace {

// Every reading has the same noise in every cell, also where a hash is one less than a multiple of
// 289, which a division in single precision rounds up.
TEST(Noise, IsThatOfWholeNumbersInEveryCell) {
  const sdfgrid::Field plane = sdfgrid::make_field("plane");
  const sdfgrid::Field f = sdfgrid::make_field(
      "noise_displace", {{"frequency", 1}, {"amplitude", 1}, {"seed", 7}}, {plane});
  const NoiseSum noise = {1, 1, 2, 1, 7};
  const double scale = f.gradient(Vec(0, 0, 1)).value;  // noise is 0 there
  std::mt19937 random(44);
  Points p = random_points(40000, {Vec(-50, -50, -3), Vec(50, 50, 3)}, random);
  p.evaluate(f);
  for (std::size_t i = 0; i < p.x.size(); ++i) {
    const Vec at = p.at(i);
    const double expected = (at.z - noise(at)) * scale;
    ASSERT_NEAR(p.value[i], expected, 1e-5) << at.x << " " << at.y << " " << at.z;
    ASSERT_NEAR(f.gradient(at).value, expected, 1e-5) << at.x << " " << at.y << " " << at.z;
  }
}

}  // namespace
