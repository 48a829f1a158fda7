#include "sdfgrid/grid/atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <limits>
#include <numeric>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/memory.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/atlas_kernel.h"
#include "sdfgrid/grid/atlas_tables.h"
#include "sdfgrid/grid/vdb.h"

namespace sdfgrid {
namespace {

using Tree = openvdb::FloatTree;
using Leaf = Tree::LeafNodeType;

// Places in the tables must fit the 32 bits of a vector's lane.
constexpr double kMaxTableBytes = 3e9;

openvdb::Coord corner(const glm::ivec3& brick) { return {brick.x * 8, brick.y * 8, brick.z * 8}; }

glm::ivec3 brick_of(const openvdb::Coord& c) { return {c.x() >> 3, c.y() >> 3, c.z() >> 3}; }

// Rays look at samples all over memory: with pages of 4 kB most looks miss the table of pages.
template <class T>
void resize_in_large_pages(std::vector<T>& values, std::size_t size) {
  values.reserve(size + size / 8);  // edits add bricks; what is not used takes no memory
  prefer_large_pages(values.data(), values.capacity() * sizeof(T));
  values.resize(size);
}

// Makes an Atlas from a tree; keeps what only the making needs.
class Builder {
 public:
  Builder(const Grid& grid, const Job& job) : tree_(vdb(grid)->tree()), job_(job) {
    atlas_.lattice = grid.lattice();
    atlas_.outside = static_cast<float>(tree_.background() / atlas_.lattice.voxel);
    atlas_.inside = -atlas_.outside;
    tree_.getNodes(leaves_);
  }

  Atlas build() {
    find_extent();
    if (atlas_.dims.x == 0) return std::move(atlas_);
    mark_slots();
    add_bricks_at_sign_changes();
    crossing_first();
    fill_bricks();
    fill_jumps(atlas_, job_);
    return std::move(atlas_);
  }

 private:
  void find_extent();
  void mark_slots();
  void add_bricks_at_sign_changes();
  void crossing_first();
  void fill_bricks();
  bool changes_sign(const glm::ivec3& slot) const;
  void fill(const openvdb::tree::ValueAccessor<const Tree>& values, const glm::ivec3& slot,
            float* out) const;
  const Leaf* leaf_at(const glm::ivec3& slot) const;

  const Tree& tree_;
  const Job& job_;
  Atlas atlas_;
  std::vector<const Leaf*> leaves_;
  std::vector<glm::ivec3> slots_;   // of each leaf, then of the other bricks
  std::vector<std::size_t> order_;  // which of them each brick of the atlas is
};

// The box of all leaves and all tiles inside, and one slot before it: a cell between index 8 b - 1
// and 8 b belongs to the brick before b.
void Builder::find_extent() {
  glm::ivec3 lo(std::numeric_limits<int>::max());
  glm::ivec3 hi(std::numeric_limits<int>::min());
  const auto add = [&](const openvdb::Coord& first, const openvdb::Coord& last) {
    lo = glm::min(lo, brick_of(first) - 1);
    hi = glm::max(hi, brick_of(last));
  };
  for (const Leaf* leaf : leaves_) add(leaf->origin(), leaf->origin());
  auto tile = tree_.cbeginValueAll();
  tile.setMaxDepth(Tree::ValueAllCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    if (!(*tile < 0)) continue;
    const openvdb::CoordBBox box = tile.getBoundingBox();
    add(box.min(), box.max());
    atlas_.inside = static_cast<float>(*tile / atlas_.lattice.voxel);
  }
  if (lo.x > hi.x) return;
  const glm::dvec3 extent = glm::dvec3(hi) - glm::dvec3(lo) + 1.0;
  const double bytes = (sizeof(std::int32_t) + Atlas::kJumpTables) * extent.x * extent.y * extent.z;
  if (bytes > kMaxTableBytes) {
    throw Error(ErrorKind::failed,
                fmt::format("tracing this grid needs tables of {:.1f} GB ({} x {} x {} bricks), "
                            "more than {:.1f} GB; use a coarser voxel or crop the grid",
                            bytes * 1e-9, extent.x, extent.y, extent.z, kMaxTableBytes * 1e-9));
  }
  atlas_.lo = lo;
  atlas_.dims = hi - lo + 1;
}

void Builder::mark_slots() {
  const glm::ivec3 dims = atlas_.dims;
  atlas_.bricks.resize(static_cast<std::size_t>(dims.x) * dims.y * dims.z);
  slots_.resize(leaves_.size());
  parallel_for(
      "atlas", static_cast<std::size_t>(dims.x), 1, job_, [&](std::size_t begin, std::size_t end) {
        const openvdb::tree::ValueAccessor<const Tree> values(tree_);
        for (int x = int(begin); x < int(end); ++x) {
          for (int y = 0; y < dims.y; ++y) {
            for (int z = 0; z < dims.z; ++z) {
              const bool inside = values.getValue(corner(atlas_.lo + glm::ivec3(x, y, z))) < 0;
              atlas_.bricks[atlas_.place({x, y, z})] = inside ? Atlas::kInside : Atlas::kOutside;
            }
          }
        }
      });
  for (std::size_t i = 0; i < leaves_.size(); ++i) {
    slots_[i] = brick_of(leaves_[i]->origin()) - atlas_.lo;
    atlas_.bricks[atlas_.place(slots_[i])] = static_cast<std::int32_t>(i);
  }
}

const Leaf* Builder::leaf_at(const glm::ivec3& slot) const {
  const glm::ivec3 dims = atlas_.dims;
  if (slot.x < 0 || slot.y < 0 || slot.z < 0 || slot.x >= dims.x || slot.y >= dims.y ||
      slot.z >= dims.z) {
    return nullptr;
  }
  const std::int32_t brick = atlas_.bricks[atlas_.place(slot)];
  // Bricks beyond the leaves were added: no leaf is there.
  return brick >= 0 && std::size_t(brick) < leaves_.size() ? leaves_[brick] : nullptr;
}

// Whether the field changes sign in the cells of a slot without a leaf: between its own value and
// the samples that it shares with the seven slots after it.
bool Builder::changes_sign(const glm::ivec3& slot) const {
  const bool inside = atlas_.bricks[atlas_.place(slot)] == Atlas::kInside;
  for (int n = 1; n < 8; ++n) {
    const glm::ivec3 step(n >> 2, (n >> 1) & 1, n & 1);
    const glm::ivec3 other = slot + step;
    const Leaf* leaf = leaf_at(other);
    if (leaf == nullptr) {
      const bool beyond =
          other.x >= atlas_.dims.x || other.y >= atlas_.dims.y || other.z >= atlas_.dims.z;
      const bool other_inside = !beyond && atlas_.bricks[atlas_.place(other)] == Atlas::kInside;
      if (other_inside != inside) return true;
      continue;
    }
    const float* values = leaf->buffer().data();
    for (int x = 0; x < (step.x != 0 ? 1 : 8); ++x) {
      for (int y = 0; y < (step.y != 0 ? 1 : 8); ++y) {
        for (int z = 0; z < (step.z != 0 ? 1 : 8); ++z) {
          if ((values[(x << 6) | (y << 3) | z] < 0) != inside) return true;
        }
      }
    }
  }
  return false;
}

void Builder::add_bricks_at_sign_changes() {
  const glm::ivec3 dims = atlas_.dims;
  std::vector<std::vector<glm::ivec3>> found(static_cast<std::size_t>(dims.x));
  parallel_for(found.size(), 1, job_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t x = begin; x < end; ++x) {
      for (int y = 0; y < dims.y; ++y) {
        for (int z = 0; z < dims.z; ++z) {
          const glm::ivec3 slot(int(x), y, z);
          if (atlas_.bricks[atlas_.place(slot)] < 0 && changes_sign(slot)) found[x].push_back(slot);
        }
      }
    }
  });
  for (const auto& plane : found) slots_.insert(slots_.end(), plane.begin(), plane.end());
  for (std::size_t i = leaves_.size(); i < slots_.size(); ++i) {
    atlas_.bricks[atlas_.place(slots_[i])] = static_cast<std::int32_t>(i);
  }
}

// Copies the 9^3 samples of a slot from the eight blocks that they lie in.
void Builder::fill(const openvdb::tree::ValueAccessor<const Tree>& values, const glm::ivec3& slot,
                   float* out) const {
  for (int n = 0; n < 8; ++n) {
    const glm::ivec3 at = slot + glm::ivec3(n >> 2, n >> 1 & 1, n & 1);
    const Leaf* leaf = leaf_at(at);
    const float* from = leaf != nullptr ? leaf->buffer().data() : nullptr;
    const float tile = leaf == nullptr ? values.getValue(corner(atlas_.lo + at)) : 0.0F;
    copy_part(from, tile, 1 / atlas_.lattice.voxel, n, out);
  }
}

// Orders the bricks so that the crossing ones, which are all that rays look at, come first.
void Builder::crossing_first() {
  std::vector<BrickRange> ranges(slots_.size(), BrickRange(SampleSurvey{}));
  parallel_for(slots_.size(), 64, job_, [&](std::size_t begin, std::size_t end) {
    const openvdb::tree::ValueAccessor<const Tree> values(tree_);
    float samples[Atlas::kSamples] = {};
    for (std::size_t i = begin; i < end; ++i) {
      fill(values, slots_[i], samples);
      SampleSurvey survey;
      atlas_kernel().survey(samples, 0, survey);
      ranges[i] = BrickRange(survey);
    }
  });
  for (const BrickRange& range : ranges) atlas_.slope = std::max(atlas_.slope, range.slope);
  const float margin = atlas_.margin();
  std::vector<std::size_t> order(slots_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto rest = std::stable_partition(
      order.begin(), order.end(), [&](std::size_t i) { return ranges[i].crossing(margin); });
  atlas_.crossing = static_cast<std::int32_t>(rest - order.begin());
  order_ = std::move(order);
}

void Builder::fill_bricks() {
  resize_in_large_pages(atlas_.samples, order_.size() * Atlas::kSamples);
  resize_in_large_pages(atlas_.hops, std::size_t(atlas_.crossing) * Atlas::kHops);
  parallel_for("atlas", order_.size(), 64, job_, [&](std::size_t begin, std::size_t end) {
    const openvdb::tree::ValueAccessor<const Tree> values(tree_);
    for (std::size_t i = begin; i < end; ++i) {
      float* samples = atlas_.samples.data() + i * Atlas::kSamples;
      fill(values, slots_[order_[i]], samples);
      if (i < std::size_t(atlas_.crossing)) {
        SampleSurvey survey;
        atlas_kernel().survey(samples, atlas_.margin(), survey);
        atlas_kernel().hops(survey.crossing, atlas_.hops.data() + i * Atlas::kHops);
      }
    }
  });
  // Only now: while bricks are filled, the slots name leaves.
  for (std::size_t i = 0; i < order_.size(); ++i) {
    atlas_.bricks[atlas_.place(slots_[order_[i]])] = static_cast<std::int32_t>(i);
  }
}

}  // namespace

float Atlas::value(const glm::ivec3& index) const {
  const glm::ivec3 slot = (index >> 3) - lo;
  if (slot.x < 0 || slot.y < 0 || slot.z < 0 || slot.x >= dims.x || slot.y >= dims.y ||
      slot.z >= dims.z) {
    return outside;
  }
  const std::int32_t brick = bricks[place(slot)];
  if (brick < 0) return brick == kInside ? inside : outside;
  const glm::ivec3 at = index & 7;
  return samples[std::size_t(brick) * kSamples + (at.x * kEdge + at.y) * kEdge + at.z];
}

Atlas make_atlas(const Grid& grid, const Job& job) { return Builder(grid, job).build(); }

}  // namespace sdfgrid
