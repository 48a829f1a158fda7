// What clay tools make of one brick; declared in brick_edit.h. A dab changes the field within its
// radius, by a weight that falls smoothly from one in the middle to zero at the rim.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
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

// What a dab makes of a brick and what lies around it, voxels.
class Dab {
 public:
  Dab(const Stroke& stroke, const ClayDab& dab, const EditContext& context, const glm::ivec3& brick)
      : stroke_(stroke),
        dab_(dab),
        first_(8.0 * glm::dvec3(brick) - dab.middle),
        inside_(context.limits.inside * static_cast<float>(1 / context.lattice.voxel)),
        outside_(context.limits.outside * static_cast<float>(1 / context.lattice.voxel)) {
    const double voxel = context.lattice.voxel;
    block_.fill(context.bricks, brick, kApron, voxel);
    if (!has_band()) return;
    found_ = has_surface();
    const int apron = static_cast<int>(std::ceil(std::max(outside_, -inside_))) + 1;
    if (found_ || apron <= kApron) return;
    block_.fill(context.bricks, brick, apron, voxel);
    found_ = has_surface();
  }

  // Whether there is a band to move, with a surface that its samples can be distances to.
  [[nodiscard]] bool found() const { return found_; }
  [[nodiscard]] float before(const glm::ivec3& p) const { return block_.at(p); }

  // Moves the band, then the samples beyond it that it reaches now.
  void move(float* after) {
    for (int i = 0; i < kEdge * kEdge * kEdge; ++i) {
      const glm::ivec3 p = glm::ivec3(i / (kEdge * kEdge), i / kEdge % kEdge, i % kEdge) - 1;
      moved_[i] = in_band(p) ? shaped(p) : block_.at(p);
    }
    for (int i = 0; i < kBrickSamples; ++i) {
      const glm::ivec3 p(i >> 6, i >> 3 & 7, i & 7);
      after[i] = in_band(p) ? moved(p) : followed(p);
    }
  }

 private:
  static constexpr int kEdge = 10;  // of the brick and the samples beside it

  bool has_band() const {
    for (int x = -1; x <= 8; ++x) {
      for (int y = -1; y <= 8; ++y) {
        const float* row = block_.row(x, y) + block_.apron() - 1;
        for (int z = 0; z < kEdge; ++z) {
          if (row[z] > inside_ && row[z] < outside_) return true;
        }
      }
    }
    return false;
  }
  // Both signs, by their bits: most of the time is reading.
  bool has_surface() const {
    const float* values = block_.samples().values;
    const int count = block_.edge() * block_.edge() * block_.edge();
    std::uint32_t any = 0;
    std::uint32_t all = ~0U;
    for (int i = 0; i < count; ++i) {
      const auto bits = std::bit_cast<std::uint32_t>(values[i]);
      any |= bits;
      all &= bits;
    }
    return (any & ~all) >> 31 != 0;
  }
  bool in_band(const glm::ivec3& p) const {
    return block_.at(p) > inside_ && block_.at(p) < outside_;
  }
  float moved(const glm::ivec3& p) const {
    return moved_[((p.x + 1) * kEdge + p.y + 1) * kEdge + p.z + 1];
  }
  float shaped(const glm::ivec3& p) const;
  float followed(const glm::ivec3& p) const;

  const Stroke& stroke_;
  const ClayDab& dab_;
  glm::vec3 first_;  // the brick's first sample from the dab's middle
  float inside_, outside_;
  Block block_;
  bool found_ = false;
  float moved_[kEdge * kEdge * kEdge];
};

// A sample's value as the tool moves it.
float Dab::shaped(const glm::ivec3& p) const {
  const float value = block_.at(p);
  const glm::vec3 q = first_ + glm::vec3(p);
  const float w = dab_.strength * weight(q, dab_.radius);
  if (w <= 0) return value;
  switch (stroke_.op) {
    case StrokeOp::inflate:
      return value - w * std::min(0.2F * dab_.radius, kFarthest);
    case StrokeOp::deflate:
      return value + w * std::min(0.2F * dab_.radius, kFarthest);
    case StrokeOp::smooth:
      return glm::mix(value, smoothed(block_, p), w);
    case StrokeOp::flatten: {
      const float plane = glm::dot(dab_.normal, q + dab_.from_plane);
      return value + glm::clamp(w * (plane - value), -kFarthest, kFarthest);
    }
    case StrokeOp::pinch: {
      // What is further out moves in.
      const float distance = glm::length(q);
      const float step = std::min(w * 0.3F * distance, kFarthest);
      return distance > 0 ? block_.sample(glm::vec3(p) + q * (step / distance)).value : value;
    }
    default:
      return value;
  }
}

// The value of a sample at the band's limit, which is no distance: the tool's only as far as the
// neighbours in the band, as they are now, let the surface come. One of the 26 is within 28 degrees
// of the way to the surface, and so nearer to it by at least kNearer of the step.
float Dab::followed(const glm::ivec3& p) const {
  constexpr float kNearer = 0.75F;
  const float value = block_.at(p);
  const float wanted = shaped(p);
  if (wanted == value) return value;
  const float sign = value > 0 ? 1.0F : -1.0F;
  float nearest = sign * value;
  for (int n = 0; n < 27; ++n) {
    const glm::ivec3 d(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
    if (n == 13 || !in_band(p + d)) continue;
    nearest = std::min(nearest, sign * moved(p + d) + kNearer * glm::length(glm::vec3(d)));
  }
  return sign * std::min(sign * value, std::max(nearest, sign * wanted));
}

// What a tool makes of a sample is cut off at the range as a union or a difference is: `box` is
// the distance to it.
float cut_off(float before, float after, float box) {
  return after < before ? std::min(before, std::max(after, box))
                        : std::max(before, std::min(after, -box));
}

}  // namespace

void shape_brick(const Stroke& stroke, const ClayDab& dab, const EditContext& context,
                 BrickEdit& edit) {
  CombineOutput& made = edit.made;
  made = CombineOutput{};
  made.after = edit.after;
  const auto leave = [&] {
    if (edit.before.values == nullptr) return;
    std::copy_n(edit.before.active, kBrickWords, made.active);
    std::copy_n(edit.before.active, kBrickWords, made.suspect);
  };
  const glm::dvec3 first = 8.0 * glm::dvec3(edit.brick);
  if (glm::distance(dab.middle, glm::clamp(dab.middle, first, first + 7.0)) >= dab.radius) {
    return leave();
  }
  Dab shaper(stroke, dab, context, edit.brick);
  if (!shaper.found()) return leave();
  alignas(64) float moved[kBrickSamples];
  shaper.move(moved);
  float box[kBrickSamples];
  if (dab.clipped) range_distances(context, edit.brick, box);
  const auto voxel = static_cast<float>(context.lattice.voxel);
  int inside = 0;
  int outside = 0;
  for (int i = 0; i < kBrickSamples; ++i) {
    const glm::ivec3 p(i >> 6, i >> 3 & 7, i & 7);
    const float before =
        edit.before.values != nullptr ? edit.before.values[i] : edit.before.constant;
    float value = moved[i];
    if (dab.clipped) value = cut_off(shaper.before(p), value, box[i]);
    // Unchanged ones keep their bits.
    const float after = value == shaper.before(p) ? before
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
    inside += after == context.limits.inside ? 1 : 0;
    outside += after == context.limits.outside ? 1 : 0;
  }
  made.all_inside = inside == kBrickSamples;
  made.all_outside = outside == kBrickSamples;
}

}  // namespace sdfgrid
