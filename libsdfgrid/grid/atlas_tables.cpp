#include "sdfgrid/grid/atlas_tables.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/atlas_kernel.h"

namespace sdfgrid {
namespace {

constexpr int kEdge = Atlas::kEdge;

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

void copy_part(const float* from, float constant, int part, float* samples) {
  const glm::ivec3 step(part >> 2, part >> 1 & 1, part & 1);
  const glm::ivec3 count = 8 - 7 * step;
  float* first = samples + 8 * ((step.x * kEdge + step.y) * kEdge + step.z);
  for (int x = 0; x < count.x; ++x) {
    for (int y = 0; y < count.y; ++y) {
      float* to = first + (x * kEdge + y) * kEdge;
      if (from == nullptr) {
        std::fill(to, to + count.z, constant);
      } else if (count.z == 8) {
        std::memcpy(to, from + (x << 6 | y << 3), 8 * sizeof(float));
      } else {
        *to = from[x << 6 | y << 3];
      }
    }
  }
}

BrickRange brick_range(const float* samples) {
  SampleRange range;
  atlas_kernel().range(samples, range);
  // A partial derivative is a mean of differences along edges of its direction.
  const float* d = range.step;
  return {range.low, range.high, std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), range.finite};
}

void fill_hops(const float* samples, float margin, std::uint32_t* hops) {
  atlas_kernel().hops(samples, margin, hops);
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
