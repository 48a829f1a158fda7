// transform/dense_field.h: the samples of a whole volume, in rows, with two more around it, so that
// no stencil asks where the volume ends (not installed). In place of BrickField (brick_field.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>

namespace sdfgrid {

class DenseField {
 public:
  static constexpr int kBorder = 2;                        // samples
  static constexpr std::size_t kMostSamples = 1ULL << 31;  // border included

  DenseField() = default;
  explicit DenseField(const glm::ivec3& dims)
      : size_(dims + 2 * kBorder), stride_{size_.y * size_.z, size_.z, 1} {}

  // Samples, border included, of a volume of `dims`.
  [[nodiscard]] static std::size_t samples(const glm::ivec3& dims) {
    const glm::ivec3 size = dims + 2 * kBorder;
    return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
           static_cast<std::size_t>(size.z);
  }
  [[nodiscard]] std::size_t samples() const { return samples(size_ - 2 * kBorder); }
  [[nodiscard]] const int* stride() const { return stride_; }

  // The sample at an index of the volume, or at one of the border.
  [[nodiscard]] std::uint32_t sample(const glm::ivec3& index) const {
    const glm::ivec3 at = index + kBorder;
    return static_cast<std::uint32_t>(at.x * stride_[0] + at.y * stride_[1] + at.z);
  }
  [[nodiscard]] glm::ivec3 index(std::uint32_t sample) const {
    const int s = static_cast<int>(sample);
    return glm::ivec3(s / stride_[0], s / stride_[1] % size_.y, s % size_.z) - kBorder;
  }
  [[nodiscard]] std::uint32_t step(std::uint32_t sample, int axis, int by) const {
    return sample + static_cast<std::uint32_t>(by * stride_[axis]);
  }
  [[nodiscard]] static bool nowhere(std::uint32_t) { return false; }
  [[nodiscard]] std::uint32_t step_making(std::uint32_t sample, int axis, int by) const {
    return step(sample, axis, by);
  }

 private:
  glm::ivec3 size_{0};
  int stride_[3] = {0, 0, 1};
};

}  // namespace sdfgrid
