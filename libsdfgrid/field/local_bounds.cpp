#include "sdfgrid/field/local_bounds.h"

#include <algorithm>
#include <cmath>

namespace sdfgrid {
namespace {

constexpr double kLeast = 1e-6;  // slopes are never taken for less: a step stays finite
constexpr double kGain = 1.1;

std::size_t cells_of(int level) { return std::size_t{1} << (3 * level); }

}  // namespace

LocalBounds::LocalBounds(Field field, const Box& region, int levels)
    : field_(std::move(field)), region_(region), levels_(std::clamp(levels, 1, 7)) {
  for (int level = 0; level < levels_; ++level) {
    slopes_.push_back(std::make_unique<Slope[]>(cells_of(level)));
  }
}

Box LocalBounds::box(const glm::ivec3& cell, int level) const {
  const glm::dvec3 edge = region_.size() / static_cast<double>(1 << level);
  const glm::dvec3 lo = region_.lo + edge * glm::dvec3(cell);
  return {lo, lo + edge};
}

float LocalBounds::slope(const glm::ivec3& cell, int level) const {
  const std::size_t side = std::size_t{1} << level;
  Slope& known = slopes_[level][(cell.x * side + cell.y) * side + cell.z];
  float value = known.load(std::memory_order_relaxed);
  if (value != 0) return value;
  const Box b = box(cell, level);
  const double bound = std::max(field_.slope(b), kLeast);
  const glm::dvec3 middle = b.center();
  const bool split = level + 1 < levels_ && bound > kGain * field_.slope({middle, middle});
  // Rounded up to float.
  value = std::nextafter(static_cast<float>(bound), 2.0F);
  value = split ? -value : value;
  known.store(value, std::memory_order_relaxed);
  return value;
}

LocalBounds::Cell LocalBounds::at(const glm::dvec3& p) const {
  const glm::dvec3 unit = (p - region_.lo) / region_.size();
  float s = 0;
  glm::ivec3 cell(0);
  int level = 0;
  for (;; ++level) {
    const int side = 1 << level;
    for (int a = 0; a < 3; ++a) {
      cell[a] = std::clamp(static_cast<int>(unit[a] * side), 0, side - 1);
    }
    s = slope(cell, level);
    if (s > 0) break;
  }
  return {box(cell, level), std::min(1.0, static_cast<double>(s))};
}

std::size_t LocalBounds::computed() const {
  std::size_t n = 0;
  for (int level = 0; level < levels_; ++level) {
    for (std::size_t i = 0; i < cells_of(level); ++i) {
      n += slopes_[level][i].load(std::memory_order_relaxed) != 0 ? 1 : 0;
    }
  }
  return n;
}

}  // namespace sdfgrid
