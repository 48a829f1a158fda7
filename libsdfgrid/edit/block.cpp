#include "sdfgrid/edit/block.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace sdfgrid {
namespace {

// Most rows are as long as a brick, or as a narrow band's apron.
void scale_row(const float* __restrict from, int count, float scale, float* __restrict to) {
  if (count == 8) {
    for (int z = 0; z < 8; ++z) to[z] = from[z] * scale;
  } else if (count == 4) {
    for (int z = 0; z < 4; ++z) to[z] = from[z] * scale;
  } else {
    for (int z = 0; z < count; ++z) to[z] = from[z] * scale;
  }
}

}  // namespace

void Block::fill(const GridBricks& bricks, const glm::ivec3& brick, int apron, double voxel) {
  apron_ = apron;
  edge_ = 8 + 2 * apron;
  constexpr std::size_t kBehind = 15;  // for kernels that read sixteen at a time
  values_.resize(static_cast<std::size_t>(edge_) * edge_ * edge_ + kBehind);
  const auto scale = static_cast<float>(1 / voxel);
  const int around = (apron + 7) / 8;
  for (int bx = -around; bx <= around; ++bx) {
    for (int by = -around; by <= around; ++by) {
      for (int bz = -around; bz <= around; ++bz) {
        const glm::ivec3 offset = 8 * glm::ivec3(bx, by, bz);
        const GridBrick from = bricks.find(brick + glm::ivec3(bx, by, bz));
        const glm::ivec3 lo = glm::max(glm::ivec3(-apron), offset);
        const glm::ivec3 hi = glm::min(glm::ivec3(7 + apron), offset + 7);
        for (int x = lo.x; x <= hi.x; ++x) {
          for (int y = lo.y; y <= hi.y; ++y) {
            float* to = values_.data() +
                        static_cast<std::ptrdiff_t>((x + apron) * edge_ + y + apron) * edge_ +
                        apron;
            if (from.values == nullptr) {
              std::fill(to + lo.z, to + hi.z + 1, from.constant * scale);
              continue;
            }
            const float* values = from.values + (x - offset.x) * 64 + (y - offset.y) * 8 - offset.z;
            scale_row(values + lo.z, hi.z - lo.z + 1, scale, to + lo.z);
          }
        }
      }
    }
  }
}

FieldSample Block::sample(const glm::vec3& p) const {
  const glm::vec3 low(static_cast<float>(-apron_));
  const glm::vec3 high(static_cast<float>(6 + apron_));
  const glm::vec3 cell = glm::clamp(glm::floor(p), low, high);
  const glm::ivec3 i(cell);
  const glm::vec3 t = glm::clamp(p - cell, 0.0F, 1.0F);
  const float* v = row(i.x, i.y) + i.z + apron_;
  const std::ptrdiff_t dy = edge_;
  const std::ptrdiff_t dx = dy * edge_;
  const auto mix = [](float a, float b, float s) { return a + (b - a) * s; };
  // Along z, then y, then x; and the differences along each.
  const float v00 = mix(v[0], v[1], t.z);
  const float v01 = mix(v[dy], v[dy + 1], t.z);
  const float v10 = mix(v[dx], v[dx + 1], t.z);
  const float v11 = mix(v[dx + dy], v[dx + dy + 1], t.z);
  const float v0 = mix(v00, v01, t.y);
  const float v1 = mix(v10, v11, t.y);
  const float gz = mix(mix(v[1] - v[0], v[dy + 1] - v[dy], t.y),
                       mix(v[dx + 1] - v[dx], v[dx + dy + 1] - v[dx + dy], t.y), t.x);
  return {mix(v0, v1, t.x), {v1 - v0, mix(v01 - v00, v11 - v10, t.x), gz}};
}

glm::vec3 Block::gradient(const glm::ivec3& p) const {
  const float* v = row(p.x, p.y) + p.z + apron_;
  const std::ptrdiff_t dy = edge_;
  const std::ptrdiff_t dx = dy * edge_;
  return 0.5F * glm::vec3(v[dx] - v[-dx], v[dy] - v[-dy], v[1] - v[-1]);
}

}  // namespace sdfgrid
