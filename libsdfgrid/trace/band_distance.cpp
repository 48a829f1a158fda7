#include "sdfgrid/trace/band_distance.h"

#include <algorithm>
#include <array>
#include <bit>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/trace/atlas_slot.h"

namespace sdfgrid {
namespace {

constexpr int kParts = 27;  // of a ring; the middle one is none

glm::ivec3 direction_of(int part) { return {part / 9 - 1, part / 3 % 3 - 1, part % 3 - 1}; }

bool holds_band(const Atlas& atlas, const glm::ivec3& at) {
  const AtlasSlot slot(atlas, at);
  if (slot.is_constant()) return false;
  const float* const samples = slot.samples();
  const auto outside = [&](float v) { return v >= atlas.outside; };
  const auto inside = [&](float v) { return v <= atlas.inside; };
  const float* const end = samples + Atlas::kSamples;
  return !std::all_of(samples, end, outside) && !std::all_of(samples, end, inside);
}

// The part of a ring in a direction is seen in the ring before it of the next slot that way: there
// it is all parts that lie in that direction, along whichever axes it has none.
std::array<std::uint32_t, kParts> parts_ahead() {
  std::array<std::uint32_t, kParts> ahead{};
  for (int part = 0; part < kParts; ++part) {
    const glm::ivec3 direction = direction_of(part);
    for (int other = 0; other < kParts; ++other) {
      const glm::ivec3 there = direction_of(other);
      bool lies = true;
      for (int a = 0; a < 3; ++a) lies = lies && (direction[a] == 0 || there[a] == direction[a]);
      if (lies) ahead[part] |= std::uint32_t{1} << other;
    }
  }
  return ahead;
}

}  // namespace

BandDistance::BandDistance(const Atlas& atlas, const Job& job)
    : slots_(atlas.bricks.size(), kRings) {
  const glm::ivec3 dims = atlas.dims;
  parallel_for(static_cast<std::size_t>(dims.x), 1, job, [&](std::size_t begin, std::size_t end) {
    for (int x = int(begin); x < int(end); ++x) {
      for (int y = 0; y < dims.y; ++y) {
        for (int z = 0; z < dims.z; ++z) {
          if (holds_band(atlas, {x, y, z})) slots_[atlas.place({x, y, z})] = 0;
        }
      }
    }
  });
  std::vector<std::size_t> reached;  // all slots of one ring
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (slots_[i] == 0) reached.push_back(i);
  }
  const std::array<std::uint32_t, kParts> ahead = parts_ahead();
  std::vector<std::size_t> next;
  for (std::uint32_t ring = 1; ring < kRings && !reached.empty(); ++ring) {
    job.checkpoint();
    next.clear();
    for (const std::size_t i : reached) {
      const auto n = static_cast<std::int64_t>(i);
      const glm::ivec3 slot(n / (std::int64_t(dims.y) * dims.z), n / dims.z % dims.y, n % dims.z);
      for (int part = 0; part < kParts; ++part) {
        const glm::ivec3 from = slot - direction_of(part);
        const bool within = from.x >= 0 && from.y >= 0 && from.z >= 0 && from.x < dims.x &&
                            from.y < dims.y && from.z < dims.z;
        if (!within) continue;
        std::uint32_t& word = slots_[atlas.place(from)];
        if ((word & kRings) < ring) continue;
        if ((word & kRings) > ring) {
          word = ring;
          next.push_back(atlas.place(from));
        }
        if (ring == 1 || (slots_[i] >> kRingBits & ahead[part]) != 0) {
          word |= std::uint32_t{1} << (kRingBits + part);
        }
      }
    }
    reached.swap(next);
  }
}

double BandDistance::operator()(std::size_t place, const glm::dvec3& at) const {
  constexpr int kEdge = Atlas::kBrick;
  const std::uint32_t word = slots_[place];
  const auto rings = static_cast<int>(word & kRings);
  if (rings == 0) return 0;
  if (rings == kRings) return double(kEdge * (kRings - 1));
  // To the slot's own faces, by axis and direction.
  double to[3][3];
  for (int a = 0; a < 3; ++a) {
    to[a][0] = at[a];
    to[a][1] = 0;
    to[a][2] = kEdge - at[a];
  }
  double least = kEdge;
  for (std::uint32_t left = word >> kRingBits; left != 0; left &= left - 1) {
    const int part = std::countr_zero(left);
    least = std::min(least, std::max({to[0][part / 9], to[1][part / 3 % 3], to[2][part % 3]}));
  }
  return kEdge * (rings - 1) + least;
}

}  // namespace sdfgrid
