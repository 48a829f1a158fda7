#include "sdfgrid/transform/nearest_sites.h"

#include <algorithm>
#include <bit>
#include <memory>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/transform/site_kernel.h"

namespace sdfgrid {
namespace {

constexpr std::size_t kBricksPerTask = 64;

int halo_bricks(int reach) { return (reach + 7) / 8; }

// The bricks within reach of those, along one axis.
BrickTable dilate(const BrickTable& table, int axis, int reach) {
  std::vector<glm::ivec3> all;
  const int halo = halo_bricks(reach);
  all.reserve(table.size() * static_cast<std::size_t>(2 * halo + 1));
  for (const glm::ivec3& c : table.coordinates()) {
    for (int d = -halo; d <= halo; ++d) {
      glm::ivec3 there = c;
      there[axis] += d;
      all.push_back(there);
    }
  }
  return BrickTable(std::move(all));
}

// What a step of d samples adds to a key, d from -reach to reach. `shift` is the axis's place.
std::vector<std::int32_t> key_steps(int reach, int shift) {
  std::vector<std::int32_t> steps;
  for (int d = -reach; d <= reach; ++d) steps.push_back((d * d << 18) + d * (1 << shift));
  return steps;
}

// Drops the bricks without a site.
void keep_found(const BrickTable& candidates, std::vector<SiteKeys>& keys,
                const std::vector<char>& found, BrickTable& table, std::vector<SiteKeys>& kept) {
  std::vector<glm::ivec3> coordinates;
  std::size_t count = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (found[i] == 0) continue;
    coordinates.push_back(candidates.coordinates()[i]);
    if (count != i) keys[count] = keys[i];
    ++count;
  }
  keys.resize(count);
  table = BrickTable(std::move(coordinates));
  kept = std::move(keys);
}

// The bricks beside one along an axis, those without keys null.
template <class Value>
struct Neighbors {
  const Value* at[2 * ((kLargestReach + 7) / 8) + 1];

  Neighbors(const BrickTable& table, std::span<const Value> values, const glm::ivec3& coordinate,
            int axis, int halo) {
    for (int d = -halo; d <= halo; ++d) {
      glm::ivec3 there = coordinate;
      there[axis] += d;
      const std::int32_t i = table.find(there);
      at[d + halo] = i == BrickTable::kNone ? nullptr : &values[static_cast<std::size_t>(i)];
    }
  }
};

static_assert(2 * ((kLargestReach + 7) / 8) + 1 <= 8, "a row's bits fit one word");

// The bits of one row along z, `halo` bricks to either side; the brick's own begin at 8 * halo.
std::uint64_t row_bits(const Neighbors<SiteBits>& bricks, int halo, int x, int y) {
  std::uint64_t bits = 0;
  for (int b = 0; b <= 2 * halo; ++b) {
    if (bricks.at[b] == nullptr) continue;
    const std::uint64_t byte = (*bricks.at[b])[static_cast<std::size_t>(x)] >> (8 * y) & 0xffU;
    bits |= byte << (8 * b);
  }
  return bits;
}

// The nearest set bit; the lower one of two.
std::int32_t line_key(std::uint64_t bits, int at, int reach) {
  const std::uint64_t low = bits << (63 - at);
  const std::uint64_t high = bits >> at;
  const int down = low == 0 ? 99 : std::countl_zero(low);
  const int up = high == 0 ? 99 : std::countr_zero(high);
  const int d = down <= up ? -down : up;
  if (std::min(down, up) > reach) return kNoSite;
  return (d * d << 18) + kNoOffset + d;
}

}  // namespace

NearestSites::NearestSites(const BrickTable& table, std::span<const SiteBits> sites, int reach,
                           const Job& job)
    : table_(table),
      reach_(reach),
      limit_((reach * reach + 1) << 18),
      line_table_({}),
      plane_table_({}),
      candidates_({}) {
  along_z(sites, job);
  along_y(job);
  candidates_ = dilate(plane_table_, 0, reach_);
}

void NearestSites::along_z(std::span<const SiteBits> sites, const Job& job) {
  const BrickTable candidates = dilate(table_, 2, reach_);
  std::vector<SiteKeys> keys(candidates.size());
  std::vector<char> found(candidates.size());
  const int halo = halo_bricks(reach_);
  parallel_for(candidates.size(), kBricksPerTask, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Neighbors<SiteBits> bricks(table_, sites, candidates.coordinates()[i], 2, halo);
      bool any = false;
      for (int row = 0; row < 64; ++row) {
        const std::uint64_t bits = row_bits(bricks, halo, row >> 3, row & 7);
        std::int32_t* out = &keys[i][static_cast<std::size_t>(8 * row)];
        for (int z = 0; z < 8; ++z) {
          out[z] = bits == 0 ? kNoSite : line_key(bits, 8 * halo + z, reach_);
          any = any || out[z] < kNoSite;
        }
      }
      found[i] = any ? 1 : 0;
    }
  });
  keep_found(candidates, keys, found, line_table_, line_keys_);
}

void NearestSites::along_y(const Job& job) {
  const BrickTable candidates = dilate(line_table_, 1, reach_);
  std::vector<SiteKeys> keys(candidates.size());
  std::vector<char> found(candidates.size());
  const int halo = halo_bricks(reach_);
  const std::vector<std::int32_t> add = key_steps(reach_, 6);
  parallel_for(candidates.size(), kBricksPerTask, job, [&](std::size_t begin, std::size_t end) {
    std::vector<std::int32_t> strip(static_cast<std::size_t>(64 * (2 * halo + 1)));
    for (std::size_t i = begin; i < end; ++i) {
      const Neighbors<SiteKeys> bricks(line_table_, line_keys_, candidates.coordinates()[i], 1,
                                       halo);
      for (int x = 0; x < 8; ++x) {
        for (int b = 0; b <= 2 * halo; ++b) {
          std::int32_t* to = strip.data() + 64 * b;
          if (bricks.at[b] != nullptr) {
            std::copy_n(bricks.at[b]->data() + 64 * x, 64, to);
          } else {
            std::fill_n(to, 64, kNoSite);
          }
        }
        site_kernel().nearest(strip.data() + 8 * (8 * halo - reach_), 8, reach_, add.data(),
                              keys[i].data() + 64 * x);
      }
      found[i] = 0;
      for (std::int32_t& key : keys[i]) {
        if (key >= limit_) key = kNoSite;
        if (key < kNoSite) found[i] = 1;
      }
    }
  });
  keep_found(candidates, keys, found, plane_table_, plane_keys_);
}

bool NearestSites::keys(std::size_t i, SiteKeys& keys) const {
  const int halo = halo_bricks(reach_);
  const Neighbors<SiteKeys> bricks(plane_table_, plane_keys_, candidates_.coordinates()[i], 0,
                                   halo);
  thread_local std::vector<std::int32_t> strip;
  strip.resize(static_cast<std::size_t>(512 * (2 * halo + 1)));
  for (int b = 0; b <= 2 * halo; ++b) {
    std::int32_t* to = strip.data() + 512 * b;
    if (bricks.at[b] != nullptr) {
      std::copy_n(bricks.at[b]->data(), 512, to);
    } else {
      std::fill_n(to, 512, kNoSite);
    }
  }
  const std::vector<std::int32_t> add = key_steps(reach_, 12);
  site_kernel().nearest(strip.data() + 64 * (8 * halo - reach_), 64, reach_, add.data(),
                        keys.data());
  bool any = false;
  for (std::int32_t& key : keys) {
    if (key >= limit_) key = kNoSite;
    any = any || key < kNoSite;
  }
  return any;
}

}  // namespace sdfgrid
