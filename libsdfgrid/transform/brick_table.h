// transform/brick_table.h: numbers of bricks by their place, in memory that follows the bricks and
// not their box (not installed).
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <unordered_map>
#include <vector>

namespace sdfgrid {

// Bricks by their coordinates (index / 8), in an order that depends on nothing but the set of them.
class BrickTable {
 public:
  static constexpr std::int32_t kNone = -1;

  // Takes coordinates in any order, repeated or not.
  explicit BrickTable(std::vector<glm::ivec3> coordinates);

  [[nodiscard]] std::size_t size() const { return coordinates_.size(); }
  [[nodiscard]] const std::vector<glm::ivec3>& coordinates() const { return coordinates_; }
  [[nodiscard]] std::int32_t find(const glm::ivec3& coordinate) const;

 private:
  static constexpr int kNode = 16;  // bricks a side of one table
  using Node = std::array<std::int32_t, kNode * kNode * kNode>;

  std::vector<glm::ivec3> coordinates_;
  std::unordered_map<std::uint64_t, std::unique_ptr<Node>> nodes_;
};

}  // namespace sdfgrid
