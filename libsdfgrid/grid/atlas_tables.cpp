#include "sdfgrid/grid/atlas_tables.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "sdfgrid/core/memory.h"
#include "sdfgrid/core/parallel.h"

namespace sdfgrid {
namespace {

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
  atlas.jumps.reserve(Atlas::kOctants * slots);
  prefer_large_pages(atlas.jumps.data(), atlas.jumps.capacity());
  atlas.jumps.resize(Atlas::kOctants * slots);
  parallel_for(Atlas::kOctants, 1, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t octant = begin; octant < end; ++octant) {
      JumpTable(atlas, int(octant), atlas.jumps.data() + octant * slots).fill(job);
    }
  });
}

}  // namespace sdfgrid
