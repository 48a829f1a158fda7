// transform/dense_seeds.h: where the surface runs between the samples of a dense volume (not
// installed).
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>

#include "sdfgrid/transform/transform.h"

namespace sdfgrid {

// A sample beside the surface, lengths in units of the smallest spacing.
struct SurfaceSeed {
  float distance;      // signed
  glm::vec3 to_point;  // from the sample to the surface
};

// A dense volume as signed numbers, negative inside.
class SignedSamples {
 public:
  explicit SignedSamples(const DenseSeeds& seeds);

  [[nodiscard]] const glm::ivec3& dims() const { return seeds_.dims; }
  [[nodiscard]] double unit() const { return unit_; }                   // smallest spacing, world
  [[nodiscard]] const glm::dvec3& spacing() const { return spacing_; }  // in units
  [[nodiscard]] std::size_t number(const glm::ivec3& at) const {
    return (static_cast<std::size_t>(at.x) * static_cast<std::size_t>(seeds_.dims.y) +
            static_cast<std::size_t>(at.y)) *
               static_cast<std::size_t>(seeds_.dims.z) +
           static_cast<std::size_t>(at.z);
  }
  // A mask is +-1/2; distances are in units.
  [[nodiscard]] float value(std::size_t number) const {
    if (!seeds_.mask.empty()) return seeds_.mask[number] != 0 ? -0.5F : 0.5F;
    const float v = seeds_.values[number];
    if (seeds_.kind == SeedKind::coverage) return v > 0.5F ? 0.5F - v : std::abs(0.5F - v);
    return v * scale_;
  }
  [[nodiscard]] bool inside(std::size_t number) const { return value(number) < 0; }
  // For the row of samples from number `first` on: 1 inside, 0 outside.
  void inside_row(std::size_t first, std::uint8_t* inside) const;
  [[nodiscard]] bool has(const glm::ivec3& at) const {
    return at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < seeds_.dims.x && at.y < seeds_.dims.y &&
           at.z < seeds_.dims.z;
  }

  // For a row of samples along z: not 0 where seed() may be true.
  void seed_row(int x, int y, std::uint8_t* may) const;
  // True for a sample with a neighbour on the other side, or whose distance is given and small.
  [[nodiscard]] bool seed(const glm::ivec3& at, SurfaceSeed& seed) const;

 private:
  [[nodiscard]] glm::dvec3 gradient(const glm::ivec3& at) const;

  DenseSeeds seeds_;
  double unit_;
  glm::dvec3 spacing_;
  float scale_ = 1;
};

// Writes the distance of one sample as the options want it: side, window, world units. Not a number
// stands for a sample that no distance reached.
[[nodiscard]] float finish_distance(float signed_units, bool inside, double unit,
                                    const TransformOptions& options);

}  // namespace sdfgrid
