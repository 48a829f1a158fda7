// Grids as leaves of fields, over grids that are hard on them.
#include "sdfgrid/trace/grid_sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <random>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/convert_field.h"
#include "sdfgrid/grid/vdb.h"
#include "sdfgrid/trace/field_march.h"
#include "sdfgrid/trace/field_trace.h"
#include "sdfgrid/trace/step_kernel.h"
#include "sdfgrid/trace/trace.h"
#include "trace/rough_grids.h"

namespace sdfgrid {
namespace {

class Points {
 public:
  // In a box as large as `times` that of the grid.
  Points(const Grid& grid, double times) : box_(grid.bounds()) {
    const glm::dvec3 more = 0.5 * (times - 1) * box_.size();
    box_ = {box_.lo - more, box_.hi + more};
  }
  glm::dvec3 operator()() {
    const glm::dvec3 part(unit_(random_), unit_(random_), unit_(random_));
    return box_.lo + part * box_.size();
  }
  glm::dvec3 near(const glm::dvec3& p, double by) {
    return p + by * (2.0 * glm::dvec3(unit_(random_), unit_(random_), unit_(random_)) - 1.0);
  }

 private:
  Box box_;
  std::mt19937_64 random_{21};
  std::uniform_real_distribution<double> unit_;
};

// Active values far beyond the background, outside and inside, in the first layer of a brick that
// has band and that a slot without a brick lies before.
Grid beyond_the_background() {
  constexpr float kVoxel = 0.5F;
  const auto grid = openvdb::FloatGrid::create(3 * kVoxel);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(kVoxel));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  for (int i = 0; i < 27; ++i) {
    grid->tree().addTile(1, {i / 9 * 8, i / 3 % 3 * 8, i % 3 * 8}, -3 * kVoxel, false);
  }
  auto values = grid->getAccessor();
  for (int i = 0; i < 512; ++i) {
    const openvdb::Coord at(i / 64, i / 8 % 8, i % 8);
    const double ball = glm::length(glm::dvec3(at[0], at[1], at[2]) - 4.0) - 0.9;
    const float voxels = at[0] == 0 ? 10 : float(std::min(ball, 3.0));
    values.setValue(at + openvdb::Coord(8, 8, -16), kVoxel * voxels);
    values.setValue(at + openvdb::Coord(8, 8, 8), -kVoxel * voxels);
  }
  return from_vdb(grid);
}

TEST(GridSampler, NoGridIsSteeperThanOne) {
  std::vector<test::NamedGrid> grids = test::rough_grids();
  grids.push_back({"beyond the background", beyond_the_background()});
  for (const auto& [name, grid] : grids) {
    const auto sampler = make_sampler(grid, Job());
    const Lattice lattice = grid.lattice();
    const double voxel = lattice.voxel;
    Points point(grid, 3);
    Points within(grid, 1.2);
    for (int i = 0; i < 90000; ++i) {
      glm::dvec3 p = point();
      const double steps[] = {1000 * voxel, 8 * voxel, 0.3 * voxel, 0.01 * voxel};
      glm::dvec3 q = i % 5 == 4 ? point() : point.near(p, steps[i % 5]);
      if (i % 3 == 2) {  // across a face between two bricks
        glm::dvec3 index = lattice.to_index(within());
        double& across = index[i / 3 % 3];
        across = 8 * std::round(across / 8) - 0.01;
        p = lattice.to_world(index);
        across += 0.02;
        q = lattice.to_world(index);
      }
      ASSERT_LE(std::fabs(sampler->value(p) - sampler->value(q)),
                glm::length(p - q) * (1 + 1e-9) + 1e-9 * voxel)
          << name << " " << p.x << " " << p.y << " " << p.z << " to " << q.x << " " << q.y << " "
          << q.z;
    }
  }
}

TEST(GridSampler, TheSurfaceIsThatOfTheGrid) {
  for (const auto& [name, grid] : test::rough_grids()) {
    const auto sampler = make_sampler(grid, Job());
    const Atlas atlas = make_atlas(grid, Job());
    Points point(grid, 1.2);
    for (int i = 0; i < 20000; ++i) {
      const glm::dvec3 p = point();
      const float at = distance_at(atlas, p);
      if (std::fabs(at) < 1e-6 * atlas.lattice.voxel) continue;
      ASSERT_EQ(sampler->value(p) < 0, at < 0) << name << " " << p.x << " " << p.y << " " << p.z;
    }
  }
}

// What is measured of a grid by many threads, of values that need more bins than there are, is what
// one thread finds.
TEST(GridSampler, IsTheSameAtAnyNumberOfThreads) {
  for (const auto& [name, grid] : test::rough_grids()) {
    const auto wide = openvdb::deepCopyTypedGrid<openvdb::FloatGrid>(vdb(grid));
    for (auto it = wide->beginValueAll(); it; ++it) it.setValue(*it * 300);
    const Grid steep = from_vdb(wide);
    std::shared_ptr<const Sampler> samplers[2];
    for (const int i : {0, 1}) {
      const ThreadLimit threads(1 + 3 * i);
      samplers[i] = make_sampler(steep, Job());
    }
    Points point(steep, 1.5);
    for (int i = 0; i < 5000; ++i) {
      const glm::dvec3 p = point();
      ASSERT_EQ(samplers[0]->value(p), samplers[1]->value(p)) << name;
      const glm::dvec3 q = point.near(p, 2 * steep.lattice().voxel);
      ASSERT_LE(std::fabs(samplers[0]->value(p) - samplers[0]->value(q)),
                glm::length(p - q) * (1 + 1e-6))
          << name;
    }
  }
}

// Two balls far apart, in voxels, and what is between them.
constexpr double kRadius = 1.5;
constexpr double kAway = 4;
Grid two_balls() {
  const Field ball = make_field("sphere", {{"radius", kRadius}});
  FieldConvertOptions options;
  options.dim = 256;
  return convert_field(make_field("union", {},
                                  {make_field("translate", {{"by", {-kAway, 0, 0}}}, {ball}),
                                   make_field("translate", {{"by", {kAway, 0, 0}}}, {ball})}),
                       options, Job())
      .grid;
}
double to_balls(const glm::dvec3& p) {
  return glm::length(glm::dvec3(std::fabs(p.x) - kAway, p.y, p.z)) - kRadius;
}

TEST(GridSampler, KnowsHowFarItIsBeyondTheBand) {
  const Grid grid = two_balls();
  const auto sampler = make_sampler(grid, Job());
  const double voxel = grid.lattice().voxel;
  // The largest coordinate of a vector is no less than this share of it, and the slot where the
  // band ends counts as a part of it.
  const double share = 1 / std::sqrt(3.0);
  Points point(grid, 2.5);
  for (int i = 0; i < 100000; ++i) {
    const glm::dvec3 p = point();
    const double d = to_balls(p);
    const double value = sampler->value(p);
    ASSERT_LE(std::fabs(value), std::fabs(d) + 0.05 * voxel) << p.x << " " << p.y << " " << p.z;
    ASSERT_GE(std::fabs(value), share * (std::fabs(d) - (8 * std::sqrt(3.0) + 3) * voxel));
  }
  EXPECT_GT(sampler->value({0, 0, 0}), kAway - kRadius - 12 * voxel);
}

// Rays that the grid's own tracer finds to hit are hit by sphere tracing, within its tolerance, and
// on the way there are few evaluations.
TEST(GridSampler, RaysGoFarInFewStepsAndHitWhatIsThere) {
  constexpr double kTolerance = 1e-5;
  for (const auto& [name, grid] : test::rough_grids()) {
    const Atlas atlas = make_atlas(grid, Job());
    const auto sampler = make_sampler(grid, Job());
    const Field field = make_field(sampler);
    const FieldTracer tracer(field, field.bounds());
    Points point(grid, 1);
    Points outside(grid, 8);
    std::vector<Ray> rays(3000);
    for (Ray& ray : rays) {
      do ray.origin = outside();
      while (distance_at(atlas, ray.origin) < atlas.lattice.voxel);
      ray.direction = glm::normalize(point() - ray.origin);
    }
    std::vector<float> depth(rays.size());
    tracer.trace(rays, kTolerance, depth, {});
    int hits = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      // No more is hit, and none of it sooner, than where the surface is as near as the tolerance.
      if (std::isfinite(depth[i])) {
        const glm::dvec3 there = rays[i].origin + double(depth[i]) * rays[i].direction;
        ASSERT_LE(sampler->value(there),
                  3 * (kTolerance * depth[i] + kFieldSlack * reach({there, there})))
            << name << " " << i;
      }
      const auto hit = trace_ray(atlas, rays[i]);
      if (!hit) continue;
      ++hits;
      ASSERT_LE(depth[i], *hit * (1 + 3e-5)) << name << " " << i;
    }
    EXPECT_GT(hits, 100) << name;
  }
  const Field balls = make_field(make_sampler(two_balls(), Job()));
  const Box box = balls.bounds();
  const FieldTracer tracer(balls, box);
  std::vector<Ray> rays;
  for (int i = 0; i < 1000; ++i) {  // between the balls, across and along
    const double u = 0.002 * i - 1;
    rays.push_back({{u, -0.3 * u, -10}, {0, 0, 1}});
    rays.push_back({{u, 0.7, -10}, glm::normalize(glm::dvec3(0.3, 0, 1))});
  }
  std::vector<float> depth(rays.size());
  std::vector<std::uint32_t> steps(rays.size());
  tracer.trace(rays, kTolerance, depth, steps);
  EXPECT_LT(std::accumulate(steps.begin(), steps.end(), 0U), 8 * rays.size());
}

}  // namespace
}  // namespace sdfgrid
