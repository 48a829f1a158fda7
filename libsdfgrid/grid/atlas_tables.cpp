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

// The cells within one of a set cell, along all axes.
CellMask dilate(const CellMask& mask) {
  constexpr std::uint64_t kFirst = 0x0101010101010101U;  // z == 0
  CellMask plane{};
  for (int x = 0; x < kBrick; ++x) {
    const std::uint64_t m = mask[x];
    const std::uint64_t z = m | ((m << 1) & ~kFirst) | ((m >> 1) & ~(kFirst << 7));
    plane[x] = z | (z << 8) | (z >> 8);
  }
  CellMask grown = plane;
  for (int x = 0; x + 1 < kBrick; ++x) {
    grown[x] |= plane[x + 1];
    grown[x + 1] |= plane[x];
  }
  return grown;
}

}  // namespace

float brick_slope(const float* samples) {
  float x = 0;
  float y = 0;
  float z = 0;
  for (int i = 0; i < Atlas::kSamples - kEdge * kEdge; ++i) {
    x = std::max(x, std::abs(samples[i + kEdge * kEdge] - samples[i]));
  }
  for (int row = 0; row < kEdge * kEdge; ++row) {
    const float* p = samples + static_cast<std::ptrdiff_t>(row) * kEdge;
    for (int i = 0; i + 1 < kEdge; ++i) z = std::max(z, std::abs(p[i + 1] - p[i]));
    if (row % kEdge == kEdge - 1) continue;
    for (int i = 0; i < kEdge; ++i) y = std::max(y, std::abs(p[i + kEdge] - p[i]));
  }
  return std::sqrt(x * x + y * y + z * z);
}

bool fill_hops(const float* samples, float margin, std::uint8_t* hops) {
  const CellMask above = full_cells(sample_mask(samples, [&](float v) { return v > margin; }));
  const CellMask below = full_cells(sample_mask(samples, [&](float v) { return v < -margin; }));
  CellMask reached{};
  std::uint64_t any = 0;
  for (int x = 0; x < kBrick; ++x) any |= reached[x] = ~(above[x] | below[x]);
  std::memset(hops, any != 0 ? 0 : kBrick, Atlas::kCells);
  if (any == 0) return false;
  // Each round adds one to the cells not yet reached.
  for (std::uint64_t left = ~0ULL; left != 0; reached = dilate(reached)) {
    left = 0;
    for (int x = 0; x < kBrick; ++x) {
      left |= ~reached[x];
      for (int i = 0; i < kBrick * kBrick; ++i) hops[x * 64 + i] += !((reached[x] >> i) & 1U);
    }
  }
  return true;
}

void fill_jumps(Atlas& atlas, const Job& job) {
  const glm::ivec3 dims = atlas.dims;
  // The Chebyshev distance is exact after one sweep forwards and one backwards over the neighbours
  // already passed.
  std::vector<std::int32_t>& jumps = atlas.jumps;
  const int far = std::max({dims.x, dims.y, dims.z});
  jumps.assign(atlas.bricks.size(), -far);
  parallel_for(jumps.size(), 1 << 14, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::int32_t brick = atlas.bricks[i];
      if (brick < 0) continue;
      const std::uint8_t* hops = atlas.hops.data() + std::size_t(brick) * Atlas::kCells;
      if (hops[0] < kBrick) jumps[i] = brick;
    }
  });
  const auto relax = [&](const glm::ivec3& slot, int side) {
    std::int32_t& jump = jumps[atlas.place(slot)];
    if (jump >= 0) return;
    for (int n = 0; n < 13; ++n) {
      // The 13 neighbours that come before in the order of the tables, or after.
      const glm::ivec3 other = slot + side * glm::ivec3(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
      if (other.x < 0 || other.y < 0 || other.z < 0 || other.x >= dims.x || other.y >= dims.y ||
          other.z >= dims.z) {
        continue;
      }
      jump = std::max(jump, std::min(jumps[atlas.place(other)], 0) - 1);
    }
  };
  for (int x = 0; x < dims.x; ++x) {
    job.checkpoint();
    for (int y = 0; y < dims.y; ++y) {
      for (int z = 0; z < dims.z; ++z) relax({x, y, z}, 1);
    }
  }
  for (int x = dims.x; x-- > 0;) {
    job.checkpoint();
    for (int y = dims.y; y-- > 0;) {
      for (int z = dims.z; z-- > 0;) relax({x, y, z}, -1);
    }
  }
}

}  // namespace sdfgrid
