// Errors by parts of the field: the right samples in the right part, the same errors as compare().
#include "sdfgrid/grid/survey.h"

#include <gtest/gtest.h>

#include "chart/shapes.h"
#include "sdfgrid/grid/convert.h"

namespace sdfgrid {
namespace {

using namespace testing;

Grid converted(const TriangleSoup& soup, double voxel, double width) {
  ConvertOptions options;
  options.voxel = voxel;
  options.band = {width, width};
  return convert_mesh(soup, options, Job()).grid;
}

TEST(Survey, AThinPlateHasEdgesAndAMedialPlane) {
  // Ten voxels thick: the middle plane is the medial axis, far from the rim.
  const TriangleSoup plate = box({6, 6, 1});
  const Grid grid = converted(plate, 0.1, 8);
  const Survey measured = survey(grid, SurfaceTruth(plate, Job()), {.samples = 20000}, Job());
  std::size_t all = 0;
  for (const ErrorSummary& part : measured.parts) all += part.samples;
  EXPECT_EQ(all, measured.voxels.samples);
  const auto share = [&](FieldPart part) {
    return static_cast<double>(measured.parts[static_cast<std::size_t>(part)].samples) /
           static_cast<double>(all);
  };
  // Two layers of samples beside the plane, of about 26 in the band.
  EXPECT_NEAR(share(FieldPart::medial), 2.0 / 26, 0.05);
  EXPECT_GT(share(FieldPart::edge), 0.05);
  EXPECT_GT(share(FieldPart::smooth), 0.5);
  EXPECT_LT(measured.voxels.max_error, 1e-5 * 0.1);
  EXPECT_EQ(measured.voxels.sign_errors, 0U);
}

TEST(Survey, ABallIsSmoothAllOver) {
  const TriangleSoup sphere = ball(60);
  const Grid grid = converted(sphere, 0.05, 4);
  const Survey measured = survey(grid, SurfaceTruth(sphere, Job()), {.samples = 5000}, Job());
  EXPECT_EQ(measured.parts[static_cast<std::size_t>(FieldPart::edge)].samples, 0U);
  EXPECT_EQ(measured.parts[static_cast<std::size_t>(FieldPart::medial)].samples, 0U);
  const Comparison compared = compare(grid, sphere, {.samples = 5000}, Job());
  EXPECT_EQ(measured.between.max_error, compared.interpolated.max_error);
  EXPECT_EQ(measured.between.rms_error, compared.interpolated.rms_error);
  EXPECT_EQ(measured.voxels.max_error, compared.voxels.max_error);
}

}  // namespace
}  // namespace sdfgrid
