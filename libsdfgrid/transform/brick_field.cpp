#include "sdfgrid/transform/brick_field.h"

#include "sdfgrid/core/error.h"

namespace sdfgrid {
namespace {

std::uint64_t key(const glm::ivec3& v) {
  const auto part = [](int c) { return static_cast<std::uint64_t>(c + (1 << 20)) & 0x1fffffU; };
  return part(v.x) << 42U | part(v.y) << 21U | part(v.z);
}

glm::ivec3 along(int axis, int by) {
  glm::ivec3 step(0);
  step[axis] = by;
  return step;
}

}  // namespace

std::uint32_t BrickField::find(const glm::ivec3& coordinate) const {
  const auto found = numbers_.find(key(coordinate));
  return found == numbers_.end() ? kNowhere : found->second;
}

std::uint32_t BrickField::make(const glm::ivec3& coordinate) {
  const auto [found, is_new] = numbers_.try_emplace(key(coordinate), size());
  if (!is_new) return found->second;
  const std::uint32_t brick = size();
  if (brick == kMostBricks) {
    throw Error(ErrorKind::failed, "the band needs more than 2^31 samples; use a larger voxel");
  }
  coordinates_.push_back(coordinate);
  neighbors_.emplace_back();
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const std::uint32_t below = find(coordinate + along(axis, -1));
    const std::uint32_t above = find(coordinate + along(axis, 1));
    neighbors_[brick][a] = {below, brick, above};
    if (below != kNowhere) neighbors_[below][a][2] = brick;
    if (above != kNowhere) neighbors_[above][a][0] = brick;
  }
  return brick;
}

std::uint32_t BrickField::step_making(std::uint32_t sample, int axis, int by) {
  const std::uint32_t there = step(sample, axis, by);
  if (!nowhere(there)) return there;
  make(coordinates_[sample >> 9] + along(axis, by < 0 ? -1 : 1));
  return step(sample, axis, by);
}

}  // namespace sdfgrid
