#include "sdfgrid/grid/bricks.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <tuple>

#include "sdfgrid/grid/paint.h"
#include "sdfgrid/grid/vdb.h"

namespace sdfgrid {
namespace {

using Tree = openvdb::FloatTree;
using Leaf = Tree::LeafNodeType;
using Node = Tree::RootNodeType::ChildNodeType::ChildNodeType;  // the leaves' parent

openvdb::Coord corner(const glm::ivec3& brick) { return {brick.x * 8, brick.y * 8, brick.z * 8}; }

GridBrick view(Leaf& leaf) {
  return {leaf.buffer().data(), &leaf.getValueMask().getWord<openvdb::Index64>(0), 0.0F};
}

}  // namespace

// Remembers inner nodes only, which drop() leaves in place, and no leaves, which it deletes.
struct GridBricks::Access {
  explicit Access(Tree& tree) : values(tree) {}
  openvdb::tree::ValueAccessor2<Tree, true, 1, 2> values;
};

GridBricks::GridBricks(const Grid& grid)
    : grid_(grid), access_(std::make_unique<Access>(vdb(grid)->tree())) {}

GridBricks::GridBricks(const GridBricks& other) : GridBricks(other.grid_) {}

GridBricks::~GridBricks() { finish(); }

GridBrick GridBricks::find(const glm::ivec3& brick) const {
  const openvdb::Coord at = corner(brick);
  const Node* node = access_->values.probeNode<Node>(at);
  if (node == nullptr) return {nullptr, nullptr, access_->values.getValue(at)};
  const openvdb::Index place = Node::coordToOffset(at);
  const auto& entry = node->getTable()[place];
  if (node->isChildMaskOn(place)) return view(*entry.getChild());
  return {nullptr, nullptr, entry.getValue()};
}

void GridBricks::fetch_place(const glm::ivec3& brick) const {
  const openvdb::Coord at = corner(brick);
  const Node* node = access_->values.probeNode<Node>(at);
  if (node == nullptr) return;
  const openvdb::Index place = Node::coordToOffset(at);
  __builtin_prefetch(&node->getTable()[place]);
  __builtin_prefetch(reinterpret_cast<const char*>(&node->getChildMask()) + place / 8);
}

void GridBricks::fetch(const glm::ivec3& brick) const {
  const openvdb::Coord at = corner(brick);
  const Node* node = access_->values.probeNode<Node>(at);
  if (node == nullptr) return;
  const openvdb::Index place = Node::coordToOffset(at);
  if (!node->isChildMaskOn(place)) return;
  constexpr std::size_t kLine = 64;
  const auto* leaf = reinterpret_cast<const char*>(node->getTable()[place].getChild());
  for (std::size_t i = 0; i < sizeof(Leaf); i += kLine) __builtin_prefetch(leaf + i);
}

GridBrick GridBricks::make(const glm::ivec3& brick) {
  return view(*access_->values.touchLeaf(corner(brick)));
}

GridBrick GridBricks::make_unset(const glm::ivec3& brick) {
  const GridBrick now = find(brick);
  if (now.values != nullptr) return now;
  auto leaf = std::make_unique<Leaf>(openvdb::PartialCreate(), corner(brick));
  leaf->allocate();
  access_->values.addLeaf(leaf.get());
  return view(*leaf.release());
}

void GridBricks::drop(const glm::ivec3& brick, float value) {
  access_->values.addTile(1, corner(brick), value, false);
  dropped_ = true;
}

void GridBricks::finish() {
  if (dropped_) access_->values.tree().clearAllAccessors();
  dropped_ = false;
}

const std::int32_t* GridBricks::paint(const glm::ivec3& brick) const {
  const openvdb::Int32Grid::Ptr& paint = grid_.storage().paint;
  const auto* leaf = paint ? paint->tree().probeConstLeaf(corner(brick)) : nullptr;
  return leaf != nullptr ? leaf->buffer().data() : nullptr;
}

void GridBricks::set_paint(const glm::ivec3& brick, const std::int32_t* materials) {
  openvdb::Int32Grid::Ptr& paint = grid_.storage().paint;
  const auto painted = [](std::int32_t material) { return material != 0; };
  if (materials == nullptr || std::none_of(materials, materials + kBrickSamples, painted)) {
    if (paint) paint->tree().addTile(1, corner(brick), 0, false);
    return;
  }
  if (!paint) {
    paint = openvdb::Int32Grid::create(0);
    paint->setTransform(vdb(grid_)->transform().copy());
    paint->setName(kPaintName);
  }
  auto* leaf = paint->tree().touchLeaf(corner(brick));
  for (int i = 0; i < kBrickSamples; ++i) {
    leaf->setValueOnly(i, materials[i]);
    leaf->setActiveState(i, painted(materials[i]));
  }
}

std::vector<glm::ivec3> all_bricks(const Grid& grid) {
  std::vector<glm::ivec3> bricks;
  const Tree& tree = vdb(grid)->tree();
  bricks.reserve(tree.leafCount());
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    const openvdb::Coord at = leaf->origin();
    bricks.emplace_back(at.x() >> 3, at.y() >> 3, at.z() >> 3);
  }
  return bricks;
}

namespace {

// The bricks of a box that a part of the tree holds.
class BrickFinder {
 public:
  BrickFinder(const glm::ivec3& first, const glm::ivec3& last, float outside)
      : first_(first), last_(last), outside_(outside) {}

  void add_node(const Tree::RootNodeType& root) {
    for (auto tile = root.cbeginValueAll(); tile; ++tile) {
      add_tile(tile.getCoord(), Tree::RootNodeType::ChildNodeType::DIM, *tile);
    }
    for (auto child = root.cbeginChildOn(); child; ++child) add_node(*child);
  }
  std::vector<glm::ivec3> take() {
    std::sort(found_.begin(), found_.end(), [](const glm::ivec3& a, const glm::ivec3& b) {
      return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
    });
    return std::move(found_);
  }

 private:
  template <class Inner>
  void add_node(const Inner& node) {
    if (!reaches(node.origin(), Inner::DIM)) return;
    using Child = typename Inner::ChildNodeType;
    for (openvdb::Index i = 0; i < Inner::NUM_VALUES; ++i) {
      const auto& entry = node.getTable()[i];
      if (!node.isChildMaskOn(i)) {
        if (entry.getValue() < outside_) {
          add_tile(node.offsetToGlobalCoord(i), Child::DIM, entry.getValue());
        }
      } else if constexpr (Child::LEVEL == 0) {
        add_box(node.offsetToGlobalCoord(i), 8);
      } else {
        add_node(*entry.getChild());
      }
    }
  }
  void add_tile(const openvdb::Coord& at, openvdb::Index size, float value) {
    if (value < outside_) add_box(at, size);
  }
  void add_box(const openvdb::Coord& at, openvdb::Index size) {
    const glm::ivec3 corner = glm::ivec3(at.x(), at.y(), at.z()) >> 3;
    const glm::ivec3 lo = glm::max(corner, first_);
    const glm::ivec3 hi = glm::min(corner + static_cast<int>(size / 8) - 1, last_);
    for (int x = lo.x; x <= hi.x; ++x) {
      for (int y = lo.y; y <= hi.y; ++y) {
        for (int z = lo.z; z <= hi.z; ++z) found_.emplace_back(x, y, z);
      }
    }
  }
  bool reaches(const openvdb::Coord& at, openvdb::Index size) const {
    const glm::ivec3 corner = glm::ivec3(at.x(), at.y(), at.z()) >> 3;
    return glm::all(glm::lessThanEqual(corner, last_)) &&
           glm::all(glm::greaterThanEqual(corner + static_cast<int>(size / 8) - 1, first_));
  }

  glm::ivec3 first_, last_;
  float outside_;
  std::vector<glm::ivec3> found_;
};

}  // namespace

std::vector<glm::ivec3> bricks_below(const Grid& grid, const glm::ivec3& first,
                                     const glm::ivec3& last, float outside) {
  BrickFinder finder(first, last, outside);
  finder.add_node(vdb(grid)->tree().root());
  return finder.take();
}

void compact(const Grid& grid) {
  vdb(grid)->tree().clearAllAccessors();
  vdb(grid)->pruneGrid();
  if (grid.storage().paint) grid.storage().paint->pruneGrid();
}

BandLimits band_limits(const Grid& grid) {
  const Tree& tree = vdb(grid)->tree();
  BandLimits limits{-tree.background(), tree.background()};
  auto tile = tree.cbeginValueOff();
  tile.setMaxDepth(Tree::ValueOffCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    if (*tile < 0) return {*tile, limits.outside};
  }
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    for (auto off = leaf->cbeginValueOff(); off; ++off) {
      if (*off < 0) return {*off, limits.outside};
    }
  }
  return limits;
}

}  // namespace sdfgrid
