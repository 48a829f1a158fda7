// Dense fields of meshes and scenes: every sample, against brute force and against bands.
#include "sdfgrid/grid/convert_dense.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "property/random_meshes.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/mesh/reference.h"

namespace sdfgrid {
namespace {

TriangleSoup two_shapes() {
  return shapes::joined(shapes::torus_mesh(1.2, 0.45),
                        shapes::box_mesh({-0.4, -0.3, 1.1}, {0.5, 0.4, 1.9}));
}

ConvertOptions dense_options(std::optional<TransformMethod> method = {}) {
  ConvertOptions options;
  options.dim = 40;
  options.band = {6, 6};
  if (method) options.transform = TransformOptions{.method = *method};
  return options;
}

const std::vector<float>& values_of(const Volume& volume) {
  return std::get<std::vector<float>>(volume.samples);
}

// The independent reference's distance and sign, at every fifth sample.
TEST(ConvertDense, IsExactEverywhere) {
  const TriangleSoup soup = two_shapes();
  const Volume volume = convert_dense(soup, dense_options(), Job{}).distances;
  const Box box = bounds(soup);
  const double voxel = volume.spacing.x;
  const glm::dvec3 end = volume.to_world(glm::dvec3(volume.dims - 1));
  for (int a = 0; a < 3; ++a) {
    EXPECT_LE(volume.origin[a], box.lo[a] - 6 * voxel + 1e-9);
    EXPECT_GE(end[a], box.hi[a] + 6 * voxel - 1e-9);
  }
  const ReferenceDistance reference(soup);
  double farthest = 0;
  for (int z = 0; z < volume.dims.z; z += 5) {
    for (int y = 0; y < volume.dims.y; ++y) {
      for (int x = 0; x < volume.dims.x; x += 3) {
        const glm::dvec3 at = volume.to_world({x, y, z});
        const double want = glm::length(reference.closest(at) - at);
        const double got = static_cast<double>(values_of(volume)[volume.place({x, y, z})]);
        ASSERT_NEAR(std::abs(got), want, 1e-5 * voxel + 1e-7 * want) << x << " " << y << " " << z;
        farthest = std::max(farthest, want / voxel);
        if (want < 1e-4 * voxel) continue;
        ASSERT_EQ(got<0, reference.winding_number(at)> 0.5) << x << " " << y << " " << z;
      }
    }
  }
  EXPECT_GT(farthest, 10) << "most of it is beyond the band";
}

TEST(ConvertDense, TransformsFillTheSameBox) {
  const TriangleSoup soup = two_shapes();
  const Volume exact = convert_dense(soup, dense_options(), Job{}).distances;
  const double voxel = exact.spacing.x;
  for (const TransformMethodInfo& info : transform_methods()) {
    if (!info.volumes || info.method == TransformMethod::antialiased) continue;
    ConvertOptions options = dense_options(info.method);
    options.transform->steps = {{{1, 0, 0}, 1.0}, {{1, 1, 0}, 1.41}, {{1, 1, 1}, 1.73}};
    const Volume made = convert_dense(soup, options, Job{}).distances;
    ASSERT_EQ(made.dims, exact.dims) << info.name;
    double largest = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      const auto want = static_cast<double>(values_of(exact)[i]);
      const auto got = static_cast<double>(values_of(made)[i]);
      ASSERT_EQ(got < 0, want < 0) << info.name << " " << i;
      largest = std::max(largest, std::abs(std::abs(got) - std::abs(want)) / voxel);
    }
    // Chamfer's error grows with the distance: a tenth of it.
    EXPECT_LT(largest, 4) << info.name;
    if (info.method == TransformMethod::closest_point) {
      EXPECT_LT(largest, 0.8);
    }
  }
}

TEST(ConvertDense, GivesTheSameBytesAtAnyNumberOfThreads) {
  const TriangleSoup soup = two_shapes();
  std::vector<float> one;
  {
    const ThreadLimit limit(1);
    one = values_of(convert_dense(soup, dense_options(), Job{}).distances);
  }
  const ThreadLimit limit(4);
  EXPECT_EQ(one, values_of(convert_dense(soup, dense_options(), Job{}).distances));
}

TEST(ConvertDense, ScenesGiveTheirOwnValues) {
  const Field field = make_field("sphere", {{"radius", 1.0}});
  FieldConvertOptions options;
  options.dim = 24;
  options.band = {4, 4};
  const Volume volume = convert_dense(field, options, Job{});
  EXPECT_GE(volume.dims.x, 32);
  for (int z = 0; z < volume.dims.z; ++z) {
    for (int y = 0; y < volume.dims.y; ++y) {
      for (int x = 0; x < volume.dims.x; ++x) {
        const double want = glm::length(volume.to_world({x, y, z})) - 1;
        ASSERT_NEAR(values_of(volume)[volume.place({x, y, z})], want, 1e-6);
      }
    }
  }
}

TEST(ConvertDense, RefusesWhatItCannotDo) {
  const auto kind_of = [](const ConvertOptions& options) {
    try {
      (void)convert_dense(two_shapes(), options, Job{});
    } catch (const Error& error) {
      return error.kind();
    }
    return ErrorKind::cancelled;
  };
  EXPECT_EQ(kind_of(dense_options(TransformMethod::feature)), ErrorKind::usage);
  EXPECT_EQ(kind_of(dense_options(TransformMethod::antialiased)), ErrorKind::usage);
  ConvertOptions options = dense_options(TransformMethod::fmm);
  options.sign = SignMethod::no_sign;
  EXPECT_EQ(kind_of(options), ErrorKind::usage);
  options = dense_options();
  options.max_memory = 1000;
  EXPECT_EQ(kind_of(options), ErrorKind::failed);
}

}  // namespace
}  // namespace sdfgrid
