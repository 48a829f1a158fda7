// More than a million rays against LatticeField, which looks at every cell on the way in double: no
// hit missed, none invented, and the depth right. trace_ray() and the packets of trace_primary().
#include "sdfgrid/trace/trace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <random>
#include <sstream>

#include "sdfgrid/core/isa.h"
#include "sdfgrid/core/parallel.h"
#include "trace/lattice_field.h"
#include "trace/rough_grids.h"

namespace sdfgrid {
namespace {

constexpr double kExact = 1e-8;   // voxels: trace_ray(), beyond what LatticeField leaves open
constexpr double kPacket = 1e-3;  // voxels: trace_primary(), as trace.h says
constexpr double kSteep = 0.25;   // of Atlas::slope: rays that meet the surface flatter graze it
constexpr int kRays = 100000;     // a grid
constexpr int kPictures = 26;     // a grid

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()(double lo, double hi) {
    return lo + (hi - lo) * std::uniform_real_distribution<double>()(engine_);
  }
  int below(int n) { return static_cast<int>((*this)(0, n)); }
  glm::dvec3 direction() {
    for (;;) {
      const glm::dvec3 d((*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1));
      const double length = glm::length(d);
      if (length > 0.1 && length < 1) return d / length;
    }
  }
  // An index point in the field's box.
  glm::dvec3 in(const test::LatticeField& field) {
    const glm::dvec3 size = field.hi() - field.lo();
    const glm::dvec3 part((*this)(0, 1), (*this)(0, 1), (*this)(0, 1));
    return glm::dvec3(field.lo()) + part * size;
  }

 private:
  std::mt19937_64 engine_;
};

// From within or without, some parallel to axes or planes of the lattice, some in such planes.
Ray random_ray(const test::LatticeField& field, Random& random) {
  glm::dvec3 through = random.in(field);
  glm::dvec3 direction = random.direction();
  const int kind = random.below(12);
  if (kind < 3) {
    for (int i = 0; i <= kind % 2; ++i) direction[random.below(3)] = 0;
    if (glm::length(direction) < 1e-3) direction = {0, -1, 0};
  } else if (kind == 3) {
    direction = {random.below(2) - 0.5, random.below(2) - 0.5, random.below(2) - 0.5};
  }
  if (kind == 2 || kind == 4) {
    const int axis = random.below(3);
    through[axis] = std::round(through[axis]);
  } else if (kind == 3) {
    through = glm::round(through);  // along diagonals, from corner to corner
  }
  direction = glm::normalize(direction);
  const double back = random.below(3) == 0 ? 0 : random(1, 90);
  return {field.lattice().to_world(through - back * direction), direction};
}

// What the rays of one grid came to; all depths in voxels.
struct Tally {
  int hits = 0;
  int misses = 0;
  double worst = 0;  // how far a depth is beyond what the reference allows
};

void tally(const test::Crossing& truth, const std::optional<double>& depth, Tally& tally) {
  ++(depth ? tally.hits : tally.misses);
  if (!depth) {
    ASSERT_FALSE(truth.late) << "missed the surface at " << *truth.late << " voxels";
    return;
  }
  ASSERT_TRUE(truth.early) << "invented a surface at " << *depth << " voxels";
  const double late = truth.late.value_or(*depth);
  tally.worst = std::max({tally.worst, *truth.early - *depth, *depth - late});
}

std::string text_of(const Ray& ray) {
  std::ostringstream out;
  out.precision(17);
  out << "ray from " << ray.origin.x << ' ' << ray.origin.y << ' ' << ray.origin.z << " along "
      << ray.direction.x << ' ' << ray.direction.y << ' ' << ray.direction.z;
  return out.str();
}

TEST(SingleRays, HitWhatAWalkOverAllCellsHits) {
  for (const auto& [name, grid] : test::rough_grids()) {
    const Atlas atlas = make_atlas(grid, Job());
    const test::LatticeField field(grid);
    const double voxel = atlas.lattice.voxel;
    Random random(21);
    Tally sum;
    for (int i = 0; i < kRays; ++i) {
      const Ray ray = random_ray(field, random);
      const double from = random.below(4) == 0 ? random(0, 60) : 0;
      auto depth = trace_ray(atlas, ray, from * voxel);
      if (depth) *depth /= voxel;
      tally(field.first_crossing(ray, from), depth, sum);
      if (HasFailure()) FAIL() << name << ", " << text_of(ray);
    }
    EXPECT_LT(sum.worst, kExact) << name;
    EXPECT_GT(sum.hits, kRays / 30) << name;
    EXPECT_GT(sum.misses, kRays / 100) << name;
  }
}

TEST(SingleRays, StopAtTheGivenDistance) {
  const Grid grid = test::rough_grids()[1].grid;
  const Atlas atlas = make_atlas(grid, Job());
  const test::LatticeField field(grid);
  Random random(22);
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Ray ray = random_ray(field, random);
    const auto depth = trace_ray(atlas, ray);
    if (!depth || *depth < 1e-3) continue;
    ++hits;
    const auto before = trace_ray(atlas, ray, 0, *depth - 1e-9);
    ASSERT_TRUE(!before || *before <= *depth - 1e-9);
    const auto after = trace_ray(atlas, ray, 0, *depth + 1e-9);
    ASSERT_TRUE(after);
    ASSERT_NEAR(*after, *depth, 1e-9);
  }
  EXPECT_GT(hits, 5000);
}

// At a random place, inside or outside, near or far, with an odd number of pixels.
Camera random_camera(const test::LatticeField& field, Random& random) {
  Camera camera;
  const glm::dvec3 target = random.in(field);
  const double away = random.below(3) == 0 ? random(1, 20) : random(40, 120);
  camera.target = field.lattice().to_world(target);
  glm::dvec3 eye = target - away * random.direction();
  // Straight along an axis of the lattice: whole rows of rays in planes.
  if (random.below(8) == 0) eye = target - away * glm::dvec3(0, 0, 1);
  camera.eye = field.lattice().to_world(eye);
  camera.fov = random(5, 90);
  camera.width = 61;
  camera.height = 67;
  return camera;
}

// The slope of the field along a ray (origin in index space), the lesser of before and after.
double slope_at(const test::LatticeField& field, const Ray& ray, double depth) {
  constexpr double kStep = 1e-4;
  const auto value = [&](double t) { return field.at(ray.origin + t * ray.direction); };
  const double before = std::abs(value(depth) - value(depth - kStep));
  const double after = std::abs(value(depth + kStep) - value(depth));
  return std::min(before, after) / kStep;
}

// A packet's depth against that of the same ray alone, both in voxels. However flat the ray, the
// field where the packet ends is as near to zero as single precision can tell.
void expect_depth(const Atlas& atlas, const test::LatticeField& field, const Ray& ray,
                  double packet, double single) {
  const Ray in_index{field.lattice().to_index(ray.origin), ray.direction};
  const double rounding = 1e-7 * single;  // of the picture's floats
  const double value = field.at(in_index.origin + packet * in_index.direction);
  ASSERT_LE(std::abs(value), 0.25 * atlas.margin() + (1e-5 + rounding) * atlas.slope);
  const bool grazing = slope_at(field, in_index, single) < kSteep * atlas.slope;
  if (!grazing) {
    ASSERT_NEAR(packet, single, kPacket + rounding);
  }
}

// Compares a picture, pixel by pixel, with single rays, and these with the reference.
void expect_picture(const Atlas& atlas, const test::LatticeField& field, const Camera& camera,
                    Tally& sum) {
  const HitBuffer hits = trace_primary(atlas, camera, Job());
  const RayGenerator rays(camera);
  const double voxel = atlas.lattice.voxel;
  for (int pixel = 0; pixel < camera.width * camera.height; ++pixel) {
    const Ray ray = rays.ray(pixel % camera.width + 0.5, pixel / camera.width + 0.5);
    auto single = trace_ray(atlas, ray);
    if (single) *single /= voxel;
    tally(field.first_crossing(ray, 0), single, sum);
    const bool hit = std::isfinite(hits.depth[pixel]);
    EXPECT_EQ(hit, single.has_value());
    if (hit && single) expect_depth(atlas, field, ray, hits.depth[pixel] / voxel, *single);
    if (testing::Test::HasFailure()) FAIL() << text_of(ray);
  }
}

TEST(Packets, HitWhatSingleRaysAndAWalkOverAllCellsHit) {
  for (const auto& [name, grid] : test::rough_grids()) {
    const Atlas atlas = make_atlas(grid, Job());
    const test::LatticeField field(grid);
    Random random(23);
    Tally sum;
    for (int i = 0; i < kPictures; ++i) {
      expect_picture(atlas, field, random_camera(field, random), sum);
      if (HasFailure()) FAIL() << name << ", picture " << i << ", " << isa_name(active_isa());
    }
    EXPECT_LT(sum.worst, kExact) << name;
    EXPECT_GT(sum.hits, kPictures * 40) << name;
    EXPECT_GT(sum.misses, kPictures * 10) << name;
  }
}

TEST(Packets, SameBitsOnAnyNumberOfThreads) {
  for (const auto& [name, grid] : test::rough_grids()) {
    Random random(24);
    Camera camera = random_camera(test::LatticeField(grid), random);
    camera.width = 311;
    camera.height = 203;
    std::vector<HitBuffer> pictures;
    for (const int threads : {1, 2, 8}) {
      const ThreadLimit limit(threads);
      pictures.push_back(trace_primary(make_atlas(grid, Job()), camera, Job()));
    }
    for (const HitBuffer& picture : pictures) {
      EXPECT_TRUE(picture.depth == pictures[0].depth) << name;
      EXPECT_TRUE(picture.steps == pictures[0].steps) << name;
    }
  }
}

TEST(Field, IsTheTrilinearOneOfTheSamples) {
  for (const auto& [name, grid] : test::rough_grids()) {
    const Atlas atlas = make_atlas(grid, Job());
    const test::LatticeField field(grid);
    Random random(25);
    for (int i = 0; i < 20000; ++i) {
      const glm::dvec3 world = field.lattice().to_world(random.in(field));
      const double expected = field.at(field.lattice().to_index(world)) * atlas.lattice.voxel;
      ASSERT_NEAR(distance_at(atlas, world), expected, 2e-6 * atlas.lattice.voxel) << name;
    }
  }
}

}  // namespace
}  // namespace sdfgrid
