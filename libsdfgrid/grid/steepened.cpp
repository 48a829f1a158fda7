#include "sdfgrid/grid/steepened.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/vdb.h"

namespace sdfgrid {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
using Accessor = openvdb::FloatGrid::ConstAccessor;

constexpr std::size_t kLeavesPerTask = 32;

double slope_at(const Accessor& values, const openvdb::Coord& at, double voxel) {
  double squared = 0;
  for (int a = 0; a < 3; ++a) {
    openvdb::Coord step(0);
    step[a] = 1;
    const double d = values.getValue(at + step) - values.getValue(at - step);
    squared += d * d;
  }
  return std::sqrt(squared) / (2 * voxel);
}

bool beside_surface(const Accessor& values, const openvdb::Coord& at, bool inside) {
  return (values.getValue(at.offsetBy(1, 0, 0)) < 0) != inside ||
         (values.getValue(at.offsetBy(0, 1, 0)) < 0) != inside ||
         (values.getValue(at.offsetBy(0, 0, 1)) < 0) != inside;
}

// Whether more than a fifth of the voxels that have a neighbour on the other side are gentle.
bool is_gentle(const openvdb::FloatGrid& grid, double voxel, const Job& job) {
  std::vector<const Leaf*> leaves;
  grid.tree().getNodes(leaves);
  std::atomic<std::size_t> beside{0};
  std::atomic<std::size_t> gentle{0};
  parallel_for(leaves.size(), kLeavesPerTask, job, [&](std::size_t begin, std::size_t end) {
    const Accessor values = grid.getConstAccessor();
    std::size_t beside_here = 0;
    std::size_t gentle_here = 0;
    for (std::size_t i = begin; i < end; ++i) {
      for (auto it = leaves[i]->cbeginValueOn(); it; ++it) {
        if (!beside_surface(values, it.getCoord(), *it < 0)) continue;
        ++beside_here;
        if (slope_at(values, it.getCoord(), voxel) < 0.7) ++gentle_here;
      }
    }
    beside += beside_here;
    gentle += gentle_here;
  });
  return 5 * gentle > beside;
}

}  // namespace

Grid steepened(const Grid& grid, const Job& job) {
  const openvdb::FloatGrid::ConstPtr from = vdb(grid);
  const double voxel = grid.lattice().voxel;
  if (!is_gentle(*from, voxel, job)) return grid;
  const Grid result = grid.clone();
  const float most = from->background();
  std::vector<Leaf*> leaves;
  vdb(result)->tree().getNodes(leaves);
  parallel_for(leaves.size(), kLeavesPerTask, job, [&](std::size_t begin, std::size_t end) {
    const Accessor values = from->getConstAccessor();
    for (std::size_t i = begin; i < end; ++i) {
      for (auto it = leaves[i]->beginValueOn(); it; ++it) {
        const double d = *it / std::max(slope_at(values, it.getCoord(), voxel), 1e-6);
        it.setValue(std::clamp(static_cast<float>(d), -most, most));
      }
    }
  });
  return result;
}

}  // namespace sdfgrid
