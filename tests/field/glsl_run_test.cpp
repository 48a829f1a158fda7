// The GLSL reading evaluated: every op's text on Mesa's software renderer against the batch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "field/examples.h"
#include "field/software_gl.h"
#include "sdfgrid/core/error.h"

namespace {

TEST(GlslRun, EveryOpHasTheValuesOfTheBatch) {
  std::string why;
  const auto gl = SoftwareGl::start(why);
  if (gl == nullptr) GTEST_SKIP() << why;
  RecordProperty("renderer", gl->name());
  int compared = 0;
  for (const Example& e : examples()) {
    SCOPED_TRACE(e.text);
    if (e.sampled) {
      EXPECT_THROW((void)e.field.glsl(), sdfgrid::Error);
      continue;
    }
    constexpr std::size_t kPoints = 64 * 16;
    std::mt19937 random(31);
    const sdfgrid::Box box = example_box(e.field);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<float> points;
    std::vector<float> expected;
    for (std::size_t i = 0; i < kPoints; ++i) {
      const glm::dvec3 t(unit(random), unit(random), unit(random));
      const glm::vec3 p(box.lo + t * box.size());
      points.insert(points.end(), {p.x, p.y, p.z});
      expected.push_back(e.field(p));
    }
    const std::vector<float> values = gl->run(e.field.glsl("shape"), "shape", points);
    double worst = 0;
    for (std::size_t i = 0; i < kPoints; ++i) {
      ASSERT_FALSE(std::isnan(values[i]));
      worst = std::fmax(worst, std::fabs(static_cast<double>(values[i]) - expected[i]));
    }
    // An escaping orbit multiplies what was rounded at each turn: 0.0014 measured (mandelbulb).
    const bool orbit = e.op->info->guarantee == sdfgrid::OpGuarantee::estimate;
    // What GLSL's functions are off is divided by the gradient, which is half as long as the bound
    // on it in the formulas here.
    const bool divided = e.estimate && !orbit;
    EXPECT_LT(worst, orbit ? 5e-3 : (divided ? 6e-6 : 3e-6));
    ++compared;
  }
  EXPECT_GT(compared, 60);
}

}  // namespace
