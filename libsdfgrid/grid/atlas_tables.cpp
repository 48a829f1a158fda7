#include "sdfgrid/grid/atlas_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "sdfgrid/core/parallel.h"

namespace sdfgrid {
namespace {

constexpr int kEdge = Atlas::kEdge;
constexpr int kBrick = Atlas::kBrick;

// One bit a cell: eight planes of constant x, in each the bit y * 8 + z.
using CellMask = std::array<std::uint64_t, kBrick>;

// One bit a sample, whether test(sample) holds: rows of constant x and y, in each the bit z.
template <class Test>
std::array<std::uint16_t, kEdge * kEdge> sample_mask(const float* samples, Test test) {
  std::array<std::uint16_t, kEdge * kEdge> rows{};
  for (int row = 0; row < kEdge * kEdge; ++row) {
    unsigned bits = 0;
    for (int z = 0; z < kEdge; ++z) bits |= unsigned(test(samples[row * kEdge + z])) << z;
    rows[row] = static_cast<std::uint16_t>(bits);
  }
  return rows;
}

// The cells all of whose eight samples are set.
CellMask full_cells(const std::array<std::uint16_t, kEdge * kEdge>& rows) {
  CellMask cells{};
  for (int x = 0; x < kBrick; ++x) {
    for (int y = 0; y < kBrick; ++y) {
      const unsigned both = rows[x * kEdge + y] & rows[x * kEdge + y + 1] &
                            rows[(x + 1) * kEdge + y] & rows[(x + 1) * kEdge + y + 1];
      cells[x] |= std::uint64_t(both & (both >> 1) & 0xffU) << (8 * y);
    }
  }
  return cells;
}

constexpr std::uint64_t kFirstColumn = 0x0101010101010101U;  // z == 0

CellMask mirrored(const CellMask& cells, int octant) {
  CellMask result = cells;
  for (std::uint64_t& plane : result) {
    if ((octant & 1) != 0) {  // the bits of each byte
      plane = (plane >> 4 & 0x0f0f0f0f0f0f0f0fU) | (plane & 0x0f0f0f0f0f0f0f0fU) << 4;
      plane = (plane >> 2 & 0x3333333333333333U) | (plane & 0x3333333333333333U) << 2;
      plane = (plane >> 1 & 0x5555555555555555U) | (plane & 0x5555555555555555U) << 1;
    }
    if ((octant & 2) != 0) plane = __builtin_bswap64(plane);
  }
  if ((octant & 4) != 0) std::reverse(result.begin(), result.end());
  return result;
}

// The cells from which a set cell is at most one ahead, on all axes.
CellMask grow_back(const CellMask& mask) {
  CellMask grown{};
  for (int x = 0; x < kBrick; ++x) {
    const std::uint64_t m = mask[x] | (x + 1 < kBrick ? mask[x + 1] : 0);
    const std::uint64_t z = m | ((m >> 1) & ~(kFirstColumn << 7));
    grown[x] = z | (z >> 8);
  }
  return grown;
}

// Of eight bits, each moved to the lowest of four.
constexpr std::array<std::uint32_t, 256> make_spread() {
  std::array<std::uint32_t, 256> spread{};
  for (unsigned bits = 0; bits < 256; ++bits) {
    for (unsigned i = 0; i < 8; ++i) spread[bits] |= ((bits >> i) & 1U) << (4 * i);
  }
  return spread;
}
constexpr std::array<std::uint32_t, 256> kSpread = make_spread();

void fill_octant(CellMask reached, std::uint32_t* hops) {
  std::memset(hops, 0, kBrick * kBrick * sizeof *hops);
  // Each round adds one to the cells not yet reached.
  for (int round = 0; round < kBrick; ++round) {
    std::uint64_t left = 0;
    for (int x = 0; x < kBrick; ++x) {
      left |= ~reached[x];
      for (int y = 0; y < kBrick; ++y) {
        hops[x * kBrick + y] += kSpread[~(reached[x] >> (8 * y)) & 0xffU];
      }
    }
    if (left == 0) return;
    reached = grow_back(reached);
  }
}

// One octant of Atlas::jumps: one more than the smallest of the seven slots ahead.
class JumpTable {
 public:
  JumpTable(const Atlas& atlas, int octant, std::uint8_t* jumps)
      : atlas_(atlas), jumps_(jumps), beyond_(static_cast<std::size_t>(atlas.dims.z), 255) {
    for (int a = 0; a < 3; ++a) step_[a] = ((octant >> (2 - a)) & 1) != 0 ? -1 : 1;
  }

  void fill(const Job& job) {
    const glm::ivec3 dims = atlas_.dims;
    for (int i = 0; i < dims.x; ++i) {
      job.checkpoint();
      const int x = step_.x > 0 ? dims.x - 1 - i : i;
      for (int j = 0; j < dims.y; ++j) fill_row(x, step_.y > 0 ? dims.y - 1 - j : j);
    }
  }

 private:
  const std::uint8_t* row(int x, int y) const {
    const bool inside = x >= 0 && y >= 0 && x < atlas_.dims.x && y < atlas_.dims.y;
    return inside ? jumps_ + atlas_.place({x, y, 0}) : beyond_.data();
  }

  void fill_row(int x, int y) {
    const int count = atlas_.dims.z;
    const std::uint8_t* ahead[3] = {row(x + step_.x, y), row(x, y + step_.y),
                                    row(x + step_.x, y + step_.y)};
    std::uint8_t* out = jumps_ + atlas_.place({x, y, 0});
    int behind = 255;  // the smallest of the four slots at the previous z
    for (int k = 0; k < count; ++k) {
      const int z = step_.z > 0 ? count - 1 - k : k;
      const int beside = std::min({ahead[0][z], ahead[1][z], ahead[2][z]});
      const bool crossing = atlas_.crossing_brick({x, y, z}) >= 0;
      const int jump = crossing ? 0 : std::min(std::min(beside, behind) + 1, Atlas::kMostJump);
      out[z] = static_cast<std::uint8_t>(jump);
      behind = std::min(beside, jump);
    }
  }

  const Atlas& atlas_;
  std::uint8_t* jumps_;
  std::vector<std::uint8_t> beyond_;  // no crossing bricks there
  glm::ivec3 step_{1};
};

}  // namespace

BrickRange brick_range(const float* samples) {
  float low = samples[0];
  float high = samples[0];
  float size = 0;
  float x = 0;
  float y = 0;
  float z = 0;
  for (int i = 0; i < Atlas::kSamples; ++i) {
    low = std::min(low, samples[i]);
    high = std::max(high, samples[i]);
    size += 0 * samples[i];
  }
  // A partial derivative is a mean of differences along edges of its direction.
  for (int i = 0; i < Atlas::kSamples - kEdge * kEdge; ++i) {
    x = std::max(x, std::abs(samples[i + kEdge * kEdge] - samples[i]));
  }
  for (int row = 0; row < kEdge * kEdge; ++row) {
    const float* p = samples + static_cast<std::ptrdiff_t>(row) * kEdge;
    for (int i = 0; i + 1 < kEdge; ++i) z = std::max(z, std::abs(p[i + 1] - p[i]));
    if (row % kEdge == kEdge - 1) continue;
    for (int i = 0; i < kEdge; ++i) y = std::max(y, std::abs(p[i + kEdge] - p[i]));
  }
  return {low, high, std::sqrt(x * x + y * y + z * z), size == 0};
}

void fill_hops(const float* samples, float margin, std::uint32_t* hops) {
  const CellMask above = full_cells(sample_mask(samples, [&](float v) { return v > margin; }));
  const CellMask below = full_cells(sample_mask(samples, [&](float v) { return v < -margin; }));
  CellMask crossing{};
  for (int x = 0; x < kBrick; ++x) crossing[x] = ~(above[x] | below[x]);
  for (int octant = 0; octant < Atlas::kOctants; ++octant) {
    fill_octant(mirrored(crossing, octant), hops + octant * kBrick * kBrick);
  }
}

void fill_jumps(Atlas& atlas, const Job& job) {
  const std::size_t slots = atlas.bricks.size();
  atlas.jumps.resize(Atlas::kOctants * slots);
  parallel_for(Atlas::kOctants, 1, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t octant = begin; octant < end; ++octant) {
      JumpTable(atlas, int(octant), atlas.jumps.data() + octant * slots).fill(job);
    }
  });
}

}  // namespace sdfgrid
