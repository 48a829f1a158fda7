#include "trace/rough_grids.h"

#include <openvdb/tools/SignedFloodFill.h>

#include <functional>
#include <glm/geometric.hpp>
#include <random>

#include "sdfgrid/grid/vdb.h"

namespace sdfgrid::test {
namespace {

using Values = openvdb::FloatGrid::Accessor;

constexpr int kSide = 36;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()(double lo, double hi) {
    return lo + (hi - lo) * std::uniform_real_distribution<double>()(engine_);
  }
  int below(int n) { return static_cast<int>((*this)(0, n)); }

 private:
  std::mt19937_64 engine_;
};

openvdb::FloatGrid::Ptr empty_grid(double voxel, const glm::dvec3& origin) {
  auto grid = openvdb::FloatGrid::create(static_cast<float>(3 * voxel));
  auto transform = openvdb::math::Transform::createLinearTransform(voxel);
  transform->postTranslate({origin.x, origin.y, origin.z});
  grid->setTransform(transform);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

// Sets the samples of a cube that starts at `lo` to distance(index), in voxels.
void set_cube(openvdb::FloatGrid& grid, int lo, int side,
              const std::function<double(const glm::ivec3&)>& distance) {
  auto values = grid.getAccessor();
  const double voxel = grid.voxelSize()[0];
  for (int x = lo; x < lo + side; ++x) {
    for (int y = lo; y < lo + side; ++y) {
      for (int z = lo; z < lo + side; ++z) {
        const double d = distance({x, y, z});
        if (std::abs(d) < 3) values.setValue({x, y, z}, static_cast<float>(d * voxel));
      }
    }
  }
}

Grid spheres() {
  const auto grid = empty_grid(0.05, {-1, 2, 0.3});
  set_cube(*grid, -5, kSide, [](const glm::ivec3& p) {
    const double big = glm::length(glm::dvec3(p) - glm::dvec3(11.3, 9.8, 10.1)) - 8.4;
    const double small = glm::length(glm::dvec3(p) - glm::dvec3(22.1, 21.7, 23.2)) - 2.6;
    return std::min(big, small);
  });
  openvdb::tools::signedFloodFill(grid->tree());
  return from_vdb(grid);
}

Grid noise() {
  const auto grid = empty_grid(0.125, {3, 3, 3});
  Random random(11);
  set_cube(*grid, -9, kSide, [&](const glm::ivec3& p) {
    const int brick = (p.x >> 3) * 5 + (p.y >> 3) * 3 + (p.z >> 3);
    return brick % 3 == 0 ? 3 : random(brick % 2 == 0 ? -0.4 : -2.9, 2.9);
  });
  return from_vdb(grid);
}

// One layer of samples inside in each direction, on both sides of bricks' borders.
Grid plates() {
  const auto grid = empty_grid(1, {0, 0, 0});
  set_cube(*grid, 0, kSide, [](const glm::ivec3& p) {
    const bool rim = std::min({p.x, p.y, p.z}) < 2 || std::max({p.x, p.y, p.z}) > kSide - 3;
    if (rim) return 3.0;
    const bool inside = p.x == 15 || p.y == 16 || p.z == 7;
    return inside ? -0.01 : 0.9;
  });
  return from_vdb(grid);
}

Grid single_voxels() {
  const auto grid = empty_grid(0.3, {0.1, -7, 0});
  Random random(12);
  set_cube(*grid, -16, kSide,
           [&](const glm::ivec3&) { return random.below(40) == 0 ? -random(0.001, 2.9) : 2.9; });
  return from_vdb(grid);
}

// Features so faint that single precision could not tell them from nothing.
Grid crumbs() {
  const auto grid = empty_grid(2, {100, -50, 20});
  Random random(13);
  set_cube(*grid, 3, kSide, [&](const glm::ivec3&) {
    const double faint = std::pow(10.0, -random(1, 7));
    return random.below(12) == 0 ? -faint : random.below(3) == 0 ? faint : random(0.1, 1);
  });
  return from_vdb(grid);
}

// Tiles beyond the band beside each other with different signs, and leaves among them.
Grid caps() {
  const auto grid = empty_grid(0.5, {0, 1, 0});
  Random random(14);
  set_cube(*grid, 8, 16, [&](const glm::ivec3&) { return random(-2.9, 2.9); });
  for (int i = 0; i < 12; ++i) {
    const openvdb::Coord lo(8 * random.below(5) - 8, 8 * random.below(5), 8 * random.below(5));
    grid->tree().addTile(1, lo, -1.5F, false);
  }
  return from_vdb(grid);
}

}  // namespace

std::vector<NamedGrid> rough_grids() {
  openvdb::initialize();
  return {{"spheres", spheres()}, {"noise", noise()},
          {"plates", plates()},   {"single voxels", single_voxels()},
          {"crumbs", crumbs()},   {"caps", caps()}};
}

}  // namespace sdfgrid::test
