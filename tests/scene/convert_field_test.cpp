// A field as a sparse grid against the field at every lattice point.
#include "sdfgrid/grid/convert_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/scene/build.h"

namespace sdfgrid {
namespace {

Field field_of(const std::string& nodes) {
  const SceneFile file = parse_scene("sdfgrid: 1\nscene: " + nodes, "test");
  EXPECT_TRUE(file.warnings.empty());
  return build_scene(file.scene, "test", 0, Job()).field;
}

const char* const kScenes[] = {
    "{sphere: {radius: 1}}",
    "{shell: {thickness: 0.05, of: {sphere: {radius: 1}}}}",  // an empty interior
    "{difference: [{box: {size: [2, 1.5, 1]}}, {torus: {major: 0.7, minor: 0.2}, at: [0, 0, "
    "0.5]}]}",
    "{smooth_union: {k: 0.4, of: [{sphere: {radius: 0.5}}, {box: {size: [2, 0.3, 0.3]}, rotate: "
    "[10, 20, 30]}]}, at: [100, -50, 3]}",
    "{twist: {turns: 0.4, of: {box: {size: [1, 0.5, 2]}}}}",
    "[{sphere: {radius: 0.1}, at: [-1, -1, -1]}, {sphere: {radius: 0.1}, at: [1, 1, 1]}]",
};

// All lattice points of the box around the grid's voxels and a little more.
void expect_same(const Field& field, const Grid& grid, const Band& band) {
  glm::ivec3 lo;
  glm::ivec3 hi;
  grid.active_bounds(lo, hi);
  const Lattice lattice = grid.lattice();
  const auto out = static_cast<float>(band.exwidth * lattice.voxel);
  const auto in = static_cast<float>(-band.inwidth * lattice.voxel);
  std::size_t active = 0;
  for (int x = lo.x - 4; x <= hi.x + 4; ++x) {
    for (int y = lo.y - 4; y <= hi.y + 4; ++y) {
      for (int z = lo.z - 4; z <= hi.z + 4; ++z) {
        const float v = field(glm::vec3(lattice.to_world(glm::dvec3(x, y, z))));
        active += v < out && v > in ? 1 : 0;
        ASSERT_EQ(grid.value({x, y, z}), std::clamp(v, in, out)) << x << ' ' << y << ' ' << z;
      }
    }
  }
  EXPECT_EQ(grid.active_voxels(), active);
}

TEST(ConvertField, HoldsTheFieldsOwnValuesEverywhere) {
  for (const char* scene : kScenes) {
    SCOPED_TRACE(scene);
    const Field field = field_of(scene);
    FieldConvertOptions options;
    options.dim = 60;
    expect_same(field, convert_field(field, options, Job()).grid, options.band);
    options.band = {5, 2};
    options.dim = 37;
    expect_same(field, convert_field(field, options, Job()).grid, options.band);
  }
}

TEST(ConvertField, IsTheSameAtAnyNumberOfThreads) {
  const Field field = field_of(kScenes[3]);
  FieldConvertOptions options;
  options.dim = 200;
  std::size_t active[2];
  std::size_t evaluated[2];
  for (int threads = 1; threads <= 2; ++threads) {
    const ThreadLimit limit(threads);
    const FieldConversion made = convert_field(field, options, Job());
    active[threads - 1] = made.grid.active_voxels();
    evaluated[threads - 1] = made.evaluated;
  }
  EXPECT_EQ(active[0], active[1]);
  EXPECT_EQ(evaluated[0], evaluated[1]);
}

TEST(ConvertField, DoesNotVisitEmptySpace) {
  // Work follows the surface: eight times the voxels, four times the points.
  const Field field = field_of(kScenes[2]);
  FieldConvertOptions options;
  options.dim = 64;
  const auto coarse = static_cast<double>(convert_field(field, options, Job()).evaluated);
  options.dim = 256;
  const auto fine = static_cast<double>(convert_field(field, options, Job()).evaluated);
  EXPECT_LT(fine, 20 * coarse);
  // Its area is 13; the band, and blocks that overhang it, are 14 voxels thick.
  EXPECT_LT(fine, 13 * 128 * 128 * 14);
  // Two small balls far apart: next to nothing.
  const Field two = field_of("[{sphere: {radius: 0.01}}, {sphere: {radius: 0.01}, at: [9, 9, 9]}]");
  options.dim = 4096;
  EXPECT_LT(convert_field(two, options, Job()).evaluated, 100000U);
}

// Between its samples: none is inside, and yet there is something.
TEST(ConvertField, KeepsWhatIsThinnerThanItsVoxels) {
  FieldConvertOptions options;
  options.voxel = 0.1;
  const Field field = field_of("{shell: {thickness: 1e-5, of: {sphere: {radius: 0.987}}}}");
  const FieldConversion made = convert_field(field, options, Job());
  EXPECT_GT(made.grid.active_voxels(), 1000U);
  const Job cancelled;
  cancelled.cancel();
  EXPECT_THROW((void)convert_field(field, options, cancelled), Error);
}

TEST(ConvertField, RefusesWhatHasNoEndOrNoInside) {
  const auto refusal = [](const Field& field, const FieldConvertOptions& options) {
    try {
      (void)convert_field(field, options, Job());
    } catch (const Error& e) {
      return e.kind();
    }
    return ErrorKind::cancelled;
  };
  FieldConvertOptions options;
  EXPECT_EQ(refusal(field_of("{plane: {}}"), options), ErrorKind::input);
  EXPECT_EQ(refusal(Field(), options), ErrorKind::input);
  // Their boxes meet, the balls do not.
  const char* apart =
      "{intersection: [{sphere: {radius: 1}}, {sphere: {radius: 1}, at: [1.5, 1.5, 0]}]}";
  EXPECT_EQ(refusal(field_of(apart), options), ErrorKind::input);
  options.voxel = 1e-12;
  EXPECT_EQ(refusal(field_of(kScenes[0]), options), ErrorKind::usage);
  options = {};
  options.max_memory = 1000;
  EXPECT_EQ(refusal(field_of(kScenes[0]), options), ErrorKind::failed);
  options = {};
  options.band.inwidth = 0.5;
  EXPECT_EQ(refusal(field_of(kScenes[0]), options), ErrorKind::usage);
}

}  // namespace
}  // namespace sdfgrid
