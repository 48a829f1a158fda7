#include "sdfgrid/grid/live_atlas.h"

#include <algorithm>
#include <cstring>
#include <glm/common.hpp>
#include <limits>
#include <tuple>

#include "sdfgrid/grid/atlas_tables.h"

namespace sdfgrid {
namespace {

constexpr std::size_t kNobody = std::numeric_limits<std::size_t>::max();
constexpr std::size_t kSamples = Atlas::kSamples;
constexpr std::size_t kHops = Atlas::kHops;

bool comes_before(const glm::ivec3& a, const glm::ivec3& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

// The slots whose samples lie in the changed bricks: their own, and those before them.
void affected_slots(std::span<const glm::ivec3> changed, const glm::ivec3& lo,
                    std::vector<glm::ivec3>& slots) {
  slots.clear();
  for (const glm::ivec3& brick : changed) {
    for (int n = 0; n < 8; ++n) {
      slots.push_back(brick - lo - glm::ivec3(n >> 2, n >> 1 & 1, n & 1));
    }
  }
  std::sort(slots.begin(), slots.end(), comes_before);
  slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
}

}  // namespace

LiveAtlas::LiveAtlas(const Grid& grid, const Job& job)
    : grid_(grid), bricks_(grid), atlas_(make_atlas(grid, job)) {
  adopt();
}

// Learns which slot each brick of a new atlas belongs to.
void LiveAtlas::adopt() {
  owner_.assign(atlas_.samples.size() / kSamples, kNobody);
  free_crossing_.clear();
  free_other_.clear();
  for (std::size_t place = 0; place < atlas_.bricks.size(); ++place) {
    if (atlas_.bricks[place] >= 0) owner_[std::size_t(atlas_.bricks[place])] = place;
  }
}

bool LiveAtlas::within(const glm::ivec3& slot) const {
  return slot.x >= 0 && slot.y >= 0 && slot.z >= 0 && slot.x < atlas_.dims.x &&
         slot.y < atlas_.dims.y && slot.z < atlas_.dims.z;
}

void LiveAtlas::refresh(std::span<const glm::ivec3> changed, const Job& job) {
  affected_slots(changed, atlas_.lo, slots_);
  const bool fits = std::all_of(slots_.begin(), slots_.end(), [&](const glm::ivec3& slot) {
    return within(slot) || bricks_.find(slot + atlas_.lo).values == nullptr;
  });
  if (!fits) {
    atlas_ = make_atlas(grid_, job);
    return adopt();
  }
  for (const glm::ivec3& slot : slots_) {
    if (within(slot)) refresh_slot(slot);
  }
}

// Copies the samples of a slot's cells; returns whether they change sign.
bool LiveAtlas::gather(const glm::ivec3& slot, float* samples, bool& has_samples) const {
  constexpr int kEdge = Atlas::kEdge;
  const double per_voxel = 1 / atlas_.lattice.voxel;
  for (int n = 0; n < 8; ++n) {
    const glm::ivec3 step(n >> 2, n >> 1 & 1, n & 1);
    const glm::ivec3 count = 8 - 7 * step;
    const GridBrick from = bricks_.find(atlas_.lo + slot + step);
    if (n == 0) has_samples = from.values != nullptr;
    const auto constant = static_cast<float>(from.constant * per_voxel);
    for (int x = 0; x < count.x; ++x) {
      for (int y = 0; y < count.y; ++y) {
        float* to = samples + ((x + 8 * step.x) * kEdge + y + 8 * step.y) * kEdge + 8 * step.z;
        const float* values = from.values != nullptr ? from.values + (x << 6 | y << 3) : nullptr;
        for (int z = 0; z < count.z; ++z) {
          to[z] = values != nullptr ? static_cast<float>(values[z] * per_voxel) : constant;
        }
      }
    }
  }
  std::size_t negative = 0;
  for (std::size_t i = 0; i < kSamples; ++i) negative += samples[i] < 0 ? 1 : 0;
  return negative != 0 && negative != kSamples;
}

void LiveAtlas::refresh_slot(const glm::ivec3& slot) {
  float samples[kSamples];
  bool has_samples = false;
  const bool sign_change = gather(slot, samples, has_samples);
  const std::size_t place = atlas_.place(slot);
  const bool crossed = atlas_.crossing_brick(slot) >= 0;
  if (!has_samples && !sign_change) {
    if (atlas_.bricks[place] >= 0) free_brick(place);
    atlas_.bricks[place] = samples[0] < 0 ? Atlas::kInside : Atlas::kOutside;
    if (crossed) lengthen_jumps(slot);
    return;
  }
  const BrickRange range = brick_range(samples);
  atlas_.slope = std::max(atlas_.slope, range.slope);
  const float margin = atlas_.margin();
  // One that was crossing stays in that part: its cells say that it is not.
  const bool crossing = crossed || !range.finite || (range.low <= margin && range.high >= -margin);
  const std::int32_t brick = take_brick(place, crossing);
  std::memcpy(atlas_.samples.data() + std::size_t(brick) * kSamples, samples, sizeof samples);
  if (!crossing) return;
  fill_hops(samples, margin, atlas_.hops.data() + std::size_t(brick) * kHops);
  if (!crossed) shorten_jumps(slot);
}

// The brick of a slot, in the part of the crossing ones or in the other.
std::int32_t LiveAtlas::take_brick(std::size_t place, bool crossing) {
  const std::int32_t now = atlas_.bricks[place];
  if (now >= 0 && (now < atlas_.crossing) == crossing) return now;
  if (now >= 0) free_brick(place);
  std::vector<std::int32_t>& free = crossing ? free_crossing_ : free_other_;
  if (free.empty()) {
    const auto count = static_cast<std::int32_t>(owner_.size());
    owner_.push_back(kNobody);
    atlas_.samples.resize(atlas_.samples.size() + kSamples);
    std::int32_t fresh = count;
    if (crossing) {  // the first of the others makes room
      if (atlas_.crossing < count) move_brick(atlas_.crossing, count);
      fresh = atlas_.crossing++;
      atlas_.hops.resize(atlas_.hops.size() + kHops);
    }
    free.push_back(fresh);
  }
  const std::int32_t brick = free.back();
  free.pop_back();
  owner_[std::size_t(brick)] = place;
  atlas_.bricks[place] = brick;
  return brick;
}

void LiveAtlas::free_brick(std::size_t place) {
  const std::int32_t brick = atlas_.bricks[place];
  (brick < atlas_.crossing ? free_crossing_ : free_other_).push_back(brick);
  owner_[std::size_t(brick)] = kNobody;
}

// Moves one of the bricks that are not crossing, or its free place.
void LiveAtlas::move_brick(std::int32_t from, std::int32_t to) {
  const std::size_t owner = owner_[std::size_t(from)];
  owner_[std::size_t(to)] = owner;
  owner_[std::size_t(from)] = kNobody;
  if (owner == kNobody) {
    std::replace(free_other_.begin(), free_other_.end(), from, to);
    return;
  }
  std::memcpy(atlas_.samples.data() + std::size_t(to) * kSamples,
              atlas_.samples.data() + std::size_t(from) * kSamples, kSamples * sizeof(float));
  atlas_.bricks[owner] = to;
}

// A crossing brick appeared: no cube of the slots behind it may reach it. If in one plane of slots
// none had to be shortened, none behind it has to: the cube of a slot holds that of its successor.
void LiveAtlas::shorten_jumps(const glm::ivec3& slot) {
  for (int octant = 0; octant < Atlas::kOctants; ++octant) {
    std::uint8_t* jumps = atlas_.jumps.data() + std::size_t(octant) * atlas_.bricks.size();
    const auto behind = [&](int axis) {  // how many slots there are, and the step to the next
      const bool down = (octant >> (2 - axis) & 1) != 0;
      const int most = down ? atlas_.dims[axis] - 1 - slot[axis] : slot[axis];
      return std::pair(std::min(most, Atlas::kMostJump), down ? 1 : -1);
    };
    const auto [count_x, step_x] = behind(0);
    const auto [count_y, step_y] = behind(1);
    const auto [count_z, step_z] = behind(2);
    for (int x = 0; x <= count_x; ++x) {
      bool shortened = false;
      for (int y = 0; y <= count_y; ++y) {
        std::uint8_t* row = jumps + atlas_.place(slot + glm::ivec3(x * step_x, y * step_y, 0));
        const int least = std::max(x, y);
        for (int z = 0; z <= count_z; ++z) {
          std::uint8_t& jump = row[z * step_z];
          const int most = std::max(least, z);
          if (jump <= most) continue;
          jump = static_cast<std::uint8_t>(most);
          shortened = true;
        }
      }
      if (!shortened) break;
    }
  }
}

// A crossing brick disappeared. Its own jumps may grow; those behind it stay as they are, which is
// safe.
void LiveAtlas::lengthen_jumps(const glm::ivec3& slot) {
  for (int octant = 0; octant < Atlas::kOctants; ++octant) {
    std::uint8_t* jumps = atlas_.jumps.data() + std::size_t(octant) * atlas_.bricks.size();
    int least = Atlas::kMostJump;
    for (int n = 1; n < 8; ++n) {
      glm::ivec3 ahead = slot;
      for (int a = 0; a < 3; ++a) {
        if ((n >> (2 - a) & 1) != 0) ahead[a] += (octant >> (2 - a) & 1) != 0 ? -1 : 1;
      }
      if (within(ahead)) least = std::min<int>(least, jumps[atlas_.place(ahead)]);
    }
    jumps[atlas_.place(slot)] = static_cast<std::uint8_t>(std::min(least + 1, Atlas::kMostJump));
  }
}

}  // namespace sdfgrid
