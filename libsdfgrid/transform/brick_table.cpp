#include "sdfgrid/transform/brick_table.h"

#include <algorithm>
#include <tuple>

namespace sdfgrid {
namespace {

std::uint64_t node_key(const glm::ivec3& c) {
  const auto part = [](int v) { return static_cast<std::uint64_t>((v >> 4) + (1 << 20)); };
  return part(c.x) << 42U | part(c.y) << 21U | part(c.z);
}

std::size_t slot(const glm::ivec3& c) {
  return static_cast<std::size_t>(((c.x & 15) << 8) | ((c.y & 15) << 4) | (c.z & 15));
}

}  // namespace

BrickTable::BrickTable(std::vector<glm::ivec3> coordinates) : coordinates_(std::move(coordinates)) {
  const auto before = [](const glm::ivec3& a, const glm::ivec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  std::sort(coordinates_.begin(), coordinates_.end(), before);
  coordinates_.erase(std::unique(coordinates_.begin(), coordinates_.end()), coordinates_.end());
  for (std::size_t i = 0; i < coordinates_.size(); ++i) {
    std::unique_ptr<Node>& node = nodes_[node_key(coordinates_[i])];
    if (!node) {
      node = std::make_unique<Node>();
      node->fill(kNone);
    }
    (*node)[slot(coordinates_[i])] = static_cast<std::int32_t>(i);
  }
}

std::int32_t BrickTable::find(const glm::ivec3& coordinate) const {
  const auto node = nodes_.find(node_key(coordinate));
  return node == nodes_.end() ? kNone : (*node->second)[slot(coordinate)];
}

}  // namespace sdfgrid
