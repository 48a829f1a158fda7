#include "sdfgrid/trace/flattening.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/trace/atlas_slot.h"

namespace sdfgrid {
namespace {

constexpr double kFinest = 8;        // bins a voxel
constexpr std::size_t kMost = 2048;  // bins

void join(const Box& from, Box& box) {
  if (from.empty()) return;
  box.add(from.lo);
  box.add(from.hi);
}

// Cells, `edge` a side, from `at` of a slot on.
void add_cells(const glm::ivec3& slot, const glm::ivec3& at, int edge, Box& box) {
  const glm::dvec3 lo(slot * Atlas::kBrick + at);
  box.add(lo);
  box.add(lo + double(edge));
}

// What the cells say, by bins of values, which are made twice as wide when there are too many: what
// is known of two of them is known of both together, so that the result does not depend on when
// that was, nor on who looked at which cell.
struct Survey {
  double bins_per_voxel = kFinest;
  double least = 0, most = 0;               // of the samples, voxels
  bool cut_off = false;                     // there are slots without samples inside
  std::array<std::vector<float>, 2> sides;  // squares of the steepest gradients above 1
  Box negative;                             // of the cells with negative samples
  std::vector<Box> boxes;                   // of those whose least sample is in bin 0, 1, ...

  void add(const Atlas& atlas, const glm::ivec3& at) {
    const AtlasSlot slot(atlas, at);
    if (slot.is_constant()) {
      if (!slot.is_inside()) return;
      cut_off = true;
      add_cells(at, glm::ivec3(0), Atlas::kBrick, negative);
      return;
    }
    cut_off = cut_off || slot.is_inside();
    constexpr int kCells = Atlas::kBrick * Atlas::kBrick * Atlas::kBrick;
    for (int i = 0; i < kCells; ++i) add_cell(slot.samples(), at, {i >> 6, i >> 3 & 7, i & 7});
  }

  void add(const Survey& other) {
    least = std::min(least, other.least);
    most = std::max(most, other.most);
    cut_off = cut_off || other.cut_off;
    join(other.negative, negative);
    Survey from = other;
    while (from.bins_per_voxel > bins_per_voxel) from.halve();
    while (bins_per_voxel > from.bins_per_voxel) halve();
    for (const int side : {0, 1}) {
      grow(sides[side], from.sides[side].size());
      for (std::size_t i = 0; i < from.sides[side].size(); ++i) {
        sides[side][i] = std::max(sides[side][i], from.sides[side][i]);
      }
    }
    boxes.resize(std::max(boxes.size(), from.boxes.size()));
    for (std::size_t i = 0; i < from.boxes.size(); ++i) join(from.boxes[i], boxes[i]);
  }

  [[nodiscard]] std::size_t bin(double value) const {
    return static_cast<std::size_t>(std::max(value, 0.0) * bins_per_voxel);
  }

 private:
  static void grow(std::vector<float>& side, std::size_t size) {
    if (side.size() < size) side.resize(size, 1);
  }

  void halve() {
    bins_per_voxel /= 2;
    for (std::vector<float>& side : sides) {
      if (side.size() % 2 != 0) side.push_back(1);
      for (std::size_t i = 0; i < side.size() / 2; ++i) {
        side[i] = std::max(side[2 * i], side[2 * i + 1]);
      }
      side.resize(side.size() / 2);
    }
    if (boxes.size() % 2 != 0) boxes.emplace_back();
    for (std::size_t i = 0; i < boxes.size() / 2; ++i) {
      const Box second = boxes[2 * i + 1];
      boxes[i] = boxes[2 * i];
      join(second, boxes[i]);
    }
    boxes.resize(boxes.size() / 2);
  }

  // Each of the gradient's components is linear in each of the other coordinates, so that the
  // square of its length is convex in each: it is largest at a corner of a cell.
  void add_cell(const float* samples, const glm::ivec3& slot, const glm::ivec3& at) {
    constexpr int kEdge = Atlas::kEdge;
    const float* cell = samples + (at.x * kEdge + at.y) * kEdge + at.z;
    float v[8];
    for (int n = 0; n < 8; ++n) v[n] = cell[((n >> 2) * kEdge + (n >> 1 & 1)) * kEdge + (n & 1)];
    float square = 0;
    for (int n = 0; n < 8; ++n) {
      const float a = v[n ^ 4] - v[n];
      const float b = v[n ^ 2] - v[n];
      const float c = v[n ^ 1] - v[n];
      square = std::max(square, a * a + b * b + c * c);
    }
    const auto [lo, hi] = std::minmax_element(std::begin(v), std::end(v));
    if (!(std::isfinite(*lo) && std::isfinite(*hi) && square < 1e30F)) return;
    least = std::min(least, double(*lo));
    most = std::max(most, double(*hi));
    while (bin(std::max(most, -least)) >= kMost) halve();
    if (*lo < 0) {
      add_cells(slot, at, 1, negative);
    } else {
      const std::size_t n = bin(*lo);
      if (boxes.size() <= n) boxes.resize(n + 1);
      add_cells(slot, at, 1, boxes[n]);
    }
    if (!(square > 1)) return;
    if (*lo < 0) raise(sides[0], -double(*hi), -double(*lo), square);
    if (*hi >= 0) raise(sides[1], *lo, *hi, square);
  }

  // In the bins from one value to another, as far as they are positive.
  void raise(std::vector<float>& side, double from, double to, float square) const {
    grow(side, bin(to) + 1);
    for (std::size_t n = bin(from); n <= bin(to); ++n) side[n] = std::max(side[n], square);
  }
};

Survey survey(const Atlas& atlas, const Job& job) {
  Survey all;
  std::mutex merging;
  const auto columns = static_cast<std::size_t>(atlas.dims.x) * atlas.dims.y;
  parallel_for(columns, 8, job, [&](std::size_t begin, std::size_t end) {
    Survey own;
    for (std::size_t i = begin; i < end; ++i) {
      const auto n = static_cast<int>(i);
      for (int z = 0; z < atlas.dims.z; ++z)
        own.add(atlas, {n / atlas.dims.y, n % atlas.dims.y, z});
    }
    const std::scoped_lock lock(merging);
    all.add(own);
  });
  return all;
}

}  // namespace

Flattening::Flattening(const Atlas& atlas, const Job& job) {
  Survey found = survey(atlas, job);
  cut_off_ = found.cut_off;
  least_ = cut_off_ ? std::min(found.least, double(atlas.inside)) : found.least;
  bins_per_voxel_ = found.bins_per_voxel;
  const double ends[2] = {-least_, std::max(found.most, double(atlas.outside))};
  for (const int side : {0, 1}) {
    std::vector<float>& squares = found.sides[side];
    squares.resize(std::max(squares.size(), std::min(kMost, found.bin(ends[side])) + 1), 1);
    sums_[side] = {0};
    for (const float square : squares) {
      constexpr double kRounding = 1 + 1e-6;
      sums_[side].push_back(sums_[side].back() +
                            1 / (bins_per_voxel_ * kRounding * std::sqrt(double(square))));
    }
  }
  boxes_ = {found.negative};
  found.boxes.resize(sums_[1].size());
  for (const Box& box : found.boxes) {
    boxes_.push_back(boxes_.back());
    join(box, boxes_.back());
  }
  outside_ = (*this)(atlas.outside);
}

double Flattening::operator()(double v) const {
  const std::vector<double>& sums = sums_[v > 0 ? 1 : 0];
  const double at = std::fabs(v) * bins_per_voxel_;
  const auto last = sums.size() - 1;
  if (!(at < static_cast<double>(last))) {
    return std::copysign(sums[last] + (at - static_cast<double>(last)) / bins_per_voxel_, v);
  }
  const auto n = static_cast<std::size_t>(at);
  return std::copysign(sums[n] + (at - static_cast<double>(n)) * (sums[n + 1] - sums[n]), v);
}

double Flattening::reach_inside() const {
  return cut_off_ ? -(*this)(least_) : std::numeric_limits<double>::infinity();
}

Box Flattening::cells_below(double level) const {
  if (level <= 0) return boxes_[0];
  const std::vector<double>& sums = sums_[1];
  const auto n =
      static_cast<std::size_t>(std::lower_bound(sums.begin(), sums.end(), level) - sums.begin());
  // Where there are no samples the value is outside_.
  if (level > outside_ || n >= sums.size()) return {glm::dvec3(-1e300), glm::dvec3(1e300)};
  return boxes_[n];
}

}  // namespace sdfgrid
