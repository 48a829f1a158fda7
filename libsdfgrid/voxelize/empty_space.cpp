#include "sdfgrid/voxelize/empty_space.h"

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

  void visit(const glm::ivec3& lo, int level, EmptySpace& out, const Job& job) const {
    const int edge = kBrickEdge << level;
    if (!occupancy_.holds(lo, level)) {
      const Side side = side_of(lo, edge);
      if (side.proven) {
        if (side.inside) out.inside.push_back({lo, edge});
        return;
      }
      if (level == 0) {
        // The border is near. The brick is kept even if all its samples agree: a neighbour may not.
        CapBrick cap{lo, {}};
        sign_brick(cap);
        out.caps.push_back(cap);
        return;
      }
    } else if (level == 0) {
      return;
    }
    job.checkpoint();
    for_each_octant(lo, edge, [&](const glm::ivec3& child) { visit(child, level - 1, out, job); });
  }

 private:
  struct Side {
    bool inside;  // at the box's centre
    bool proven;  // and in all of it
  };

  [[nodiscard]] Side side_of(const glm::ivec3& lo, int edge) const {
    // One sample further than the box on every side, so that two neighbours cannot be given
    // different signs without a brick between them.
    const glm::dvec3 center = shift_ + voxel_ * (glm::dvec3(lo) + 0.5 * (edge - 1));
    const double radius = 0.5 * (edge + 1) * std::sqrt(3.0) * voxel_;
    const double w = winding_.at(center);
    const double margin = std::abs(w - 0.5) - winding_.tolerance();
    return {w > 0.5, margin > 0 && winding_.gradient_below(center, radius, margin / radius)};
  }

  void sign_brick(CapBrick& cap) const {
    std::array<double, WindingNumber::kCubePoints> w;
    winding_.at_cube(shift_ + voxel_ * glm::dvec3(cap.origin), voxel_, w);
    for (std::size_t s = 0; s < w.size(); ++s) {
      if (w[s] > 0.5) cap.negative[s >> 6] |= 1ULL << (s & 63);
    }
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
  constexpr int kTopLevel = 4;  // boxes of 128^3 samples, OpenVDB's nodes
  constexpr int kTopEdge = kBrickEdge << kTopLevel;
  glm::ivec3 lo = bricks.front();
  glm::ivec3 hi = lo;
  for (const glm::ivec3& origin : bricks) {
    lo = glm::min(lo, origin);
    hi = glm::max(hi, origin + (kBrickEdge - 1));
  }
  const glm::ivec3 margin = (hi - lo) / 4;
  lo = round_down(lo - margin, kTopEdge);
  hi = round_down(hi + margin, kTopEdge);
  const glm::ivec3 dims = (hi - lo) / kTopEdge + 1;
  const Occupancy occupancy(bricks, kTopLevel + 1);
  const Signer signer(winding, lattice, shift, occupancy);
  std::vector<EmptySpace> parts(static_cast<std::size_t>(dims.x) *
                                static_cast<std::size_t>(dims.y) *
                                static_cast<std::size_t>(dims.z));
  parallel_for(parts.size(), 1, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int n = static_cast<int>(i);
      const glm::ivec3 at(n / (dims.y * dims.z), n / dims.z % dims.y, n % dims.z);
      signer.visit(lo + kTopEdge * at, kTopLevel, parts[i], job);
    }
  });
  for (const EmptySpace& part : parts) {
    all.inside.insert(all.inside.end(), part.inside.begin(), part.inside.end());
    all.caps.insert(all.caps.end(), part.caps.begin(), part.caps.end());
  }
  return all;
}

}  // namespace sdfgrid
