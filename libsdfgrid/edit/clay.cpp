// What clay tools make of one brick; declared in brick_edit.h. A dab changes the field within its
// radius, by a weight that falls smoothly from one in the middle to zero at the rim.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "sdfgrid/edit/block.h"
#include "sdfgrid/edit/brick_edit.h"

namespace sdfgrid {
namespace {

// A dab moves the surface by so much at most, voxels: within the band, where distances are known.
constexpr float kFarthest = 1.0F;
constexpr int kApron = 3;

float weight(const glm::vec3& from_middle, float radius) {
  const float t = 1 - glm::dot(from_middle, from_middle) / (radius * radius);
  return t > 0 ? t * t : 0.0F;
}

// The mean of a sample and its 26 neighbours, near ones counted more (binomial weights).
float smoothed(const Block& block, const glm::ivec3& p) {
  float sum = 0;
  for (int n = 0; n < 27; ++n) {
    const glm::ivec3 d(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
    const int steps = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
    sum += block.at(p + d) * (steps == 0 ? 8.0F : steps == 1 ? 4.0F : steps == 2 ? 2.0F : 1.0F);
  }
  return sum / 64;
}

// The new value of a sample, voxels. `q` is its place from the dab's middle.
float shaped(const Stroke& stroke, const ClayDab& dab, const Block& block, const glm::ivec3& p,
             const glm::vec3& q) {
  const float value = block.at(p);
  const float w = dab.strength * weight(q, dab.radius);
  if (w <= 0) return value;
  switch (stroke.op) {
    case StrokeOp::inflate:
      return value - w * std::min(0.2F * dab.radius, kFarthest);
    case StrokeOp::deflate:
      return value + w * std::min(0.2F * dab.radius, kFarthest);
    case StrokeOp::smooth:
      return glm::mix(value, smoothed(block, p), w);
    case StrokeOp::flatten: {
      const float plane = glm::dot(dab.normal, q + dab.from_plane);
      return value + glm::clamp(w * (plane - value), -kFarthest, kFarthest);
    }
    case StrokeOp::pinch: {
      // What is further out moves in.
      const float distance = glm::length(q);
      const float step = std::min(w * 0.3F * distance, kFarthest);
      return distance > 0 ? block.sample(glm::vec3(p) + q * (step / distance)).value : value;
    }
    default:
      return value;
  }
}

}  // namespace

void shape_brick(const Stroke& stroke, const ClayDab& dab, const EditContext& context,
                 BrickEdit& edit) {
  Block block;
  block.fill(context.bricks, edit.brick, kApron, context.lattice.voxel);
  const auto voxel = static_cast<float>(context.lattice.voxel);
  const glm::vec3 first(8.0 * glm::dvec3(edit.brick) - dab.middle);
  CombineOutput& made = edit.made;
  made = CombineOutput{};
  made.after = edit.after;
  int inside = 0;
  int outside = 0;
  for (int i = 0; i < kBrickSamples; ++i) {
    const glm::ivec3 p(i >> 6, i >> 3 & 7, i & 7);
    const float before =
        edit.before.values != nullptr ? edit.before.values[i] : edit.before.constant;
    const float value = shaped(stroke, dab, block, p, first + glm::vec3(p));
    // Unchanged ones keep their bits.
    const float after = value == block.at(p) ? before
                                             : std::clamp(value * voxel, context.limits.inside,
                                                          context.limits.outside);
    edit.after[i] = after;
    const std::uint64_t bit = std::uint64_t{1} << (i & 63);
    if (after > context.limits.inside && after < context.limits.outside) {
      made.active[i >> 6] |= bit;
      made.suspect[i >> 6] |= bit;
    }
    if (after != before) made.changed[i >> 6] |= bit;
    made.any_changed = made.any_changed || after != before;
    inside += after <= context.limits.inside ? 1 : 0;
    outside += after >= context.limits.outside ? 1 : 0;
  }
  made.all_inside = inside == kBrickSamples;
  made.all_outside = outside == kBrickSamples;
}

}  // namespace sdfgrid
