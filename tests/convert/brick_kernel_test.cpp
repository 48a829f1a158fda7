// The vector kernels against brute force in long double, on every instruction set of this machine.
#include "sdfgrid/voxelize/brick_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "property/random_meshes.h"
#include "sdfgrid/core/isa.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/voxelize/node_bins.h"

namespace sdfgrid {
namespace {

using shapes::Random;
using V = glm::vec<3, long double>;

struct NamedKernel {
  const char* name;
  const BrickKernel* kernel;
};

std::vector<NamedKernel> kernels() {
  std::vector<NamedKernel> all = {{"baseline", &baseline::kBrickKernel}};
#if defined(__x86_64__)
  if (active_isa() >= Isa::avx2) all.push_back({"avx2", &avx2::kBrickKernel});
  if (active_isa() >= Isa::avx512) all.push_back({"avx512", &avx512::kBrickKernel});
#endif
  return all;
}

long double to_segment(const V& p, const V& a, const V& b) {
  const V e = b - a;
  const long double l = glm::dot(e, e);
  const long double s = l > 0 ? std::clamp(glm::dot(p - a, e) / l, 0.0L, 1.0L) : 0.0L;
  return glm::length(p - a - s * e);
}

// Distance to a triangle by another way than the kernel's: barycentric coordinates of the foot.
long double to_triangle(const V& p, const V& a, const V& b, const V& c) {
  long double best = std::min({to_segment(p, a, b), to_segment(p, b, c), to_segment(p, c, a)});
  const V u = b - a;
  const V v = c - a;
  const V w = p - a;
  const long double uu = glm::dot(u, u);
  const long double uv = glm::dot(u, v);
  const long double vv = glm::dot(v, v);
  const long double det = uu * vv - uv * uv;
  if (det > 1e-25L * uu * vv) {
    const long double s = (vv * glm::dot(w, u) - uv * glm::dot(w, v)) / det;
    const long double t = (uu * glm::dot(w, v) - uv * glm::dot(w, u)) / det;
    if (s >= 0 && t >= 0 && s + t <= 1) best = std::min(best, glm::length(w - s * u - t * v));
  }
  return best;
}

struct Triangle {
  glm::dvec3 corner[3];
};

// Triangles of every kind that meshes hold: small, huge, needles, caps, segments, points.
Triangle random_triangle(Random& random) {
  const double sizes[] = {0.3, 3, 30, 3000};
  const double size = sizes[random.integer(0, 3)];
  Triangle t;
  const glm::dvec3 near = random.in_box(glm::dvec3(-2), glm::dvec3(10));
  for (glm::dvec3& c : t.corner) c = near + size * random.in_box(glm::dvec3(-1), glm::dvec3(1));
  const double thin[] = {0, 1e-9, 1e-6, 1e-4, 1e-2};
  const double height = thin[random.integer(0, 4)];
  const glm::dvec3 e = t.corner[1] - t.corner[0];
  switch (random.integer(0, 7)) {
    case 0:  // needle: the third corner beside the second
      t.corner[2] = t.corner[1] + height * random.direction();
      break;
    case 1:  // cap: the third corner beside the middle of the first edge
      t.corner[2] = t.corner[0] + random.unit() * e + height * random.direction();
      break;
    case 2:  // fold: the third corner beyond the second, on its line
      t.corner[2] = t.corner[0] + (1 + random.unit()) * e + height * random.direction();
      break;
    case 3:  // a point
      if (height == 0) t.corner[1] = t.corner[2] = t.corner[0];
      break;
    case 4:  // in a plane of the lattice, along its axes
      for (glm::dvec3& c : t.corner) c = glm::round(c);
      t.corner[2].x = t.corner[1].x = t.corner[0].x;
      break;
    default:
      break;
  }
  return t;
}

// Distances of a brick at index (0, 0, 0) to the triangles, by `kernel`.
BrickDistances run(const BrickKernel& kernel, const std::vector<Triangle>& triangles, float reach) {
  const double center[3] = {3.5, 3.5, 3.5};
  std::vector<TriangleFrame> frames(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    kernel.make_frame(make_record(triangles[i].corner), center, frames[i]);
  }
  std::vector<float> distance(32 * frames.size());
  std::vector<std::int32_t> lists(32 * frames.size());
  BrickDistances out;
  kernel.distances(frames.data(), static_cast<std::int32_t>(frames.size()), reach, Culling::exact,
                   {distance.data(), lists.data()}, out);
  return out;
}

TEST(BrickKernel, DistancesEqualBruteForceOverRandomAndDegenerateTriangles) {
  constexpr float kReach = 4;
  for (const auto& [name, kernel] : kernels()) {
    Random random(7);
    double worst = 0;
    int within = 0;
    for (int round = 0; round < 300; ++round) {
      std::vector<Triangle> triangles(static_cast<std::size_t>(random.integer(1, 40)));
      for (Triangle& t : triangles) t = random_triangle(random);
      const BrickDistances out = run(*kernel, triangles, kReach);
      for (int i = 0; i < 512; i += 3) {
        const V p(i >> 6, (i >> 3) & 7, i & 7);
        long double exact = 1e30L;
        for (const Triangle& t : triangles) {
          exact = std::min(exact, to_triangle(p, V(t.corner[0]), V(t.corner[1]), V(t.corner[2])));
        }
        const double ours = std::sqrt(static_cast<double>(out.squared[i]));
        if (exact > kReach) {
          ASSERT_GT(ours, kReach - 1e-4) << name << " round " << round << " sample " << i;
          continue;
        }
        ++within;
        worst = std::max(worst, std::abs(ours - static_cast<double>(exact)));
        ASSERT_NEAR(ours, static_cast<double>(exact), 1e-5)
            << name << " round " << round << " sample " << i;
        ASSERT_GE(out.nearest[i], 0);
      }
    }
    EXPECT_GT(within, 20000);
    RecordProperty(std::string("worst_voxels_") + name, std::to_string(worst));
  }
}

// The widest band that the command line takes: the error that is stated of it holds.
TEST(BrickKernel, DistancesToTheEndOfTheWidestBandKeepTheStatedError) {
  constexpr float kReach = 1000;
  const double allowed = convert_error({kReach, kReach});
  for (const auto& [name, kernel] : kernels()) {
    Random random(11);
    double worst = 0;
    for (int round = 0; round < 300; ++round) {
      std::vector<Triangle> triangles(static_cast<std::size_t>(random.integer(1, 10)));
      for (Triangle& t : triangles) {
        t = random_triangle(random);
        const glm::dvec3 away = kReach * (0.2 + 0.8 * random.unit()) * random.direction();
        for (glm::dvec3& c : t.corner) c += away;
      }
      const BrickDistances out = run(*kernel, triangles, kReach);
      for (int i = 0; i < 512; i += 7) {
        const V p(i >> 6, (i >> 3) & 7, i & 7);
        long double exact = 1e30L;
        for (const Triangle& t : triangles) {
          exact = std::min(exact, to_triangle(p, V(t.corner[0]), V(t.corner[1]), V(t.corner[2])));
        }
        if (exact > kReach) continue;
        const double error =
            std::abs(std::sqrt(static_cast<double>(out.squared[i])) - static_cast<double>(exact));
        worst = std::max(worst, error);
        ASSERT_LE(error, convert_error({static_cast<double>(exact), 1}))
            << name << " round " << round << " sample " << i;
      }
    }
    EXPECT_GT(worst, 0.1 * allowed) << name;
    RecordProperty(std::string("worst_voxels_") + name, std::to_string(worst));
  }
}

TEST(BrickKernel, SquaredDistanceOfRecordsIsExact) {
  Random random(8);
  for (const auto& [name, kernel] : kernels()) {
    for (int round = 0; round < 5000; ++round) {
      const Triangle t = random_triangle(random);
      const glm::dvec3 p = random.in_box(glm::dvec3(-20), glm::dvec3(20));
      const double center[3] = {p.x, p.y, p.z};
      const double ours = std::sqrt(kernel->squared_distance(make_record(t.corner), center));
      const long double exact = to_triangle(V(p), V(t.corner[0]), V(t.corner[1]), V(t.corner[2]));
      if (exact > 100) continue;  // far beyond any band: only "far" matters
      // A nearly flat triangle is taken for its longest edge, 1e-6 away at most.
      ASSERT_NEAR(ours, static_cast<double>(exact), 3e-6) << name << " round " << round;
    }
  }
}

TEST(BrickKernel, FusedInstructionSetsAgreeBitForBit) {
  if (kernels().size() < 3) GTEST_SKIP() << "this machine has no AVX-512 to compare with AVX2";
  Random random(9);
  for (int round = 0; round < 100; ++round) {
    std::vector<Triangle> triangles(20);
    for (Triangle& t : triangles) t = random_triangle(random);
    const BrickDistances a = run(*kernels()[1].kernel, triangles, 3);
    const BrickDistances b = run(*kernels()[2].kernel, triangles, 3);
    for (int i = 0; i < 512; ++i) ASSERT_EQ(a.squared[i], b.squared[i]) << i;
  }
}

TEST(BrickKernel, LinksJoinOnlySamplesWhoseBallsOverlap) {
  Random random(10);
  for (const auto& [name, kernel] : kernels()) {
    std::vector<Triangle> triangles(10);
    for (Triangle& t : triangles) t = random_triangle(random);
    const BrickDistances d = run(*kernel, triangles, 3);
    BrickLinks links;
    kernel->links(d, 3, links);
    const auto radius = [&](int i) { return std::min(std::sqrt(d.squared[i]), 3.0F); };
    for (int i = 0; i < 512; ++i) {
      const int place[3] = {i >> 6, (i >> 3) & 7, i & 7};
      const int step[3] = {64, 8, 1};
      const std::uint64_t* axis[3] = {links.link_x, links.link_y, links.link_z};
      for (int a = 0; a < 3; ++a) {
        const bool linked = (axis[a][i >> 6] >> (i & 63) & 1) != 0;
        const bool expected = place[a] < 7 && radius(i) + radius(i + step[a]) > 1.0001F;
        ASSERT_EQ(linked, expected) << name << " sample " << i << " axis " << a;
      }
    }
  }
}

}  // namespace
}  // namespace sdfgrid
