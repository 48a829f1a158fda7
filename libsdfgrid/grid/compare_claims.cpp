#include "sdfgrid/grid/compare_claims.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/vdb.h"

namespace sdfgrid {
namespace {

using openvdb::Coord;

// How often a draw is repeated that hit nothing fit.
constexpr int kTries = 32;

glm::dvec3 to_glm(const Coord& c) { return {c.x(), c.y(), c.z()}; }

// The eight corners of the cell above `low` with their weights at `within`, in [0, 1]^3.
template <class Visit>
void for_each_corner(const Coord& low, const glm::dvec3& within, const Visit& visit) {
  for (int k = 0; k < 8; ++k) {
    double weight = 1;
    Coord corner = low;
    for (int a = 0; a < 3; ++a) {
      const int up = k >> a & 1;
      corner[a] += up;
      weight *= up != 0 ? within[a] : 1 - within[a];
    }
    visit(corner, weight);
  }
}

}  // namespace

CounterRandom::CounterRandom(std::uint64_t seed, std::uint64_t counter)
    : state_(seed * 0xd1342543de82ef95U + counter * 0x2545f4914f6cdd1dU) {
  next();
}

std::uint64_t CounterRandom::next() {
  std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31);
}

double CounterRandom::unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }

std::size_t CounterRandom::below(std::size_t count) {
  return std::min(count - 1, static_cast<std::size_t>(unit() * static_cast<double>(count)));
}

GridClaims::GridClaims(const Grid& grid)
    : grid_(vdb(grid)),
      lattice_(grid.lattice()),
      signed_(grid.is_level_set()),
      outer_background_(grid.background()),
      inner_background_(std::numeric_limits<double>::infinity()) {
  first_.push_back(0);
  for (auto leaf = grid_->tree().cbeginLeaf(); leaf; ++leaf) {
    leaves_.push_back(leaf.getLeaf());
    first_.push_back(first_.back() + leaf->onVoxelCount());
    openvdb::CoordBBox box = leaf->getNodeBoundingBox();
    around_.expand(box);
  }
  if (active_voxels() == 0) {
    throw Error(ErrorKind::input,
                "the grid has no active voxels to compare; convert the mesh again");
  }
  around_.expand(8);
  active_tiles_ = grid_->tree().activeTileCount();
  find_inner_background();
}

// The value that stands for "deep inside" is nowhere written down: it is in the first inactive
// voxel or tile that is negative.
void GridClaims::find_inner_background() {
  if (!signed_) return;
  auto tile = grid_->tree().cbeginValueOff();
  tile.setMaxDepth(Tree::ValueOffCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    if (*tile < 0) {
      inner_background_ = -*tile;
      return;
    }
  }
  for (const Tree::LeafNodeType* leaf : leaves_) {
    for (auto off = leaf->cbeginValueOff(); off; ++off) {
      if (*off < 0) {
        inner_background_ = -*off;
        return;
      }
    }
  }
}

bool GridClaims::beyond(double value) const {
  return value >= outer_background_ || value <= -inner_background_;
}

bool GridClaims::is_background(double value) const {
  return value == outer_background_ || value == -inner_background_;
}

openvdb::Coord GridClaims::active_voxel(std::size_t k) const {
  const auto above = std::upper_bound(first_.begin(), first_.end(), k);
  const auto leaf = static_cast<std::size_t>(above - first_.begin()) - 1;
  auto on = leaves_[leaf]->cbeginValueOn();
  for (std::size_t skip = k - first_[leaf]; skip > 0; --skip) ++on;
  return on.getCoord();
}

Claim GridClaims::stored(const Coord& at, float value, bool active) const {
  return {lattice_.to_world(to_glm(at)), value, !active || beyond(value), signed_};
}

Claim GridClaims::at_voxel(std::size_t i, std::size_t count, std::uint64_t seed) const {
  // Sample i is drawn from the i-th of `count` equal parts of the voxels' numbers.
  CounterRandom random(seed, i);
  const double part = static_cast<double>(active_voxels()) / static_cast<double>(count);
  const double at = count == active_voxels() ? static_cast<double>(i)
                                             : (static_cast<double>(i) + random.unit()) * part;
  const Coord voxel = active_voxel(std::min(static_cast<std::size_t>(at), active_voxels() - 1));
  return stored(voxel, grid_->tree().getValue(voxel), true);
}

std::optional<Claim> GridClaims::in_cell(std::size_t i, std::size_t count,
                                         std::uint64_t seed) const {
  CounterRandom random(seed, i);
  const Accessor accessor = grid_->getConstUnsafeAccessor();
  const double part = static_cast<double>(active_voxels()) / static_cast<double>(count);
  auto k = static_cast<std::size_t>((static_cast<double>(i) + random.unit()) * part);
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const Coord low = active_voxel(std::min(k, active_voxels() - 1));
    const double x = random.unit();
    const double y = random.unit();
    const glm::dvec3 within(x, y, random.unit());
    double value = 0;
    bool fit = true;
    for_each_corner(low, within, [&](const Coord& corner, double weight) {
      float v = 0;
      fit = accessor.probeValue(corner, v) && !beyond(v) && fit;
      value += weight * v;
    });
    if (fit) return Claim{lattice_.to_world(to_glm(low) + within), value, false, signed_};
    k = random.below(active_voxels());
  }
  return std::nullopt;
}

std::optional<Claim> GridClaims::beyond_band(std::size_t i, std::size_t count,
                                             std::uint64_t seed) const {
  CounterRandom random(seed, i);
  const Accessor accessor = grid_->getConstUnsafeAccessor();
  for (int attempt = 0; attempt < kTries; ++attempt) {
    Coord at;
    if (i < count / 2) {
      const auto* leaf = leaves_[random.below(leaves_.size())];
      at = leaf->offsetToGlobalCoord(
          static_cast<openvdb::Index>(random.below(Tree::LeafNodeType::SIZE)));
    } else {
      for (int a = 0; a < 3; ++a) {
        const auto length = static_cast<std::size_t>(around_.dim()[a]);
        at[a] = around_.min()[a] + static_cast<int>(random.below(length));
      }
    }
    float value = 0;
    if (!accessor.probeValue(at, value)) return stored(at, value, false);
  }
  return std::nullopt;
}

Claim GridClaims::at(const glm::dvec3& world) const {
  const Accessor accessor = grid_->getConstUnsafeAccessor();
  const glm::dvec3 index = lattice_.to_index(world);
  Coord low;
  for (int a = 0; a < 3; ++a) low[a] = static_cast<int>(std::floor(index[a]));
  Claim claim{world, 0, false, signed_};
  double weights = 0;
  for_each_corner(low, index - to_glm(low), [&](const Coord& corner, double weight) {
    if (weight == 0) return;
    float v = 0;
    const bool bound = !accessor.probeValue(corner, v) || beyond(v);
    // A place on a voxel is beside it by rounding: its neighbours' bounds have no say then.
    constexpr double kNothing = 1e-6;
    if (bound && weight < kNothing) return;
    claim.at_least = claim.at_least || bound;
    claim.value += weight * v;
    weights += weight;
  });
  claim.value /= weights;
  return claim;
}

}  // namespace sdfgrid
