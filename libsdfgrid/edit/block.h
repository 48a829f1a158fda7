// edit/block.h: a brick of a grid with what lies around it, copied into one array, so that
// arithmetic beside it needs no tree. Internal to edit/.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "sdfgrid/edit/nearest_kernel.h"
#include "sdfgrid/grid/bricks.h"

namespace sdfgrid {

struct FieldSample {
  float value;
  glm::vec3 gradient;
};

// Values are in voxels. Positions count from the brick's first sample, so that its own samples are
// at 0 to 7 and those around it at -apron to 7 + apron.
class Block {
 public:
  // Copies the samples of `brick` and `apron` more on every side.
  void fill(const GridBricks& bricks, const glm::ivec3& brick, int apron, double voxel);

  [[nodiscard]] int apron() const { return apron_; }
  [[nodiscard]] int edge() const { return edge_; }      // samples a side
  [[nodiscard]] const float* row(int x, int y) const {  // of constant x and y; z from -apron on
    return values_.data() + static_cast<std::ptrdiff_t>((x + apron_) * edge_ + y + apron_) * edge_;
  }
  [[nodiscard]] BlockSamples samples() const { return {values_.data(), edge_, apron_}; }
  [[nodiscard]] float at(int x, int y, int z) const { return row(x, y)[z + apron_]; }
  [[nodiscard]] float at(const glm::ivec3& p) const { return at(p.x, p.y, p.z); }

  // The trilinear field and its gradient; positions are clamped to the block.
  [[nodiscard]] FieldSample sample(const glm::vec3& p) const;
  // Central differences at a sample that has neighbours in the block.
  [[nodiscard]] glm::vec3 gradient(const glm::ivec3& p) const;

 private:
  std::vector<float> values_;
  int apron_ = 0;
  int edge_ = 0;
};

}  // namespace sdfgrid
