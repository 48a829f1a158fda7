#include "sdfgrid/transform/cell_sites.h"

#include <algorithm>
#include <bit>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <tuple>
#include <utility>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/voxelize/node_bins.h"

namespace sdfgrid {
namespace {

std::uint64_t cells_of(const std::uint64_t samples[8]) {
  std::uint64_t cells = 0;
  for (int x = 0; x < kBrickCells; ++x) {
    std::uint64_t any = samples[kCell * x] | samples[kCell * x + 1];
    any |= any >> 1;
    any |= any >> 8;
    for (int y = 0; y < kBrickCells; ++y) {
      for (int z = 0; z < kBrickCells; ++z) {
        cells |= (any >> (kCell * (8 * y + z)) & 1) << ((x * kBrickCells + y) * kBrickCells + z);
      }
    }
  }
  return cells;
}

// Puts a brick's cells into its octant of the block.
void add_cells(std::uint64_t cells, const glm::ivec3& brick, SiteBits& block) {
  const glm::ivec3 first = (brick & 1) * kBrickCells;
  for (int x = 0; x < kBrickCells; ++x) {
    std::uint64_t& word = block[static_cast<std::size_t>(first.x + x)];
    for (int y = 0; y < kBrickCells; ++y) {
      const std::uint64_t row = cells >> (kBrickCells * (kBrickCells * x + y)) & 0xfU;
      word |= row << (8 * (first.y + y) + first.z);
    }
  }
}

// Several of them may be between neighbouring samples.
bool is_small(const glm::dvec3 corners[3]) {
  constexpr double kSmall = 2;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 edge = corners[i] - corners[(i + 1) % 3];
    if (glm::dot(edge, edge) > kSmall * kSmall) return false;
  }
  return true;
}

std::vector<glm::ivec3> blocks_of(const BrickTable& bricks) {
  std::vector<glm::ivec3> blocks;
  blocks.reserve(bricks.size());
  for (const glm::ivec3& c : bricks.coordinates()) blocks.push_back(c >> 1);
  return blocks;
}

}  // namespace

CellTriangles::CellTriangles(const Brick& brick) : with_seeds(cells_of(brick.active)) {
  for (std::size_t cell = 0; cell + 1 < first.size(); ++cell) {
    const auto c = static_cast<int>(cell);
    const int sample = kCell * (64 * (c >> 4) + 8 * (c >> 2 & 3) + (c & 3));
    for (int i = 0; (with_seeds >> cell & 1) != 0 && i < 8; ++i) {
      const int s = sample + 64 * (i >> 2) + 8 * (i >> 1 & 1) + (i & 1);
      if ((brick.active[s >> 6] >> (s & 63) & 1) == 0) continue;
      const std::uint32_t triangle = brick.triangles[brick.nearest[s] >> 2];
      if (std::find(triangles.begin() + first[cell], triangles.end(), triangle) ==
          triangles.end()) {
        triangles.push_back(triangle);
      }
    }
    first[cell + 1] = static_cast<std::uint16_t>(triangles.size());
  }
}

void CellTriangles::add(std::span<const Small> small) {
  constexpr std::size_t kMostSmall = 32;  // a cell; more hardly come nearer, and cost
  auto starts = first;
  std::vector<std::uint32_t> all;
  all.reserve(triangles.size() + std::min(small.size(), first.size() * kMostSmall));
  std::size_t next = 0;
  for (std::size_t cell = 0; cell + 1 < first.size(); ++cell) {
    const auto known =
        std::span(triangles).subspan(first[cell], std::size_t{first[cell + 1]} - first[cell]);
    std::size_t end = next;
    while (end < small.size() && small[end].cell == cell) ++end;
    starts[cell] = static_cast<std::uint16_t>(all.size());
    all.insert(all.end(), known.begin(), known.end());
    const std::size_t step = (end - next + kMostSmall - 1) / kMostSmall;
    for (; (with_seeds >> cell & 1) != 0 && next < end; next += step) {
      const std::uint32_t triangle = small[next].triangle;
      if (std::find(known.begin(), known.end(), triangle) == known.end()) all.push_back(triangle);
    }
    next = end;
  }
  starts.back() = static_cast<std::uint16_t>(all.size());
  first = starts;
  triangles = std::move(all);
}

CellSites::CellSites(const SignedMesh& mesh, const Lattice& lattice, const Job& job)
    : seeds(find_seeds<CellTriangles>(
          mesh, lattice, kLeastSeedWidth, [](const Brick& brick) { return CellTriangles(brick); },
          job)),
      blocks(blocks_of(seeds.table)),
      bits(blocks.size(), SiteBits{}) {
  for (std::size_t i = 0; i < seeds.bricks.size(); ++i) {
    const glm::ivec3& c = seeds.table.coordinates()[i];
    add_cells(seeds.bricks[i]->with_seeds, c, bits[static_cast<std::size_t>(blocks.find(c >> 1))]);
  }
  add_small_triangles(mesh.soup, lattice, job);
}

void CellSites::add_small_triangles(const TriangleSoup& soup, const Lattice& lattice,
                                    const Job& job) {
  struct Place {
    std::int32_t brick;
    CellTriangles::Small small;
  };
  std::vector<Place> places(soup.triangles.size());
  parallel_for(places.size(), 4096, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto triangle = static_cast<std::uint32_t>(t);
      glm::dvec3 corners[3];
      index_corners(soup, lattice, triangle, corners);
      places[t].brick = BrickTable::kNone;
      if (!is_small(corners)) continue;
      const glm::ivec3 at(glm::round((corners[0] + corners[1] + corners[2]) / 3.0));
      const glm::ivec3 cell = at >> 1 & (kBrickCells - 1);
      places[t] = {
          seeds.table.find(at >> 3),
          {static_cast<std::size_t>((cell.x * kBrickCells + cell.y) * kBrickCells + cell.z),
           triangle}};
    }
  });
  std::erase_if(places, [](const Place& place) { return place.brick == BrickTable::kNone; });
  const auto key = [](const Place& p) {
    return std::tuple(p.brick, p.small.cell, p.small.triangle);
  };
  std::sort(places.begin(), places.end(),
            [&](const Place& a, const Place& b) { return key(a) < key(b); });
  std::vector<CellTriangles::Small> of_brick;
  for (std::size_t i = 0; i < places.size(); ++i) {
    of_brick.push_back(places[i].small);
    if (i + 1 < places.size() && places[i + 1].brick == places[i].brick) continue;
    seeds.bricks[static_cast<std::size_t>(places[i].brick)]->add(of_brick);
    of_brick.clear();
  }
}

CellsAround::CellsAround(const CellSites& sites, int reach)
    : sites_(sites),
      halo_(reach + 2),
      side_(kBlockCells + 2 * halo_),
      marked_(kRows * kRows),
      alone_(kRows * kRows),
      with_seeds_(kRows * kRows),
      brick_halo_((halo_ + kBrickCells - 1) / kBrickCells),
      brick_side_(kBlockCells / kBrickCells + 2 * brick_halo_),
      bricks_(static_cast<std::size_t>(brick_side_ * brick_side_ * brick_side_)) {
  static_assert(kBlockCells + 2 * (kLargestReach + 2) <= kRows);
}

void CellsAround::begin_block(const glm::ivec3& block) {
  std::fill(with_seeds_.begin(), with_seeds_.end(), 0);
  const int blocks = (halo_ + kBlockCells - 1) / kBlockCells;
  for (int x = -blocks; x <= blocks; ++x) {
    for (int y = -blocks; y <= blocks; ++y) {
      for (int z = -blocks; z <= blocks; ++z) add_block(block, {x, y, z});
    }
  }
  first_brick_ = block * (kBlockCells / kBrickCells) - brick_halo_;
  std::fill(bricks_.begin(), bricks_.end(), kUnknown);
}

// The cells with seeds of the block at an offset.
void CellsAround::add_block(const glm::ivec3& block, const glm::ivec3& offset) {
  const std::int32_t i = sites_.blocks.find(block + offset);
  if (i == BrickTable::kNone) return;
  const SiteBits& bits = sites_.bits[static_cast<std::size_t>(i)];
  const glm::ivec3 first = offset * kBlockCells + halo_;
  const glm::ivec3 low = glm::max(-first, glm::ivec3(0));
  const glm::ivec3 high = glm::min(glm::ivec3(side_) - first, glm::ivec3(kBlockCells));
  for (int x = low.x; x < high.x; ++x) {
    for (int y = low.y; y < high.y; ++y) {
      const std::uint64_t row = bits[static_cast<std::size_t>(x)] >> (8 * y) & 0xffU;
      with_seeds_[static_cast<std::size_t>(kRows * (first.x + x) + first.y + y)] |=
          first.z < 0 ? row >> -first.z : row << first.z;
    }
  }
}

void CellsAround::collect(TriangleSet& set) {
  for (int x = lowest_ - 1; x <= highest_ + 1; ++x) {
    for (int y = 1; y + 1 < side_; ++y) {
      const auto r = static_cast<std::size_t>(kRows * x + y);
      const std::uint64_t beside =
          marked_[r - 1] | marked_[r + 1] | marked_[r - kRows] | marked_[r + kRows];
      const std::uint64_t in_row = marked_[r] | marked_[r] << 1 | marked_[r] >> 1;
      std::uint64_t found = (in_row | beside | alone_[r]) & with_seeds_[r];
      for (; found != 0; found &= found - 1) {
        add_triangles(glm::ivec3(x, y, std::countr_zero(found)) - halo_, set);
      }
    }
  }
  if (lowest_ <= highest_) {
    for (auto* rows : {&marked_, &alone_}) {
      std::fill(rows->begin() + kRows * lowest_, rows->begin() + kRows * (highest_ + 1), 0);
    }
  }
  lowest_ = kRows;
  highest_ = 0;
}

void CellsAround::add_triangles(const glm::ivec3& cell, TriangleSet& set) {
  const glm::ivec3 b = (cell >> 2) + brick_halo_;  // kBrickCells is four
  std::int32_t& brick =
      bricks_[static_cast<std::size_t>((b.x * brick_side_ + b.y) * brick_side_ + b.z)];
  if (brick == kUnknown) brick = sites_.seeds.table.find(first_brick_ + b);
  if (brick == BrickTable::kNone) return;
  const CellTriangles& cells = *sites_.seeds.bricks[static_cast<std::size_t>(brick)];
  const glm::ivec3 at = cell & (kBrickCells - 1);
  const auto n = static_cast<std::size_t>((at.x * kBrickCells + at.y) * kBrickCells + at.z);
  for (std::size_t i = cells.first[n]; i < cells.first[n + 1]; ++i) set.add(cells.triangles[i]);
}

}  // namespace sdfgrid
