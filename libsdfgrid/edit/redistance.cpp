#include "sdfgrid/edit/redistance.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <iterator>
#include <memory>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/edit/block.h"
#include "sdfgrid/edit/nearest_kernel.h"

namespace sdfgrid {
namespace {

constexpr float kConsistent = 0.03F;  // voxels by which a kept value may be wrong
// No point of a cell is further from the zeros on its edges than that, as a rule.
constexpr float kBetweenZeros = 0.5F;

constexpr float kNowhere = 1e9F;  // voxels

// Padded to a multiple of 16.
class Points {
 public:
  void clear() { size_ = 0; }
  // So many may be added now.
  void make_room(std::int32_t count) {
    const std::size_t needed = static_cast<std::size_t>(size_) + count + 16;
    if (x_.size() >= needed) return;
    for (std::vector<float>* c : {&x_, &y_, &z_}) c->resize(2 * needed);
  }
  void add(const glm::vec3& p) {
    assert(static_cast<std::size_t>(size_) < x_.size());
    x_[size_] = p.x;
    y_[size_] = p.y;
    z_[size_] = p.z;
    ++size_;
  }
  void pad(const glm::vec3& with) {
    make_room(0);
    while (size_ % 16 != 0) add(with);
  }
  [[nodiscard]] std::int32_t size() const { return size_; }
  [[nodiscard]] glm::vec3 operator[](std::int32_t i) const { return {x_[i], y_[i], z_[i]}; }
  [[nodiscard]] Positions positions() const { return {x_.data(), y_.data(), z_.data(), size_}; }

 private:
  std::vector<float> x_, y_, z_;  // the first size_ of them
  std::int32_t size_ = 0;
};

// One brick at a time; keeps its arrays from one to the next.
class Redistancer {
 public:
  Redistancer(const GridBricks& bricks, double voxel, const BandLimits& limits)
      : bricks_(bricks), voxel_(voxel), limits_(limits) {
    const double widest = std::max(limits.outside, -limits.inside) / voxel;
    apron_ = static_cast<int>(std::ceil(widest - 1e-3)) + 1;
  }

  // Whether any value changed; then they are in `out`.
  bool run(const RedistanceTask& task, RedistancedBrick& out);

 private:
  bool beside_surface(const glm::ivec3& p) const;
  void find_wrong(const RedistanceTask& task);
  void find_surface();
  void add_crossings(int x, int y, const std::uint64_t mask, const glm::ivec3& step);
  void measure();
  std::uint64_t signs(int x, int y) const {
    return signs_[(x + apron_) * block_.edge() + y + apron_];
  }

  GridBricks bricks_;
  double voxel_;
  BandLimits limits_;
  int apron_;
  Block block_;
  std::vector<std::uint64_t> signs_;  // of each row, bit z + apron: negative
  Points surface_;                    // zeros of the field on the edges of the lattice
  Points wrong_;                      // the samples to measure, not padded
  std::vector<float> found_;          // and their distances, voxels
  // What is improved: from samples to points of the surface, those of one sample side by side.
  Points from_, to_;
  std::vector<std::int32_t> of_;  // which sample of wrong_
  std::vector<float> improved_;
};

// Whether a neighbour along an axis is on the other side.
bool Redistancer::beside_surface(const glm::ivec3& p) const {
  const std::uint64_t row = signs(p.x, p.y);
  const int z = p.z + apron_;
  const std::uint64_t own = 0 - (row >> z & 1);
  const std::uint64_t other = (signs(p.x - 1, p.y) ^ own) | (signs(p.x + 1, p.y) ^ own) |
                              (signs(p.x, p.y - 1) ^ own) | (signs(p.x, p.y + 1) ^ own) |
                              (row ^ own) << 1 | (row ^ own) >> 1;
  return (other >> z & 1) != 0;
}

// Those of the suspects whose value is not that of the surface.
void Redistancer::find_wrong(const RedistanceTask& task) {
  from_.clear();
  from_.make_room(kBrickSamples);
  wrong_.clear();
  wrong_.make_room(kBrickSamples);
  for (int x = 0; x < 8; ++x) {
    for (std::uint64_t mask = task.suspect[x]; mask != 0; mask &= mask - 1) {
      const int bit = std::countr_zero(mask);
      const glm::ivec3 p(x, bit >> 3, bit & 7);
      if (task.beside_surface || !beside_surface(p)) from_.add(glm::vec3(p));
    }
  }
  const std::int32_t count = from_.size();
  if (count == 0) return;
  from_.pad(glm::vec3(0.0F));
  std::uint16_t right[kBrickSamples / 16];
  nearest_kernel().agree(block_.samples(), from_.positions(), kConsistent, right);
  for (std::int32_t i = 0; i < count; ++i) {
    if ((right[i / 16] >> i % 16 & 1) == 0) wrong_.add(from_[i]);
  }
}

void Redistancer::add_crossings(int x, int y, std::uint64_t mask, const glm::ivec3& step) {
  for (; mask != 0; mask &= mask - 1) {
    const glm::ivec3 p(x, y, std::countr_zero(mask) - apron_);
    const float a = block_.at(p);
    const float b = block_.at(p + step);
    surface_.add(glm::vec3(p) + glm::vec3(step) * (a / (a - b)));
  }
}

void Redistancer::find_surface() {
  surface_.clear();
  const int end = 8 + apron_;
  const std::uint64_t inner = (~std::uint64_t{0} >> (64 - block_.edge())) >> 1;
  for (int x = -apron_; x < end; ++x) {
    for (int y = -apron_; y < end; ++y) {
      const std::uint64_t row = signs(x, y);
      surface_.make_room(3 * block_.edge());
      add_crossings(x, y, (row ^ row >> 1) & inner, {0, 0, 1});
      if (y + 1 < end) add_crossings(x, y, row ^ signs(x, y + 1), {0, 1, 0});
      if (x + 1 < end) add_crossings(x, y, row ^ signs(x + 1, y), {1, 0, 0});
    }
  }
  surface_.pad(glm::vec3(kNowhere));
}

// The distances from the wrong samples to the surface.
void Redistancer::measure() {
  from_.clear();
  to_.clear();
  of_.clear();
  found_.assign(std::size_t(wrong_.size()), kNowhere);
  if (surface_.size() == 0) return;
  from_.make_room(NearPoints::kMost * wrong_.size());
  to_.make_room(NearPoints::kMost * wrong_.size());
  for (std::int32_t i = 0; i < wrong_.size(); ++i) {
    const glm::vec3 p = wrong_[i];
    const float at[3] = {p.x, p.y, p.z};
    NearPoints near;
    nearest_kernel().nearest(surface_.positions(), at, near);
    const float nearest = std::sqrt(near.squared[0]);
    for (int n = 0; n < NearPoints::kMost; ++n) {
      if (std::sqrt(near.squared[n]) > nearest + kBetweenZeros) break;
      from_.add(p);
      to_.add(surface_[near.index[n]]);
      of_.push_back(i);
    }
  }
  from_.pad(glm::vec3(0.0F));
  to_.pad(glm::vec3(0.0F));
  improved_.resize(std::size_t(from_.size()));
  nearest_kernel().improve(block_.samples(), from_.positions(), to_.positions(), improved_.data());
  for (std::size_t i = 0; i < of_.size(); ++i) {
    float& found = found_[std::size_t(of_[i])];
    found = std::min(found, improved_[i]);
  }
}

bool Redistancer::run(const RedistanceTask& task, RedistancedBrick& out) {
  const GridBrick now = bricks_.find(task.brick);
  if (now.values == nullptr) return false;
  block_.fill(bricks_, task.brick, apron_, voxel_);
  signs_.resize(static_cast<std::size_t>(block_.edge()) * block_.edge());
  nearest_kernel().signs(block_.samples(), signs_.data());
  find_wrong(task);
  if (wrong_.size() == 0) return false;
  find_surface();
  measure();
  out.change = {task.brick, {}};
  bool changed = false;
  std::memcpy(out.values, now.values, sizeof out.values);
  std::memcpy(out.active, now.active, sizeof out.active);
  for (std::int32_t n = 0; n < wrong_.size(); ++n) {
    const glm::ivec3 p(wrong_[n]);
    const auto reached = static_cast<float>(found_[std::size_t(n)] * voxel_);
    float& value = out.values[(p.x * 8 + p.y) * 8 + p.z];
    const float before = value;
    value = value < 0 ? std::max(-reached, limits_.inside) : std::min(reached, limits_.outside);
    const bool active = value > limits_.inside && value < limits_.outside;
    const std::uint64_t bit = std::uint64_t{1} << (p.y * 8 + p.z);
    out.active[p.x] = active ? out.active[p.x] | bit : out.active[p.x] & ~bit;
    if (value == before) continue;
    out.change.samples[p.x] |= bit;
    changed = true;
  }
  return changed;
}

}  // namespace

std::vector<RedistancedBrick> redistance(const GridBricks& bricks, double voxel,
                                         const BandLimits& limits,
                                         const std::vector<RedistanceTask>& tasks, const Job& job) {
  std::vector<std::unique_ptr<RedistancedBrick>> found(tasks.size());
  constexpr std::size_t kGrain = 16;
  parallel_for(tasks.size(), kGrain, job, [&](std::size_t begin, std::size_t end) {
    Redistancer one(bricks, voxel, limits);
    auto out = std::make_unique<RedistancedBrick>();
    for (std::size_t i = begin; i < end; ++i) {
      if (!one.run(tasks[i], *out)) continue;
      found[i] = std::move(out);
      out = std::make_unique<RedistancedBrick>();
    }
  });
  std::vector<RedistancedBrick> changed;
  for (const auto& brick : found) {
    if (brick) changed.push_back(*brick);
  }
  return changed;
}

}  // namespace sdfgrid
