// trace/atlas_slot.h: the samples of one slot of an atlas's tables, whether it has a brick or not
// (internal to trace/).
#pragma once

#include <algorithm>

#include "sdfgrid/grid/atlas.h"

namespace sdfgrid {

// A slot without a brick has one value everywhere but at its upper faces, where the samples are
// those of the slots after it.
class AtlasSlot {
 public:
  AtlasSlot(const Atlas& atlas, const glm::ivec3& slot)
      : brick_(atlas.bricks[atlas.place(slot)]), slot_(slot) {
    if (has_brick()) {
      samples_ = atlas.samples.data() + std::size_t(brick_) * Atlas::kSamples;
    } else if (before_a_brick(atlas)) {
      copy(atlas);
    }
  }
  AtlasSlot(const AtlasSlot&) = delete;
  AtlasSlot& operator=(const AtlasSlot&) = delete;

  [[nodiscard]] bool has_brick() const { return brick_ >= 0; }
  // Where there is no brick: one value, on this side of the surface.
  [[nodiscard]] bool is_constant() const { return samples_ == nullptr; }
  [[nodiscard]] bool is_inside() const { return brick_ == Atlas::kInside; }
  // kSamples, in their order; none of a constant slot.
  [[nodiscard]] const float* samples() const { return samples_; }

 private:
  [[nodiscard]] bool before_a_brick(const Atlas& atlas) const {
    for (int n = 1; n < 8; ++n) {
      const glm::ivec3 next = slot_ + glm::ivec3(n >> 2, n >> 1 & 1, n & 1);
      const bool within = next.x < atlas.dims.x && next.y < atlas.dims.y && next.z < atlas.dims.z;
      if (within && atlas.bricks[atlas.place(next)] >= 0) return true;
    }
    return false;
  }

  void copy(const Atlas& atlas) {
    const float own = is_inside() ? atlas.inside : atlas.outside;
    const glm::ivec3 first = (atlas.lo + slot_) * Atlas::kBrick;
    bool differs = false;
    for (int i = 0; i < Atlas::kSamples; ++i) {
      const glm::ivec3 at(i / (Atlas::kEdge * Atlas::kEdge), i / Atlas::kEdge % Atlas::kEdge,
                          i % Atlas::kEdge);
      const bool on_face = std::max({at.x, at.y, at.z}) == Atlas::kBrick;
      copied_[i] = on_face ? atlas.value(first + at) : own;
      differs = differs || copied_[i] != own;
    }
    if (differs) samples_ = copied_;
  }

  std::int32_t brick_;
  glm::ivec3 slot_;
  const float* samples_ = nullptr;
  float copied_[Atlas::kSamples];
};

}  // namespace sdfgrid
