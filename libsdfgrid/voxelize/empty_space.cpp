#include "sdfgrid/voxelize/empty_space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <unordered_set>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/voxelize/node_bins.h"

namespace sdfgrid {
namespace {

// Which boxes of 8 * 2^level samples hold a brick, for every level up to the one of the whole.
class Occupancy {
 public:
  Occupancy(const std::vector<glm::ivec3>& bricks, int levels) : levels_(levels) {
    for (const glm::ivec3& origin : bricks) levels_[0].insert(key(origin / kBrickEdge));
    for (const glm::ivec3& origin : bricks) {
      // Division by eight is exact; the shift then rounds down for negative numbers too.
      glm::ivec3 box = origin / kBrickEdge;
      for (int level = 1; level < levels; ++level) {
        box = {box.x >> 1, box.y >> 1, box.z >> 1};
        if (!levels_[static_cast<std::size_t>(level)].insert(key(box)).second) break;
      }
    }
  }

  [[nodiscard]] bool holds(const glm::ivec3& lo, int level) const {
    const int edge = kBrickEdge << level;
    return levels_[static_cast<std::size_t>(level)].contains(key(lo / edge));
  }

 private:
  static std::uint64_t key(const glm::ivec3& v) {
    const auto part = [](int c) { return static_cast<std::uint64_t>(c + (1 << 20)) & 0x1fffffU; };
    return part(v.x) << 42U | part(v.y) << 21U | part(v.z);
  }
  std::vector<std::unordered_set<std::uint64_t>> levels_;
};

class Signer {
 public:
  Signer(const WindingNumber& winding, const Lattice& lattice, const glm::dvec3& shift,
         const Occupancy& occupancy)
      : winding_(winding), voxel_(lattice.voxel), shift_(shift), occupancy_(occupancy) {}

  // Takes boxes of 8 * 2^level samples apart down to `least`, where the rest goes to `left`.
  void divide(const glm::ivec3& lo, int level, int least, EmptySpace& out,
              std::vector<glm::ivec3>& left) const {
    if (proven(lo, level, out)) return;
    if (level == least) {
      left.push_back(lo);
      return;
    }
    for_each_octant(lo, kBrickEdge << level,
                    [&](const glm::ivec3& child) { divide(child, level - 1, least, out, left); });
  }

  // A brick without triangles whose side is not proven: the border is near. It is kept even if all
  // its samples agree, for a neighbour's may not.
  [[nodiscard]] CapBrick cap_brick(const glm::ivec3& lo) const {
    CapBrick cap{lo, {}};
    std::array<double, WindingNumber::kCubePoints> w;
    winding_.at_cube(shift_ + voxel_ * glm::dvec3(lo), voxel_, w);
    for (std::size_t s = 0; s < w.size(); ++s) {
      if (w[s] > 0.5) cap.negative[s >> 6] |= 1ULL << (s & 63);
    }
    return cap;
  }

  [[nodiscard]] bool holds_brick(const glm::ivec3& lo) const { return occupancy_.holds(lo, 0); }

 private:
  struct Side {
    bool inside;  // at the box's centre
    bool proven;  // and in all of it
  };

  // Whether all of an empty box is shown to be on one side.
  bool proven(const glm::ivec3& lo, int level, EmptySpace& out) const {
    if (occupancy_.holds(lo, level)) return false;
    const int edge = kBrickEdge << level;
    const Side side = side_of(lo, edge);
    if (side.proven && side.inside) out.inside.push_back({lo, edge});
    return side.proven;
  }

  [[nodiscard]] Side side_of(const glm::ivec3& lo, int edge) const {
    // One sample further than the box on every side, so that two neighbours cannot be given
    // different signs without a brick between them.
    const glm::dvec3 center = shift_ + voxel_ * (glm::dvec3(lo) + 0.5 * (edge - 1));
    const double radius = 0.5 * (edge + 1) * std::sqrt(3.0) * voxel_;
    const double w = winding_.at(center);
    const double margin = std::abs(w - 0.5) - winding_.tolerance();
    return {w > 0.5, margin > 0 && winding_.gradient_below(center, radius, margin / radius)};
  }

  template <class Visit>
  static void for_each_octant(const glm::ivec3& lo, int edge, const Visit& visit) {
    for (int child = 0; child < 8; ++child) {
      visit(lo + edge / 2 * glm::ivec3(child >> 2, (child >> 1) & 1, child & 1));
    }
  }

  const WindingNumber& winding_;
  double voxel_;
  glm::dvec3 shift_;
  const Occupancy& occupancy_;
};

glm::ivec3 round_down(const glm::ivec3& v, int edge) {
  return {v.x & ~(edge - 1), v.y & ~(edge - 1), v.z & ~(edge - 1)};
}

}  // namespace

EmptySpace sign_empty_space(const WindingNumber& winding, const Lattice& lattice,
                            const glm::dvec3& shift, const std::vector<glm::ivec3>& bricks,
                            const Job& job) {
  EmptySpace all;
  if (bricks.empty()) return all;
  glm::ivec3 lo = bricks.front();
  glm::ivec3 hi = lo;
  for (const glm::ivec3& origin : bricks) {
    lo = glm::min(lo, origin);
    hi = glm::max(hi, origin + (kBrickEdge - 1));
  }
  const glm::ivec3 margin = (hi - lo) / 4;
  lo -= margin;
  hi += margin;
  // From few boxes as large as the whole, so that work and memory follow the border, not the box.
  constexpr int kNodeLevel = 4;  // boxes of 128^3 samples, OpenVDB's nodes
  int top = kNodeLevel;
  while ((kBrickEdge << top) < std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z}) + 1) ++top;
  const Occupancy occupancy(bricks, top + 1);
  const Signer signer(winding, lattice, shift, occupancy);
  const int edge = kBrickEdge << top;
  const glm::ivec3 first = round_down(lo, edge);
  std::vector<glm::ivec3> nodes;
  for (int x = first.x; x <= hi.x; x += edge) {
    for (int y = first.y; y <= hi.y; y += edge) {
      for (int z = first.z; z <= hi.z; z += edge) {
        signer.divide({x, y, z}, top, kNodeLevel, all, nodes);
      }
    }
  }
  std::vector<EmptySpace> parts(nodes.size());
  parallel_for("interior", nodes.size(), 1, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::vector<glm::ivec3> left;
      signer.divide(nodes[i], kNodeLevel, 0, parts[i], left);
      for (const glm::ivec3& brick : left) {
        job.checkpoint();
        if (!signer.holds_brick(brick)) parts[i].caps.push_back(signer.cap_brick(brick));
      }
    }
  });
  for (const EmptySpace& part : parts) {
    all.inside.insert(all.inside.end(), part.inside.begin(), part.inside.end());
    all.caps.insert(all.caps.end(), part.caps.begin(), part.caps.end());
  }
  return all;
}

}  // namespace sdfgrid
