#include "sdfgrid/field/local_bounds.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace sdfgrid {
namespace {

constexpr double kLeast = 1e-6;  // slopes are never taken for less: a step stays finite
constexpr double kGain = 1.1;
constexpr int kMostCells = 4;  // of a way: to look at more takes longer than to evaluate anew
constexpr std::uint32_t kLevelBits = 7;

std::size_t cells_of(int level) { return std::size_t{1} << (3 * level); }
std::size_t index_of(const glm::ivec3& cell, int level) {
  const auto side = std::size_t{1} << level;
  return (cell.x * side + cell.y) * side + cell.z;
}

}  // namespace

LocalBounds::LocalBounds(Field field, const Box& region, int levels)
    : field_(std::move(field)), region_(region), levels_(std::clamp(levels, 1, 7)) {
  const glm::dvec3 size = region_.size();
  for (int level = 0; level < levels_; ++level) {
    edges_.push_back(size / static_cast<double>(1 << level));
    slopes_.push_back(std::make_unique<Slope[]>(cells_of(level)));
  }
  smallest_ = std::make_unique<std::atomic<std::uint32_t>[]>(cells_of(levels_ - 1));
  per_edge_ = 1.0 / edges_.back();
  over_ = 1e-9 * std::max({size.x, size.y, size.z});
}

Box LocalBounds::box(const glm::ivec3& cell, int level) const {
  const glm::dvec3& edge = edges_[level];
  const glm::dvec3 lo = region_.lo + edge * glm::dvec3(cell);
  return {lo, lo + edge};
}

float LocalBounds::slope(const glm::ivec3& cell, int level) const {
  Slope& known = slopes_[level][index_of(cell, level)];
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

LocalBounds::Place LocalBounds::place(const glm::dvec3& p) const {
  const int last = levels_ - 1;
  const int side = 1 << last;
  const glm::dvec3 unit = (p - region_.lo) * per_edge_;
  glm::ivec3 cell;
  for (int a = 0; a < 3; ++a) cell[a] = std::clamp(static_cast<int>(unit[a]), 0, side - 1);
  std::atomic<std::uint32_t>& known = smallest_[index_of(cell, last)];
  std::uint32_t bits = known.load(std::memory_order_relaxed);
  if (bits == 0) {
    int level = 0;
    float s = slope(glm::ivec3(0), 0);
    while (s < 0) {
      ++level;
      s = slope({cell.x >> (last - level), cell.y >> (last - level), cell.z >> (last - level)},
                level);
    }
    // Rounded up by eight units in the last place, three bits of which then tell the level.
    bits = (std::bit_cast<std::uint32_t>(s) | kLevelBits) + 1 + static_cast<std::uint32_t>(level);
    known.store(bits, std::memory_order_relaxed);
  }
  const int level = static_cast<int>(bits & kLevelBits);
  const double s = double(std::bit_cast<float>(bits & ~kLevelBits));
  for (int a = 0; a < 3; ++a) cell[a] >>= last - level;
  return {cell, level, std::min(1.0, s)};
}

LocalBounds::Cell LocalBounds::at(const glm::dvec3& p) const {
  const Place found = place(p);
  return {box(found.cell, found.level), found.slope};
}

LocalBounds::Free LocalBounds::free(const glm::dvec3& p, const glm::dvec3& along,
                                    double value) const {
  const Place here = place(p);
  return {way(here, p, along, value), way(here, p, -along, value), value / here.slope};
}

// Where not all is known the value falls by 1.
double LocalBounds::way(Place at, const glm::dvec3& p, const glm::dvec3& along,
                        double value) const {
  double way = 0;
  for (int i = 0; i < kMostCells; ++i) {
    double end = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 3; ++a) {
      if (along[a] == 0) continue;
      const double wall = region_.lo[a] + edges_[at.level][a] * (at.cell[a] + (along[a] > 0));
      end = std::min(end, (wall - p[a]) / along[a]);
    }
    end = std::max(end, way) + over_;
    if (value <= at.slope * (end - way)) return way + value / at.slope;
    value = std::max(value - at.slope * (end - way) - over_, 0.0);
    way = end;
    const glm::dvec3 next = p + way * along;
    for (int a = 0; a < 3; ++a) {
      if (next[a] < region_.lo[a] || next[a] > region_.hi[a]) return way + value;
    }
    at = place(next);
  }
  return way + value;
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
