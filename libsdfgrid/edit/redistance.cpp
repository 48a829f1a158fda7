#include "sdfgrid/edit/redistance.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <memory>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/edit/block.h"
#include "sdfgrid/edit/nearest_kernel.h"

namespace sdfgrid {
namespace {

constexpr float kConsistent = 0.03F;  // voxels by which a kept value may be wrong
constexpr float kOnSurface = 1e-3F;   // voxels
constexpr float kBetweenZeros = 0.5F;
constexpr int kNewtonSteps = 4;

// Zeros of the field on the edges of the lattice, padded to a multiple of 16.
struct SurfacePoints {
  std::vector<float> x, y, z;

  void clear() {
    x.clear();
    y.clear();
    z.clear();
  }
  void add(const glm::vec3& p) {
    x.push_back(p.x);
    y.push_back(p.y);
    z.push_back(p.z);
  }
  void pad() {
    constexpr float kFar = 1e9F;
    while (x.size() % 16 != 0) add(glm::vec3(kFar));
  }
  [[nodiscard]] std::int32_t size() const { return static_cast<std::int32_t>(x.size()); }
  [[nodiscard]] glm::vec3 operator[](std::int32_t i) const { return {x[i], y[i], z[i]}; }
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
  void read_signs();
  bool beside_surface(const glm::ivec3& p) const;
  bool consistent(const glm::ivec3& p) const;
  void find_surface();
  void add_crossings(int x, int y, const std::uint64_t mask, const glm::ivec3& step);
  float improve(const glm::vec3& p, glm::vec3 c) const;
  float distance(const glm::vec3& p) const;
  std::uint64_t& signs(int x, int y) { return signs_[(x + apron_) * block_.edge() + y + apron_]; }
  std::uint64_t signs(int x, int y) const {
    return signs_[(x + apron_) * block_.edge() + y + apron_];
  }

  GridBricks bricks_;
  double voxel_;
  BandLimits limits_;
  int apron_;
  Block block_;
  std::vector<std::uint64_t> signs_;  // of each row, bit z + apron: negative
  SurfacePoints surface_;
  std::vector<glm::ivec3> wrong_;
};

void Redistancer::read_signs() {
  const int edge = block_.edge();
  signs_.resize(static_cast<std::size_t>(edge) * edge);
  for (int x = -apron_; x < 8 + apron_; ++x) {
    for (int y = -apron_; y < 8 + apron_; ++y) {
      const float* row = block_.row(x, y);
      std::uint64_t word = 0;
      for (int z = 0; z < edge; ++z) word |= static_cast<std::uint64_t>(row[z] < 0) << z;
      signs(x, y) = word;
    }
  }
}

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

// Whether the surface is where the value says: there the field is zero, and half a voxel further on
// it has the other sign.
bool Redistancer::consistent(const glm::ivec3& p) const {
  const glm::vec3 g = block_.gradient(p);
  const float length = glm::length(g);
  if (!(length > 0.5F)) return false;
  const glm::vec3 normal = g / length;
  const float value = block_.at(p);
  const glm::vec3 foot = glm::vec3(p) - normal * value;
  if (!(std::abs(block_.sample(foot).value) <= kConsistent)) return false;
  const float side = value < 0 ? -0.5F : 0.5F;
  return block_.sample(foot - normal * side).value * side < 0;
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
      add_crossings(x, y, (row ^ row >> 1) & inner, {0, 0, 1});
      if (y + 1 < end) add_crossings(x, y, row ^ signs(x, y + 1), {0, 1, 0});
      if (x + 1 < end) add_crossings(x, y, row ^ signs(x + 1, y), {1, 0, 0});
    }
  }
  surface_.pad();
}

// The distance from p to a point of the surface near c that is nearer still, or to c.
float Redistancer::improve(const glm::vec3& p, glm::vec3 c) const {
  float best = glm::length(p - c);
  for (int step = 0; step < kNewtonSteps; ++step) {
    const FieldSample here = block_.sample(c);
    const float squared = glm::dot(here.gradient, here.gradient);
    if (!(squared > 0.01F)) break;
    // The foot of p on the tangent plane at c, then back to the surface from there.
    glm::vec3 foot = p - here.gradient * ((here.value + glm::dot(here.gradient, p - c)) / squared);
    const glm::vec3 moved = foot - c;
    const float length = glm::length(moved);
    if (length > 1) foot = c + moved / length;
    const FieldSample there = block_.sample(foot);
    const float slope = glm::dot(there.gradient, there.gradient);
    if (!(slope > 0.01F)) break;
    c = foot - there.gradient * (there.value / slope);
    if (std::abs(block_.sample(c).value) < kOnSurface) best = std::min(best, glm::length(p - c));
    if (length < 0.01F) break;
  }
  return best;
}

// From p to the surface, voxels.
float Redistancer::distance(const glm::vec3& p) const {
  const float at[3] = {p.x, p.y, p.z};
  NearPoints near;
  nearest_kernel().nearest(surface_.x.data(), surface_.y.data(), surface_.z.data(), surface_.size(),
                           at, near);
  float best = std::sqrt(near.squared[0]);
  for (int i = 0; i < NearPoints::kMost; ++i) {
    // No point of a cell is further from the zeros on its edges than that, as a rule.
    if (std::sqrt(near.squared[i]) > best + kBetweenZeros) break;
    best = std::min(best, improve(p, surface_[near.index[i]]));
  }
  return best;
}

bool Redistancer::run(const RedistanceTask& task, RedistancedBrick& out) {
  const GridBrick now = bricks_.find(task.brick);
  if (now.values == nullptr) return false;
  block_.fill(bricks_, task.brick, apron_, voxel_);
  read_signs();
  wrong_.clear();
  for (int x = 0; x < 8; ++x) {
    for (std::uint64_t mask = task.suspect[x]; mask != 0; mask &= mask - 1) {
      const int bit = std::countr_zero(mask);
      const glm::ivec3 p(x, bit >> 3, bit & 7);
      if (!task.beside_surface && beside_surface(p)) continue;
      if (!consistent(p)) wrong_.push_back(p);
    }
  }
  if (wrong_.empty()) return false;
  find_surface();
  out.brick = task.brick;
  std::memcpy(out.values, now.values, sizeof out.values);
  std::memcpy(out.active, now.active, sizeof out.active);
  for (const glm::ivec3& p : wrong_) {
    const int i = (p.x * 8 + p.y) * 8 + p.z;
    float& value = out.values[i];
    const float reached = surface_.size() > 0 ? static_cast<float>(distance(p) * voxel_)
                                              : limits_.outside - limits_.inside;
    value = value < 0 ? std::max(-reached, limits_.inside) : std::min(reached, limits_.outside);
    const bool active = value > limits_.inside && value < limits_.outside;
    const std::uint64_t bit = std::uint64_t{1} << (p.y * 8 + p.z);
    out.active[p.x] = active ? out.active[p.x] | bit : out.active[p.x] & ~bit;
  }
  return std::memcmp(out.values, now.values, sizeof out.values) != 0;
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
