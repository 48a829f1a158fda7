#include "sdfgrid/grid/live_atlas.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <glm/common.hpp>
#include <limits>
#include <tuple>

#include "sdfgrid/grid/atlas_kernel.h"
#include "sdfgrid/grid/atlas_tables.h"

namespace sdfgrid {
namespace {

constexpr std::size_t kNobody = std::numeric_limits<std::size_t>::max();
constexpr std::size_t kSamples = Atlas::kSamples;
constexpr std::size_t kHops = Atlas::kHops;

// Of a row of jumps makes those up to `limit` no longer than their Chebyshev distance, max(least,
// place). Returns the end of those that were.
int shorten_row(std::uint8_t* row, int step, int limit, int least) {
  int end = 0;
  for (int z = 0; z <= limit; ++z) {
    std::uint8_t& jump = row[z * step];
    const int most = std::max(least, z);
    if (jump <= most) continue;
    jump = static_cast<std::uint8_t>(most);
    end = z + 1;
  }
  return end;
}

// Whether the samples of a part all lie beyond the margin, on the inside or on the outside.
bool is_beyond(const float* samples, int part, bool inside, float margin) {
  const glm::ivec3 step(part >> 2, part >> 1 & 1, part & 1);
  const glm::ivec3 count = 8 - 7 * step;
  const float sign = inside ? -1.0F : 1.0F;
  for (int x = 0; x < count.x; ++x) {
    for (int y = 0; y < count.y; ++y) {
      const float* row =
          samples + ((x + 8 * step.x) * Atlas::kEdge + y + 8 * step.y) * Atlas::kEdge + 8 * step.z;
      bool beyond = true;
      for (int z = 0; z < count.z; ++z) beyond = beyond && sign * row[z] > margin;
      if (!beyond) return false;
    }
  }
  return true;
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
  marks_.assign(atlas_.bricks.size(), Stale::no);
  for (std::size_t place = 0; place < atlas_.bricks.size(); ++place) {
    if (atlas_.bricks[place] >= 0) owner_[std::size_t(atlas_.bricks[place])] = place;
  }
}

bool LiveAtlas::within(const glm::ivec3& slot) const {
  return slot.x >= 0 && slot.y >= 0 && slot.z >= 0 && slot.x < atlas_.dims.x &&
         slot.y < atlas_.dims.y && slot.z < atlas_.dims.z;
}

void LiveAtlas::refresh(std::span<const glm::ivec3> changed, const Job& job) {
  stale_.clear();
  bool fits = true;
  for (std::size_t i = 0; i < changed.size(); ++i) {
    if (i + 1 < changed.size()) fetch(changed[i + 1] - atlas_.lo);
    fits = copy_brick(changed[i]) && fits;
  }
  if (!fits) {
    atlas_ = make_atlas(grid_, job);
    return adopt();
  }
  for (std::size_t i = 0; i < stale_.size(); ++i) {
    if (i + 1 < stale_.size()) fetch(stale_[i + 1]);
    Stale& mark = marks_[atlas_.place(stale_[i])];
    mark == Stale::all ? refresh_slot(stale_[i]) : refresh_slope(stale_[i]);
    mark = Stale::no;
  }
}

// Copies what changed of a brick to where the atlas has it, in its own slot and those before it.
// Marks those as stale of which the tables may say something else now. Returns whether all slots
// that are needed exist.
bool LiveAtlas::copy_brick(const glm::ivec3& brick) {
  GridBrick now = bricks_.find(brick);
  const double per_voxel = 1 / atlas_.lattice.voxel;
  alignas(64) float voxels[kBrickSamples];
  PartRanges parts;
  if (now.values != nullptr) {
    atlas_kernel().scale(now.values, per_voxel, kBrickSamples, voxels);
    atlas_kernel().parts(voxels, parts);
    now.values = voxels;
  } else {
    now.constant = static_cast<float>(now.constant * per_voxel);
    for (int n = 0; n < 8; ++n) parts.low[n] = parts.high[n] = now.constant;
  }
  for (int n = 0; n < 8; ++n) {
    const glm::ivec3 slot = brick - atlas_.lo - glm::ivec3(n >> 2, n >> 1 & 1, n & 1);
    if (!within(slot)) {
      if (bricks_.find(slot + atlas_.lo).values != nullptr) return false;
      continue;
    }
    const Stale stale = n == 0 ? Stale::all : staleness(slot, parts, n);
    const std::size_t place = atlas_.place(slot);
    if (const std::int32_t at = atlas_.bricks[place]; at >= 0) {
      copy_part(now.values, now.constant, n, atlas_.samples.data() + std::size_t(at) * kSamples);
    }
    if (stale == Stale::no) continue;
    if (marks_[place] == Stale::no) stale_.push_back(slot);
    marks_[place] = std::max(marks_[place], stale);
  }
  return true;
}

// What the tables may say wrongly of a slot once it gets part n of a brick. As long as all samples
// of the part stay on one side, well away from zero, no cell begins or ceases to be crossing.
LiveAtlas::Stale LiveAtlas::staleness(const glm::ivec3& slot, const PartRanges& parts,
                                      int n) const {
  const std::int32_t at = atlas_.bricks[atlas_.place(slot)];
  const float margin = atlas_.margin();
  const bool inside = parts.high[n] < -margin;
  if (!inside && !(parts.low[n] > margin)) return Stale::all;
  if (at < 0) return inside == (at == Atlas::kInside) ? Stale::no : Stale::all;
  const float* samples = atlas_.samples.data() + std::size_t(at) * kSamples;
  if (at >= atlas_.crossing) return inside == (samples[0] < 0) ? Stale::no : Stale::all;
  return is_beyond(samples, n, inside, margin) ? Stale::slope : Stale::all;
}

// Asks for a slot's data ahead of time: most of the work is waiting for memory.
void LiveAtlas::fetch(const glm::ivec3& slot) const {
  if (!within(slot)) return;
  const std::int32_t at = atlas_.bricks[atlas_.place(slot)];
  if (at < 0) return;
  constexpr std::size_t kLine = 16;  // floats
  const float* samples = atlas_.samples.data() + std::size_t(at) * kSamples;
  for (std::size_t i = 0; i < kSamples; i += kLine) __builtin_prefetch(samples + i, 1);
  if (at >= atlas_.crossing) return;
  const std::uint32_t* hops = atlas_.hops.data() + std::size_t(at) * kHops;
  for (std::size_t i = 0; i < kHops; i += kLine) __builtin_prefetch(hops + i, 1);
}

// Copies all samples of a slot's cells; returns whether it has samples of its own.
bool LiveAtlas::gather(const glm::ivec3& slot, float* samples) const {
  bool has_samples = false;
  for (int n = 0; n < 8; ++n) {
    const glm::ivec3 step(n >> 2, n >> 1 & 1, n & 1);
    const GridBrick from = bricks_.find(atlas_.lo + slot + step);
    if (n == 0) has_samples = from.values != nullptr;
    copy_part(from.values, from.constant, n, samples);
  }
  atlas_kernel().scale(samples, 1 / atlas_.lattice.voxel, Atlas::kSamples, samples);
  return has_samples;
}

void LiveAtlas::refresh_slope(const glm::ivec3& slot) {
  const auto at = std::size_t(atlas_.bricks[atlas_.place(slot)]);
  atlas_.slope = std::max(atlas_.slope, brick_range(atlas_.samples.data() + at * kSamples).slope);
}

// Makes the tables say of a slot what its samples say.
void LiveAtlas::refresh_slot(const glm::ivec3& slot) {
  const std::size_t place = atlas_.place(slot);
  const std::int32_t had = atlas_.bricks[place];
  float gathered[kSamples];
  bool has_samples = false;
  if (had < 0) has_samples = gather(slot, gathered);
  const float* samples = had < 0 ? gathered : atlas_.samples.data() + std::size_t(had) * kSamples;
  const BrickRange range = brick_range(samples);
  const bool sign_change = !range.finite || (range.low < 0 && range.high >= 0);
  const bool crossed = had >= 0 && had < atlas_.crossing;
  if (!sign_change && had >= 0) has_samples = bricks_.find(slot + atlas_.lo).values != nullptr;
  if (!has_samples && !sign_change) {
    if (had >= 0) free_brick(place);
    atlas_.bricks[place] = range.low < 0 ? Atlas::kInside : Atlas::kOutside;
    if (crossed) lengthen_jumps(slot);
    return;
  }
  atlas_.slope = std::max(atlas_.slope, range.slope);
  const float margin = atlas_.margin();
  // One that was crossing stays in that part: its cells say that it is not.
  const bool crossing = crossed || !range.finite || (range.low <= margin && range.high >= -margin);
  std::int32_t brick = had;
  if (had < 0 || crossing != crossed) {
    if (had >= 0) std::copy(samples, samples + kSamples, gathered);  // it may move
    brick = take_brick(place, crossing);
    samples = gathered;
    std::copy(gathered, gathered + kSamples, atlas_.samples.data() + std::size_t(brick) * kSamples);
  }
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

// A crossing brick appeared: no cube of the slots behind it may reach it.
void LiveAtlas::shorten_jumps(const glm::ivec3& slot) {
  for (int octant = 0; octant < Atlas::kOctants; ++octant) {
    std::uint8_t* jumps = atlas_.jumps.data() + std::size_t(octant) * atlas_.bricks.size();
    glm::ivec3 step(1);   // to the next slot behind
    glm::ivec3 count(0);  // of slots behind
    for (int a = 0; a < 3; ++a) {
      const bool down = (octant >> (2 - a) & 1) != 0;
      step[a] = down ? 1 : -1;
      count[a] = std::min(down ? atlas_.dims[a] - 1 - slot[a] : slot[a], Atlas::kMostJump);
    }
    // The cube of a slot holds that of its successor towards the new brick, but for one layer. So
    // where one is too long, that of its successor was: a row is looked at as far as the row
    // before it was shortened, and one further.
    std::array<int, Atlas::kMostJump + 1> ends{};  // of each row, for the plane last looked at
    int rows = count.y + 1;                        // that may need it
    for (int x = 0; x <= count.x && rows > 0; ++x) {
      int before = x > 0 ? ends[0] : count.z;
      int shortened = 0;
      for (int y = 0; y < rows; ++y) {
        const std::size_t place = atlas_.place(slot + glm::ivec3(x * step.x, y * step.y, 0));
        const int end =
            shorten_row(jumps + place, step.z, std::min(before, count.z), std::max(x, y));
        before = x > 0 ? ends[std::size_t(y)] : end;
        ends[std::size_t(y)] = end;
        if (end > 0) shortened = y + 1;
        if (x == 0 && end == 0) break;
      }
      rows = std::min(shortened == 0 ? 0 : shortened + 1, count.y + 1);
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
