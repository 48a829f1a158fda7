#include "sdfgrid/grid/steepened.h"

#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <cmath>

#include "sdfgrid/grid/vdb.h"

namespace sdfgrid {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
using Accessor = openvdb::FloatGrid::ConstAccessor;

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

// Whether more than a fifth of the voxels that have a neighbour on the other side are gentle.
bool is_gentle(const openvdb::FloatGrid& grid, double voxel) {
  std::size_t beside = 0;
  std::size_t gentle = 0;
  const Accessor values = grid.getConstAccessor();
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    for (auto it = leaf->cbeginValueOn(); it; ++it) {
      const openvdb::Coord at = it.getCoord();
      const bool in = *it < 0;
      if ((values.getValue(at.offsetBy(1, 0, 0)) < 0) == in &&
          (values.getValue(at.offsetBy(0, 1, 0)) < 0) == in &&
          (values.getValue(at.offsetBy(0, 0, 1)) < 0) == in) {
        continue;
      }
      ++beside;
      if (slope_at(values, at, voxel) < 0.7) ++gentle;
    }
  }
  return 5 * gentle > beside;
}

}  // namespace

Grid steepened(const Grid& grid) {
  const openvdb::FloatGrid::Ptr from = vdb(grid);
  const double voxel = grid.lattice().voxel;
  if (!is_gentle(*from, voxel)) return grid;
  const openvdb::FloatGrid::Ptr to = from->deepCopy();
  const float most = from->background();
  openvdb::tree::LeafManager<openvdb::FloatTree> leaves(to->tree());
  leaves.foreach ([&](Leaf& leaf, std::size_t) {
    const Accessor values = from->getConstAccessor();
    for (auto it = leaf.beginValueOn(); it; ++it) {
      const double d = *it / std::max(slope_at(values, it.getCoord(), voxel), 1e-6);
      it.setValue(std::clamp(static_cast<float>(d), -most, most));
    }
  });
  return from_vdb(to);
}

}  // namespace sdfgrid
