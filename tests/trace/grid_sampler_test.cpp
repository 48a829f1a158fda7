// Grids as leaves of fields, over grids that are hard on them.
#include "sdfgrid/trace/grid_sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/vdb.h"
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

TEST(GridSampler, NoGridIsSteeperThanOne) {
  for (const auto& [name, grid] : test::rough_grids()) {
    const auto sampler = make_sampler(grid, Job());
    const double voxel = grid.lattice().voxel;
    Points point(grid, 3);
    for (int i = 0; i < 60000; ++i) {
      const glm::dvec3 p = point();
      const double steps[] = {1000 * voxel, 8 * voxel, 0.3 * voxel, 0.01 * voxel};
      const glm::dvec3 q = i % 5 == 4 ? point() : point.near(p, steps[i % 5]);
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

}  // namespace
}  // namespace sdfgrid
