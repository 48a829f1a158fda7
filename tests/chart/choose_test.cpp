// The choice made by measuring: on the front of what was measured, and no finer than needed.
#include "sdfgrid/grid/choose.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "chart/shapes.h"
#include "sdfgrid/core/error.h"

namespace sdfgrid {
namespace {

using namespace testing;

double measured_error(const TriangleSoup& soup, int dim, std::size_t samples) {
  ConvertOptions convert;
  convert.dim = dim;
  const Grid grid = convert_mesh(soup, convert, Job()).grid;
  // Other places than those that the choice was made at.
  return survey(grid, SurfaceTruth(soup, Job()), {.samples = samples, .seed = 99}, Job())
      .between.max_error;
}

TEST(Choose, OneStepCoarserMissesAndTheChoiceIsOnTheFront) {
  const TriangleSoup soup = ball(40);
  ChooseOptions options;
  options.tolerance = 0.002;
  options.compare.samples = 20000;
  const Choice choice = choose_conversion(soup, {}, options, Job());
  ASSERT_TRUE(choice.within) << choice.why_not;
  EXPECT_LE(choice.chosen.error, options.tolerance);
  const auto& dims = choice_dims();
  const auto at = std::find(dims.begin(), dims.end(), choice.chosen.dim);
  ASSERT_TRUE(at != dims.begin() && at != dims.end());
  EXPECT_GT(measured_error(soup, *(at - 1), 20000), options.tolerance);
  EXPECT_LT(measured_error(soup, *at, 20000), 1.1 * options.tolerance);
  // Nothing that was tried is within the tolerance with larger voxels, or as large ones and much
  // less time.
  for (const Trial& trial : choice.trials) {
    if (trial.error > options.tolerance) continue;
    EXPECT_GE(trial.dim, choice.chosen.dim);
    EXPECT_GE(trial.seconds, 0.8 * choice.chosen.seconds);
  }
  // And no trial beats it in both voxel size and error.
  for (const Trial& trial : choice.trials) {
    EXPECT_FALSE(trial.voxel > choice.chosen.voxel && trial.error <= choice.chosen.error);
  }
}

TEST(Choose, TighterTolerancesTakeFinerVoxels) {
  const TriangleSoup soup = box({1, 0.7F, 0.4F});
  int before = 0;
  for (const double tolerance : {0.05, 0.02, 0.005}) {
    ChooseOptions options;
    options.tolerance = tolerance;
    options.compare.samples = 5000;
    const Choice choice = choose_conversion(soup, {}, options, Job());
    ASSERT_TRUE(choice.within);
    EXPECT_GT(choice.chosen.dim, before);
    before = choice.chosen.dim;
  }
}

TEST(Choose, BudgetsEndTheSearchWithTheBestSoFar) {
  const TriangleSoup soup = ball(30);
  ChooseOptions options;
  options.tolerance = 1e-7;
  options.compare.samples = 2000;
  options.budget_bytes = 60e6;
  const Choice small = choose_conversion(soup, {}, options, Job());
  EXPECT_FALSE(small.within);
  EXPECT_NE(small.why_not.find("MB"), std::string::npos) << small.why_not;
  ASSERT_FALSE(small.trials.empty());
  for (const Trial& trial : small.trials) EXPECT_GE(trial.error, small.chosen.error);
  EXPECT_EQ(small.conversion.grid.lattice().voxel, small.chosen.voxel);

  options.budget_bytes = 0;
  options.budget_seconds = 0.3;
  const Choice quick = choose_conversion(soup, {}, options, Job());
  EXPECT_FALSE(quick.within);
  EXPECT_NE(quick.why_not.find(" s"), std::string::npos) << quick.why_not;

  options.budget_seconds = 0;
  options.budget_bytes = 1000;
  EXPECT_THROW((void)choose_conversion(soup, {}, options, Job()), Error);
}

TEST(Choose, NonsenseIsUsage) {
  const TriangleSoup soup = box({1, 1, 1});
  EXPECT_THROW((void)choose_conversion(soup, {}, {}, Job()), Error);
  ChooseOptions options;
  options.tolerance = 1;
  options.methods = {"magic"};
  EXPECT_THROW((void)choose_conversion(soup, {}, options, Job()), Error);
}

}  // namespace
}  // namespace sdfgrid
