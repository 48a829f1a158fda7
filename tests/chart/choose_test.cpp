// The choice made by measuring: on the front of what was measured, and no finer than needed.
#include "sdfgrid/grid/choose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "chart/shapes.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/methods.h"

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
  const Choice choice = choose_conversion(soup, ConvertOptions(), options, Job());
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
    const Choice choice = choose_conversion(soup, ConvertOptions(), options, Job());
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
  const Choice small = choose_conversion(soup, ConvertOptions(), options, Job());
  EXPECT_FALSE(small.within);
  EXPECT_NE(small.why_not.find("MB"), std::string::npos) << small.why_not;
  ASSERT_FALSE(small.trials.empty());
  for (const Trial& trial : small.trials) EXPECT_GE(trial.error, small.chosen.error);
  EXPECT_EQ(small.conversion.grid.lattice().voxel, small.chosen.voxel);

  // So does the memory that any conversion may take.
  options.budget_bytes = 0;
  ConvertOptions convert;
  convert.max_memory = 60'000'000;
  const Choice bounded = choose_conversion(soup, convert, options, Job());
  EXPECT_FALSE(bounded.within);
  EXPECT_EQ(bounded.chosen.dim, small.chosen.dim);

  options.budget_seconds = 0.3;
  const Choice quick = choose_conversion(soup, ConvertOptions(), options, Job());
  EXPECT_FALSE(quick.within);
  EXPECT_NE(quick.why_not.find(" s"), std::string::npos) << quick.why_not;

  options.budget_seconds = 0;
  options.budget_bytes = 1000;
  EXPECT_THROW((void)choose_conversion(soup, ConvertOptions(), options, Job()), Error);
}

// Every method of the list converts, and errors are what its name says: none is left out of chart
// and choice.
TEST(Methods, AllConvertABallAndCanBeChosen) {
  const TriangleSoup soup = ball(20);
  const SurfaceTruth truth(soup, Job());
  ConvertOptions convert;
  convert.dim = 24;
  convert.transform.emplace().steps = {{{1, 0, 0}, 1.0}, {{1, 1, 0}, 1.41}, {{1, 1, 1}, 1.73}};
  const auto all = select_methods({}, convert, true);
  ASSERT_EQ(all.size(), convert_methods().size());
  EXPECT_EQ(all.front().name, "exact");
  for (const ConvertMethod& method : all) {
    const Grid grid = method.convert(soup, convert, Job()).grid;
    const Survey measured = survey(grid, truth, {.samples = 3000}, Job());
    EXPECT_LT(measured.voxels.max_error, 1.2 * measured.voxel) << method.name;
    EXPECT_EQ(measured.voxels.sign_errors, 0U) << method.name;
    if (method.name == "exact") {
      EXPECT_LT(measured.voxels.max_error, 1e-5 * measured.voxel);
    }
    ChooseOptions options;
    options.tolerance = 0.1;
    options.methods = {method.name};
    options.compare.samples = 2000;
    const Choice choice = choose_conversion(soup, convert, options, Job());
    EXPECT_EQ(choice.chosen.method, method.name);
    EXPECT_TRUE(choice.within) << method.name;
  }
}

TEST(Methods, TheListOfTransformsIsAmongThem) {
  for (const TransformMethodInfo& info : transform_methods()) {
    EXPECT_EQ(find_convert_method(info.name) != nullptr, info.meshes) << info.name;
  }
  EXPECT_EQ(find_convert_method("magic"), nullptr);
  EXPECT_THROW((void)select_methods({"chamfer"}, {}, false), Error) << "without a mask";
  for (const ConvertMethod& method : select_methods({}, {}, false)) {
    EXPECT_FALSE(method.peer || method.needs_steps) << method.name;
  }
}

// Bands that a method cannot do end its part in the search, not the search.
TEST(Choose, LeavesOutWhatCannotDoTheBand) {
  ConvertOptions convert;
  convert.band = {30, 30};
  ChooseOptions options;
  options.tolerance = 0.2;
  options.compare.samples = 1000;
  options.methods = {"exact", "meijster", "feature"};
  const Choice choice = choose_conversion(box({1, 1, 1}), convert, options, Job());
  EXPECT_TRUE(choice.within);
  EXPECT_EQ(choice.chosen.method, "exact");
}

// A scene is measured against itself; one step coarser missed.
TEST(Choose, FieldsAreReadWithinTheTolerance) {
  const Field field = make_field(
      "difference", {},
      {make_field("box", {{"size", {2.0, 2.0, 2.0}}}), make_field("sphere", {{"radius", 1.2}})});
  ChooseOptions options;
  options.tolerance = 0.02;
  options.compare.samples = 20000;
  const Choice choice = choose_conversion(field, FieldConvertOptions(), options, Job());
  ASSERT_TRUE(choice.within) << choice.why_not;
  EXPECT_EQ(choice.chosen.method, "field");
  ASSERT_GE(choice.trials.size(), 2U);
  EXPECT_GT(choice.trials[choice.trials.size() - 2].error, options.tolerance);
  // In the middle of every cell, where trilinear values are the mean of eight.
  const Grid& grid = choice.conversion.grid;
  glm::ivec3 lo;
  glm::ivec3 hi;
  grid.active_bounds(lo, hi);
  const double known = 0.999 * static_cast<double>(grid.background());
  double largest = 0;
  for (int x = lo.x; x < hi.x; ++x) {
    for (int y = lo.y; y < hi.y; ++y) {
      for (int z = lo.z; z < hi.z; ++z) {
        double mean = 0;
        double farthest = 0;
        for (int c = 0; c < 8; ++c) {
          const double v = grid.value({x + (c & 1), y + (c >> 1 & 1), z + (c >> 2)});
          farthest = std::max(farthest, std::abs(v));
          mean += v / 8;
        }
        if (farthest >= known) continue;
        const glm::dvec3 middle = grid.lattice().to_world(glm::dvec3(x, y, z) + 0.5);
        largest = std::max(largest, std::abs(mean - static_cast<double>(field(glm::vec3(middle)))));
      }
    }
  }
  EXPECT_LE(largest, 1.05 * options.tolerance);
  EXPECT_GT(largest, 0.2 * options.tolerance);
  options.methods = {"exact"};
  EXPECT_THROW((void)choose_conversion(field, FieldConvertOptions(), options, Job()), Error);
}

TEST(Choose, NonsenseIsUsage) {
  const TriangleSoup soup = box({1, 1, 1});
  EXPECT_THROW((void)choose_conversion(soup, ConvertOptions(), {}, Job()), Error);
  ChooseOptions options;
  options.tolerance = 1;
  options.methods = {"magic"};
  EXPECT_THROW((void)choose_conversion(soup, ConvertOptions(), options, Job()), Error);
}

}  // namespace
}  // namespace sdfgrid
