// transform/brick_field.h: numbers at samples in bricks of 8^3 that are made where they are needed,
// so that work and memory follow the front and not the box (not installed).
//
// A sample is number brick * 512 + (x * 8 + y) * 8 + z. Neighbours in memory are neighbours in
// space more often than in rows, and steps over a brick's side go by a table.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <unordered_map>
#include <vector>

namespace sdfgrid {

class BrickField {
 public:
  static constexpr std::uint32_t kNowhere = 0;            // the brick that stands for missing ones
  static constexpr std::uint32_t kMostBricks = 1U << 22;  // 2^31 samples

  BrickField() : coordinates_(1), neighbors_(1) {}

  // The number of the brick at `coordinate` (index / 8, rounded down), made if there is none.
  // Throws Error{failed} beyond kMostBricks.
  std::uint32_t make(const glm::ivec3& coordinate);
  // kNowhere if there is none.
  [[nodiscard]] std::uint32_t find(const glm::ivec3& coordinate) const;
  // Bricks, with the one at 0.
  [[nodiscard]] std::uint32_t size() const {
    return static_cast<std::uint32_t>(coordinates_.size());
  }
  [[nodiscard]] std::size_t samples() const { return static_cast<std::size_t>(size()) * 512; }
  // Of each brick nine: along each axis the brick below, itself, the one above.
  [[nodiscard]] const std::uint32_t* neighbors() const { return neighbors_[0][0].data(); }
  [[nodiscard]] const glm::ivec3& coordinate(std::uint32_t brick) const {
    return coordinates_[brick];
  }
  // Index of a sample.
  [[nodiscard]] glm::ivec3 index(std::uint32_t sample) const {
    const auto s = static_cast<int>(sample);
    return coordinates_[sample >> 9] * 8 + glm::ivec3(s >> 6 & 7, s >> 3 & 7, s & 7);
  }

  // The sample `by` steps (at most 8 either way) along an axis; a sample of kNowhere where that
  // brick is missing.
  [[nodiscard]] std::uint32_t step(std::uint32_t sample, int axis, int by) const {
    const int shift = 6 - 3 * axis;
    const std::uint32_t digit = (sample >> shift & 7U) + 8U + static_cast<std::uint32_t>(by);
    const std::uint32_t brick = neighbors_[sample >> 9][axis][digit >> 3];
    return brick << 9 | (sample & 511U & ~(7U << shift)) | (digit & 7U) << shift;
  }
  [[nodiscard]] static bool nowhere(std::uint32_t sample) { return sample < 512; }
  // The same; a missing brick is made.
  std::uint32_t step_making(std::uint32_t sample, int axis, int by);

 private:
  std::vector<glm::ivec3> coordinates_;
  using Neighbors = std::array<std::array<std::uint32_t, 3>, 3>;  // axis; below, itself, above
  std::vector<Neighbors> neighbors_;
  std::unordered_map<std::uint64_t, std::uint32_t> numbers_;
};

}  // namespace sdfgrid
