#include "sdfgrid/transform/brick_table.h"

#include <algorithm>
#include <utility>

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

// By nodes, and by place within them: sorting all bricks would take longer.
BrickTable::BrickTable(std::vector<glm::ivec3> coordinates) {
  constexpr std::int32_t kPresent = 0;
  std::uint64_t last_key = ~0ULL;
  Node* last = nullptr;
  std::vector<std::pair<std::uint64_t, glm::ivec3>> order;
  for (const glm::ivec3& c : coordinates) {
    const std::uint64_t key = node_key(c);
    if (key != last_key) {
      std::unique_ptr<Node>& node = nodes_[key];
      if (!node) {
        node = std::make_unique<Node>();
        node->fill(kNone);
        order.emplace_back(key, glm::ivec3(c.x & ~15, c.y & ~15, c.z & ~15));
      }
      last_key = key;
      last = node.get();
    }
    (*last)[slot(c)] = kPresent;
  }
  std::sort(order.begin(), order.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [key, origin] : order) {
    Node& node = *nodes_[key];
    for (int s = 0; s < static_cast<int>(node.size()); ++s) {
      std::int32_t& number = node[static_cast<std::size_t>(s)];
      if (number == kNone) continue;
      number = static_cast<std::int32_t>(coordinates_.size());
      coordinates_.push_back(origin + glm::ivec3(s >> 8, s >> 4 & 15, s & 15));
    }
  }
}

std::int32_t BrickTable::find(const glm::ivec3& coordinate) const {
  const auto node = nodes_.find(node_key(coordinate));
  return node == nodes_.end() ? kNone : (*node->second)[slot(coordinate)];
}

}  // namespace sdfgrid
