#include "sdfgrid/grid/atlas_tables.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "sdfgrid/core/memory.h"
#include "sdfgrid/core/parallel.h"

namespace sdfgrid {
namespace {

// Fills one octant of Atlas::jumps: one more than the smallest of the seven slots ahead. The other
// octant of the table stays as it is.
class JumpTable {
 public:
  JumpTable(const Atlas& atlas, int octant, std::uint8_t* jumps)
      : atlas_(atlas),
        jumps_(jumps),
        shift_(4 * (octant & 1)),
        beyond_(static_cast<std::size_t>(atlas.dims.z), 255) {
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
    int behind = Atlas::kMostJump;  // the smallest of the four slots at the previous z
    for (int k = 0; k < count; ++k) {
      const int z = step_.z > 0 ? count - 1 - k : k;
      const auto jump_of = [&](const std::uint8_t* jumps) {
        return jumps[z] >> shift_ & Atlas::kMostJump;
      };
      const int beside = std::min({jump_of(ahead[0]), jump_of(ahead[1]), jump_of(ahead[2])});
      const bool crossing = atlas_.crossing_brick({x, y, z}) >= 0;
      const int jump = crossing ? 0 : std::min(std::min(beside, behind) + 1, Atlas::kMostJump);
      out[z] = static_cast<std::uint8_t>((out[z] & ~(Atlas::kMostJump << shift_)) | jump << shift_);
      behind = std::min(beside, jump);
    }
  }

  const Atlas& atlas_;
  std::uint8_t* jumps_;
  int shift_;                         // of the octant's four bits
  std::vector<std::uint8_t> beyond_;  // no crossing bricks there
  glm::ivec3 step_{1};
};

}  // namespace

bool copy_part(const float* from, float constant, double factor, int part, float* samples) {
  if (from != nullptr) return atlas_kernel().copy(from, factor, part, samples);
  float same[8 * 8 * 8];
  std::fill(std::begin(same), std::end(same), constant);
  return atlas_kernel().copy(same, factor, part, samples);
}

BrickRange::BrickRange(const SampleSurvey& survey) : low(survey.low), high(survey.high) {
  // A partial derivative is a mean of differences along edges of its direction.
  const float* d = survey.step;
  slope = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

void fill_jumps(Atlas& atlas, const Job& job) {
  const std::size_t slots = atlas.bricks.size();
  atlas.jumps.reserve(Atlas::kJumpTables * slots);
  prefer_large_pages(atlas.jumps.data(), atlas.jumps.capacity());
  atlas.jumps.resize(Atlas::kJumpTables * slots);
  parallel_for(Atlas::kJumpTables, 1, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t table = begin; table < end; ++table) {
      std::uint8_t* jumps = atlas.jumps.data() + table * slots;
      for (const int of_two : {0, 1}) JumpTable(atlas, int(2 * table) + of_two, jumps).fill(job);
    }
  });
}

}  // namespace sdfgrid
