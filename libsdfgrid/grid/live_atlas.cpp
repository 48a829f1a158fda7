#include "sdfgrid/grid/live_atlas.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <glm/common.hpp>
#include <iterator>
#include <limits>

#include "sdfgrid/grid/atlas_kernel.h"
#include "sdfgrid/grid/atlas_tables.h"

namespace sdfgrid {
namespace {

constexpr std::size_t kNobody = std::numeric_limits<std::size_t>::max();
constexpr std::size_t kSamples = Atlas::kSamples;
constexpr std::size_t kHops = Atlas::kHops;

// Of a row of slots, in the direction `step` of z, makes the jumps up to `limit` no longer than
// their Chebyshev distance, max(least, place). They are those of the octant that looks back.
// Returns whether any was longer.
bool shorten_row(std::uint8_t* row, int step, int limit, int least) {
  constexpr int kRow = Atlas::kMostJump + 1;
  using Bytes [[gnu::vector_size(kRow)]] = std::uint8_t;
  static_assert(kRow == 16, "a row is one vector");
  const std::uint8_t shift = step > 0 ? 4 : 0;
  const std::uint8_t own_bits = step > 0 ? 0xf0 : 0x0f;
  if (limit == Atlas::kMostJump) {
    constexpr Bytes kUp = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    constexpr Bytes kDown = {15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0};
    std::uint8_t* first = step > 0 ? row : row - Atlas::kMostJump;
    const Bytes place = step > 0 ? kUp : kDown;
    const Bytes floor = Bytes{} + static_cast<std::uint8_t>(least);
    const Bytes most = (place > floor ? place : floor) << (Bytes{} + shift);
    const Bytes own = Bytes{} + own_bits;
    Bytes both;
    std::memcpy(&both, first, sizeof both);
    const auto longer = (Bytes)((both & own) > most);
    std::uint64_t words[2];
    std::memcpy(words, &longer, sizeof words);
    if ((words[0] | words[1]) == 0) return false;
    both = longer ? (both & ~own) | most : both;
    std::memcpy(first, &both, sizeof both);
    return true;
  }
  bool any = false;
  for (int z = 0; z <= limit; ++z) {
    std::uint8_t& both = row[z * step];
    const int jump = both >> shift & Atlas::kMostJump;
    const int most = std::max(least, z);
    if (jump <= most) continue;
    any = true;
    both = static_cast<std::uint8_t>((both & ~own_bits) | most << shift);
  }
  return any;
}

// The parts of bricks (copy_part() in atlas_tables.h) that have samples of the set, a bit each.
unsigned parts_with(const std::uint64_t (&samples)[kBrickWords]) {
  constexpr std::uint64_t kFirstRow = 0xff;                    // y = 0
  constexpr std::uint64_t kFirstOfRows = 0x0101010101010101U;  // z = 0
  std::uint64_t all = 0;
  for (const std::uint64_t word : samples) all |= word;
  unsigned parts = 0;
  for (unsigned n = 0; n < 8; ++n) {
    std::uint64_t set = (n & 4) != 0 ? samples[0] : all;
    if ((n & 2) != 0) set &= kFirstRow;
    if ((n & 1) != 0) set &= kFirstOfRows;
    if (set != 0) parts |= 1U << n;
  }
  return parts;
}

// The parts that a brick has negative samples in (positive ones, if not `negative`).
unsigned parts_on_side(const GridBrick& brick, bool negative) {
  if (brick.values == nullptr) return (brick.constant < 0) == negative ? 0xff : 0;
  std::uint64_t samples[kBrickWords];
  atlas_kernel().negatives(brick.values, samples);
  for (std::uint64_t& word : samples) word = negative ? word : ~word;
  return parts_with(samples);
}

void fetch_lines(const void* begin, std::size_t bytes) {
  constexpr std::size_t kLine = 64;
  const auto* at = static_cast<const char*>(begin);
  for (std::size_t i = 0; i < bytes; i += kLine) __builtin_prefetch(at + i, 1);
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

void LiveAtlas::refresh(std::span<const BrickChange> changes, const Job& job) {
  if (!collect(changes)) {
    atlas_ = make_atlas(grid_, job);
    return adopt();
  }
  appeared_.clear();
  vanished_.clear();
  constexpr std::size_t kAhead = 3;
  for (std::size_t i = 0; i < std::min(kAhead, targets_.size()); ++i)
    fetch(atlas_.bricks[targets_[i].place]);
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    if (i + kAhead < targets_.size()) fetch(atlas_.bricks[targets_[i + kAhead].place]);
    update(targets_[i]);
  }
  for (std::size_t i = 0; i < appeared_.size(); ++i) {
    if (i + 1 < appeared_.size()) fetch_jumps(appeared_[i + 1]);
    shorten_jumps(appeared_[i]);
  }
  for (const glm::ivec3& slot : vanished_) lengthen_jumps(slot);
}

// Finds the slots that have samples of these. Returns whether all slots that are needed exist.
bool LiveAtlas::collect(std::span<const BrickChange> changes) {
  sources_.clear();
  targets_.clear();
  found_.assign(std::bit_ceil(16 * changes.size() + 1), -1);
  for (const BrickChange& change : changes) {
    const unsigned parts = parts_with(change.samples);
    if (parts == 0) continue;
    const auto source = static_cast<std::int32_t>(sources_.size());
    sources_.push_back(bricks_.find(change.brick));
    for (int n = 0; n < 8; ++n) {
      if ((parts >> n & 1) == 0) continue;
      const glm::ivec3 slot = change.brick - atlas_.lo - glm::ivec3(n >> 2, n >> 1 & 1, n & 1);
      if (within(slot)) {
        target_at(slot).from[n] = source;
      } else if (bricks_.find(slot + atlas_.lo).values != nullptr ||
                 (parts_on_side(sources_.back(), true) >> n & 1) != 0) {
        return false;
      }
    }
  }
  return true;
}

LiveAtlas::Target& LiveAtlas::target_at(const glm::ivec3& slot) {
  const std::size_t place = atlas_.place(slot);
  const std::size_t mask = found_.size() - 1;
  constexpr std::uint64_t kGoldenRatio = 0x9e3779b97f4a7c15U;
  for (std::size_t at = place * kGoldenRatio >> 32;; ++at) {
    std::int32_t& found = found_[at & mask];
    if (found >= 0 && targets_[std::size_t(found)].place != place) continue;
    if (found < 0) {
      found = static_cast<std::int32_t>(targets_.size());
      targets_.push_back({slot, place, {-1, -1, -1, -1, -1, -1, -1, -1}});
      __builtin_prefetch(atlas_.bricks.data() + place, 1);
    }
    return targets_[std::size_t(found)];
  }
}

// Asks for a brick's data ahead of time: most of the work is waiting for memory.
void LiveAtlas::fetch(std::int32_t brick) const {
  if (brick < 0) return;
  fetch_lines(atlas_.samples.data() + std::size_t(brick) * kSamples, kSamples * sizeof(float));
  if (brick >= atlas_.crossing) return;
  // Of the first octant, which says what cells are crossing. The others may only be written to.
  fetch_lines(atlas_.hops.data() + std::size_t(brick) * kHops, kHops / 8 * sizeof(std::uint32_t));
}

// Of a slot that has no samples and none of its own among those that changed: whether any of these
// lies on the other side.
bool LiveAtlas::is_reached(const Target& target, bool inside) const {
  for (int n = 1; n < 8; ++n) {
    if (target.from[n] < 0) continue;
    const GridBrick& source = sources_[std::size_t(target.from[n])];
    if ((parts_on_side(source, !inside) >> n & 1) != 0) return true;
  }
  return false;
}

// The brick of the grid that part n of a slot lies in.
GridBrick LiveAtlas::part(const Target& target, int n) const {
  const std::int32_t from = target.from[n];
  if (from >= 0) return sources_[std::size_t(from)];
  return bricks_.find(atlas_.lo + target.slot + glm::ivec3(n >> 2, n >> 1 & 1, n & 1));
}

// Makes the atlas say of a slot what the grid says.
void LiveAtlas::update(const Target& target) {
  const std::int32_t had = atlas_.bricks[target.place];
  const bool crossed = had >= 0 && had < atlas_.crossing;
  const bool own = target.from[0] >= 0;
  if (had < 0 && !own && !is_reached(target, had == Atlas::kInside)) return;
  float gathered[kSamples];
  float* samples = had < 0 ? gathered : atlas_.samples.data() + std::size_t(had) * kSamples;
  if (had < 0) std::fill(std::begin(gathered), std::end(gathered), 0.0F);  // it is compared with
  bool changed = own || had < 0;
  for (int n = 0; n < 8; ++n) {
    if (had >= 0 && target.from[n] < 0) continue;
    const GridBrick from = part(target, n);
    changed |= copy_part(from.values, from.constant, 1 / atlas_.lattice.voxel, n, samples);
  }
  if (!changed) return;
  SampleSurvey survey;
  atlas_kernel().survey(samples, atlas_.margin(), survey);
  const BrickRange range(survey);
  if (!range.changes_sign() && part(target, 0).values == nullptr) {
    if (had >= 0) free_brick(target.place);
    atlas_.bricks[target.place] = range.low < 0 ? Atlas::kInside : Atlas::kOutside;
    if (crossed) vanished_.push_back(target.slot);
    return;
  }
  if (range.slope > atlas_.slope) {  // the margin grows with it
    atlas_.slope = range.slope;
    atlas_kernel().survey(samples, atlas_.margin(), survey);
  }
  // One that was crossing stays in that part: its cells say that it is not.
  const bool crossing = crossed || range.crossing(atlas_.margin());
  std::int32_t brick = had;
  if (had < 0 || crossing != crossed) {
    if (had >= 0) std::copy(samples, samples + kSamples, gathered);  // it may move
    brick = take_brick(target.place, crossing);
    std::copy(gathered, gathered + kSamples, atlas_.samples.data() + std::size_t(brick) * kSamples);
  }
  if (!crossing) return;
  std::uint32_t* hops = atlas_.hops.data() + std::size_t(brick) * kHops;
  std::uint64_t before[kBrickWords];
  if (crossed) atlas_kernel().crossing_of(hops, before);
  if (crossed && std::equal(std::begin(before), std::end(before), survey.crossing)) return;
  atlas_kernel().hops(survey.crossing, hops);
  if (!crossed) appeared_.push_back(target.slot);
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
  if (!free.empty()) fetch(free.back());  // dabs add several
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

// Asks for what shorten_jumps() reads in any case.
void LiveAtlas::fetch_jumps(const glm::ivec3& slot) const {
  for (int table = 0; table < Atlas::kJumpTables; ++table) {
    const std::uint8_t* jumps = atlas_.jumps.data() + std::size_t(table) * atlas_.bricks.size();
    const glm::ivec3 step((table & 2) != 0 ? 1 : -1, (table & 1) != 0 ? 1 : -1, 0);
    for (int n = 0; n < 4; ++n) {
      const glm::ivec3 behind = slot + step * glm::ivec3(n >> 1, n & 1, 0);
      if (within(behind)) __builtin_prefetch(jumps + atlas_.place(behind), 1);
    }
  }
}

// A crossing brick appeared: no cube of the slots behind it may reach it.
void LiveAtlas::shorten_jumps(const glm::ivec3& slot) {
  for (int table = 0; table < Atlas::kJumpTables; ++table) shorten_jumps(slot, table);
}

// The cube of a slot holds that of its successor towards the new brick, but for one layer. So where
// one is too long, that of its successor was: a plane is looked at as far as the plane before it
// was shortened, and one row further.
void LiveAtlas::shorten_jumps(const glm::ivec3& slot, int table) {
  const auto plane = static_cast<std::ptrdiff_t>(atlas_.dims.y) * atlas_.dims.z;
  std::uint8_t* jumps = atlas_.jumps.data() + std::size_t(table) * atlas_.bricks.size();
  const glm::ivec3 step((table & 2) != 0 ? 1 : -1, (table & 1) != 0 ? 1 : -1, 0);
  const auto slots_behind = [&](int a, bool up) {
    return std::min(up ? atlas_.dims[a] - 1 - slot[a] : slot[a], Atlas::kMostJump);
  };
  const int count_x = slots_behind(0, step.x > 0);
  const int count_y = slots_behind(1, step.y > 0);
  // Of the two octants, one behind the other in z.
  const int count_z[2] = {slots_behind(2, false), slots_behind(2, true)};
  int rows[2] = {count_y + 1, count_y + 1};  // that may need it
  for (int x = 0; x <= count_x && std::max(rows[0], rows[1]) > 0; ++x) {
    int shortened[2] = {0, 0};
    for (int y = 0; y < std::max(rows[0], rows[1]); ++y) {
      std::uint8_t* row = jumps + atlas_.place(slot + glm::ivec3(x * step.x, y * step.y, 0));
      if (x < count_x) __builtin_prefetch(row + step.x * plane, 1);
      for (int up = 0; up < 2; ++up) {
        if (y >= rows[up]) continue;
        if (shorten_row(row, up != 0 ? 1 : -1, count_z[up], std::max(x, y))) {
          shortened[up] = y + 1;
        } else if (x == 0) {
          rows[up] = y;
        }
      }
    }
    for (int up = 0; up < 2; ++up) {
      rows[up] = std::min(shortened[up] == 0 ? 0 : shortened[up] + 1, count_y + 1);
    }
  }
}

// A crossing brick disappeared. Its own jumps may grow; those behind it stay as they are, which is
// safe.
void LiveAtlas::lengthen_jumps(const glm::ivec3& slot) {
  std::array<int, Atlas::kOctants> least;
  for (int octant = 0; octant < Atlas::kOctants; ++octant) {
    least[octant] = Atlas::kMostJump - 1;
    for (int n = 1; n < 8; ++n) {
      glm::ivec3 ahead = slot;
      for (int a = 0; a < 3; ++a) {
        if ((n >> (2 - a) & 1) != 0) ahead[a] += (octant >> (2 - a) & 1) != 0 ? -1 : 1;
      }
      if (within(ahead))
        least[octant] = std::min(least[octant], atlas_.jump(octant, atlas_.place(ahead)));
    }
  }
  for (int table = 0; table < Atlas::kJumpTables; ++table) {
    const int both = (least[2 * table] + 1) | (least[2 * table + 1] + 1) << 4;
    atlas_.jumps[std::size_t(table) * atlas_.bricks.size() + atlas_.place(slot)] =
        static_cast<std::uint8_t>(both);
  }
}

}  // namespace sdfgrid
