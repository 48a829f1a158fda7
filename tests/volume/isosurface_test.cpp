// The surface in a volume: closed whatever the samples are, on the interpolant's zero, and with
// every sample on its right side.
#include "sdfgrid/volume/isosurface.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/mesh/diagnose.h"
#include "sdfgrid/mesh/reference.h"
#include "sdfgrid/volume/regions.h"
#include "volume/volumes.h"

namespace sdfgrid {
namespace {

using namespace testing;

Volume sampled(const glm::ivec3& dims, const std::function<double(const glm::dvec3&)>& f) {
  Volume volume;
  volume.dims = dims;
  std::vector<float> samples;
  for (int k = 0; k < dims.z; ++k) {
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i < dims.x; ++i) samples.push_back(static_cast<float>(f({i, j, k})));
    }
  }
  volume.samples = std::move(samples);
  return volume;
}

template <class Draw>
Volume random_volume(const glm::ivec3& dims, const Draw& draw) {
  return sampled(dims, [&](const glm::dvec3&) { return draw(); });
}

double trilinear(const Volume& volume, const glm::dvec3& p) {
  const glm::ivec3 last = volume.dims - 2;
  const glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor(p)), glm::ivec3(0), last);
  const glm::dvec3 t = p - glm::dvec3(cell);
  double sum = 0;
  for (int c = 0; c < 8; ++c) {
    const glm::ivec3 upper(c & 1, c >> 1 & 1, c >> 2);
    double weight = 1;
    for (int a = 0; a < 3; ++a) weight *= upper[a] != 0 ? t[a] : 1 - t[a];
    const glm::ivec3 at = cell + upper;
    sum += weight * value_at(volume, at.x, at.y, at.z);
  }
  return sum;
}

void expect_closed(const TriangleSoup& soup, const std::string& what) {
  const MeshDiagnosis diagnosis = diagnose(soup);
  ASSERT_TRUE(diagnosis.closed()) << what << ": " << diagnosis.boundary_edges << " open and "
                                  << diagnosis.nonmanifold_edges << " non-manifold edges";
  ASSERT_TRUE(diagnosis.consistently_oriented()) << what;
  ASSERT_EQ(diagnosis.zero_area_faces, 0U) << what;
  ASSERT_GT(diagnosis.volume, 0) << what;
}

// Every sample on its side of the mesh, by the independent winding number.
void expect_sides(const Volume& volume, const TriangleSoup& soup, double iso) {
  const ReferenceDistance reference(soup);
  for (int k = 0; k < volume.dims.z; ++k) {
    for (int j = 0; j < volume.dims.y; ++j) {
      for (int i = 0; i < volume.dims.x; ++i) {
        const double distance = reference.signed_distance(volume.to_world({i, j, k}));
        ASSERT_EQ(distance < 0, value_at(volume, i, j, k) >= iso) << i << " " << j << " " << k;
      }
    }
  }
}

// A cell of every pattern of corners, with magnitudes that decide its faces this way and that.
TEST(Isosurface, EveryPatternOfACellIsClosed) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> magnitude(0.01, 1);
  for (unsigned pattern = 1; pattern < 256; ++pattern) {
    for (int draw = 0; draw < 20; ++draw) {
      const Volume volume = sampled({2, 2, 2}, [&](const glm::dvec3& p) {
        const unsigned corner = unsigned(p.x) | unsigned(p.y) << 1U | unsigned(p.z) << 2U;
        return (pattern >> corner & 1U) != 0 ? magnitude(random) : -magnitude(random);
      });
      const TriangleSoup soup = isosurface(volume, {}, Job());
      expect_closed(soup, std::to_string(pattern));
      expect_sides(volume, soup, 0);
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
}

TEST(Isosurface, NoiseAndMasksAreClosed) {
  std::mt19937 random(2);
  std::normal_distribution<double> noise;
  for (int draw = 0; draw < 10; ++draw) {
    const Volume rough = random_volume({9, 7, 8}, [&] { return noise(random); });
    const TriangleSoup soup = isosurface(rough, {0.3, true}, Job());
    expect_closed(soup, "noise");
    expect_sides(rough, soup, 0.3);
    const Volume mask = random_volume({9, 7, 8}, [&] { return random() % 2; });
    expect_closed(isosurface(mask, {1, true}, Job()), "mask, iso at its ones");
    expect_closed(isosurface(mask, {0.5, true}, Job()), "mask");
    // Few integers: many samples equal iso.
    const Volume integers = random_volume({9, 7, 8}, [&] { return random() % 4; });
    const TriangleSoup touching = isosurface(integers, {2, true}, Job());
    expect_closed(touching, "integers");
    expect_sides(integers, touching, 2);
    expect_closed(isosurface(integers, {2, false}, Job()), "integers, below");
  }
}

glm::dvec3 in_index_space(const TriangleSoup& soup, std::uint32_t point) {
  return soup.origin + soup.local(point);
}

double smooth(const glm::dvec3& p) {
  return std::sin(0.45 * p.x + 0.3 * p.y) + std::cos(0.4 * p.y - 0.2 * p.z) +
         std::sin(0.37 * p.z + 0.9);
}

TEST(Isosurface, PointsLieOnTheInterpolantsZero) {
  const Volume volume = sampled({30, 28, 26}, smooth);
  const TriangleSoup soup = isosurface(volume, {0.25, true}, Job());
  expect_closed(soup, "smooth");
  std::size_t within = 0;
  for (std::uint32_t n = 0; n < soup.points.size(); ++n) {
    const glm::dvec3 p = in_index_space(soup, n);
    if (glm::any(glm::lessThan(p, glm::dvec3(0))) ||
        glm::any(glm::greaterThan(p, glm::dvec3(volume.dims - 1)))) {
      continue;  // on the closing at the border
    }
    bool on_border = false;
    for (int a = 0; a < 3; ++a) {
      on_border = on_border || p[a] < 1e-3 || p[a] > volume.dims[a] - 1 - 1e-3;
    }
    if (on_border) continue;
    ++within;
    // 1/4096 of an edge, on which the field changes by 1 at most.
    ASSERT_NEAR(trilinear(volume, p), 0.25, 3e-4) << p.x << " " << p.y << " " << p.z;
  }
  EXPECT_GT(within, 1000U);
}

// Between its points the mesh is as near to the interpolant as isosurface.h says, in spacings.
TEST(Isosurface, TrianglesKeepToTheInterpolant) {
  const Volume volume = sampled({30, 28, 26}, smooth);
  const TriangleSoup soup = isosurface(volume, {0.25, true}, Job());
  double worst = 0;
  for (const glm::uvec3& t : soup.triangles) {
    const glm::dvec3 p =
        (in_index_space(soup, t.x) + in_index_space(soup, t.y) + in_index_space(soup, t.z)) / 3.0;
    if (glm::any(glm::lessThan(p, glm::dvec3(1))) ||
        glm::any(glm::greaterThan(p, glm::dvec3(volume.dims - 2)))) {
      continue;
    }
    glm::dvec3 gradient;
    for (int a = 0; a < 3; ++a) {
      glm::dvec3 step(0.0);
      step[a] = 1e-4;
      gradient[a] = (trilinear(volume, p + step) - trilinear(volume, p - step)) / 2e-4;
    }
    worst = std::max(worst, std::abs(trilinear(volume, p) - 0.25) / glm::length(gradient));
  }
  EXPECT_LT(worst, 0.2);
  EXPECT_GT(worst, 1e-3) << "the interpolant is not flat";
}

TEST(Isosurface, ASphereConvergesWithTheSquareOfTheSpacing) {
  std::array<double, 2> worst{};
  for (int level = 0; level < 2; ++level) {
    const int n = 24 << level;
    const double radius = 0.37 * n;
    const glm::dvec3 center(0.5 * n, 0.51 * n, 0.47 * n);
    const Volume volume = sampled(
        glm::ivec3(n), [&](const glm::dvec3& p) { return radius - glm::distance(p, center); });
    const TriangleSoup soup = isosurface(volume, {}, Job());
    const double ball = 4.0 / 3 * 3.14159265 * radius * radius * radius;
    EXPECT_NEAR(diagnose(soup).volume / ball, 1, 0.01);
    for (std::uint32_t i = 0; i < soup.points.size(); ++i) {
      const double off = glm::distance(in_index_space(soup, i), center) - radius;
      worst[level] = std::max(worst[level], std::abs(off) / n);
    }
  }
  EXPECT_LT(worst[1], worst[0] / 3);
}

TEST(Isosurface, BelowIsTheComplementWithinTheVolume) {
  const Volume volume = sampled(
      {12, 12, 12}, [](const glm::dvec3& p) { return glm::distance(p, glm::dvec3(5.4)) - 3; });
  const MeshDiagnosis inside = diagnose(isosurface(volume, {0, false}, Job()));
  EXPECT_NEAR(inside.volume, 4.0 / 3 * 3.14159265 * 27, 8);  // chords of a small ball
  const MeshDiagnosis outside = diagnose(isosurface(volume, {0, true}, Job()));
  EXPECT_NEAR(inside.volume + outside.volume, 11.0 * 11 * 11, 0.5);
}

TEST(Isosurface, ClosedAlongTheOutermostSamples) {
  const Volume full = sampled({4, 3, 5}, [](const glm::dvec3&) { return 1; });
  const MeshDiagnosis box = diagnose(isosurface(full, {0.5, true}, Job()));
  EXPECT_NEAR(box.volume, 3 * 2 * 4, 0.05);
  const Volume one = sampled({1, 1, 1}, [](const glm::dvec3&) { return 1; });
  expect_closed(isosurface(one, {0.5, true}, Job()), "a single sample");
}

TEST(Isosurface, SpacingTurnsAndMirrorsCarryOver) {
  Volume volume = sampled({20, 20, 20}, [](const glm::dvec3& p) {
    return 6 - glm::distance(p, {9, 10, 11});
  });
  const MeshDiagnosis plain = diagnose(isosurface(volume, {}, Job()));
  volume.spacing = {0.5, 2, 3};
  volume.origin = {4e6, -7, 1};
  for (const double mirror : {1.0, -1.0}) {
    volume.axes = glm::dmat3({0, mirror, 0}, {-1, 0, 0}, {0, 0, 1});
    const TriangleSoup soup = isosurface(volume, {}, Job());
    expect_closed(soup, "turned");
    const MeshDiagnosis turned = diagnose(soup);
    EXPECT_NEAR(turned.volume, 3 * plain.volume, 1e-3 * plain.volume);
    const glm::dvec3 center = turned.bounds.center();
    EXPECT_LT(glm::distance(center, volume.to_world({9, 10, 11})), 0.1);
  }
}

TEST(Isosurface, NoSurfaceIsRefused) {
  const Volume volume = pattern_volume<std::uint8_t>();
  try {
    (void)isosurface(volume, {1000, true}, Job());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_NE(std::string(error.what()).find("--iso"), std::string::npos);
  }
}

// Two balls and a speck: the greater ball stays as it was, and what was around it.
TEST(Isosurface, OnlyTheLargestRegionStays) {
  const auto field = [](const glm::dvec3& p) {
    const double great = 5 - glm::distance(p, {8, 8, 8});
    const double small = 3 - glm::distance(p, {20, 20, 20});
    return std::max({great, small, 0.5 - glm::distance(p, {20, 4, 4})});
  };
  for (const bool above : {true, false}) {
    Volume volume = sampled({26, 26, 26}, field);
    if (!above) {
      for (float& v : std::get<std::vector<float>>(volume.samples)) v = -v;
    }
    const IsosurfaceOptions options{0.1 * (above ? 1 : -1), above};
    EXPECT_EQ(diagnose(isosurface(volume, options, Job())).components, 3U);
    EXPECT_EQ(keep_largest_region(volume, options, Job()), 2U);
    const MeshDiagnosis left = diagnose(isosurface(volume, options, Job()));
    EXPECT_EQ(left.components, 1U);
    EXPECT_LT(glm::distance(left.bounds.center(), glm::dvec3(8)), 0.1);
    EXPECT_EQ(keep_largest_region(volume, options, Job()), 0U);
  }
}

TEST(Isosurface, ThreadsDoNotChangeTheMesh) {
  const Volume volume = sampled({30, 28, 26}, smooth);
  const ThreadLimit one(1);
  const TriangleSoup a = isosurface(volume, {}, Job());
  const ThreadLimit three(3);
  const TriangleSoup b = isosurface(volume, {}, Job());
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.triangles, b.triangles);
}

}  // namespace
}  // namespace sdfgrid
