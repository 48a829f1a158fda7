// volume/volume.h: a dense block of samples, as scanners and simulations write them: CT, MRI,
// labels, masks, densities. Samples keep the type that they have in the file: labels are not
// numbers to calculate with.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <variant>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/core/lattice.h"

namespace sdfgrid {

// One vector of the samples' own type; x runs fastest: sample (i, j, k) is number
// i + dims.x * (j + dims.y * k). numpy sees the same block as array[i, j, k] in Fortran order.
using Samples =
    std::variant<std::vector<std::uint8_t>, std::vector<std::int8_t>, std::vector<std::uint16_t>,
                 std::vector<std::int16_t>, std::vector<std::uint32_t>, std::vector<std::int32_t>,
                 std::vector<std::uint64_t>, std::vector<std::int64_t>, std::vector<float>,
                 std::vector<double>>;

struct Volume {
  glm::ivec3 dims{0};
  glm::dvec3 spacing{1.0};  // world length between neighbouring samples, > 0
  glm::dvec3 origin{0.0};   // world position of sample (0, 0, 0)
  // Columns are the world directions, of length one, in which the index axes run. Scanners turn and
  // mirror them; formats that cannot hold them take the identity only.
  glm::dmat3 axes{1.0};
  Samples samples = std::vector<float>();

  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(dims.x) * dims.y * dims.z;
  }
  [[nodiscard]] std::size_t place(const glm::ivec3& index) const {
    return index.x + static_cast<std::size_t>(dims.x) *
                         (index.y + static_cast<std::size_t>(dims.y) * index.z);
  }
  [[nodiscard]] glm::dvec3 to_world(const glm::dvec3& index) const {
    return origin + axes * (spacing * index);
  }
  // The index axes run along the world's, none mirrored.
  [[nodiscard]] bool axis_aligned() const;
  // The index axes are at right angles, within a thousandth: what a distance transform needs.
  [[nodiscard]] bool orthogonal() const;
};

// "uint8", "int16", "float32", ... as numpy calls them.
[[nodiscard]] std::string type_name(const Samples& samples);

// Empty samples of the type that numpy calls `name`. Throws Error{usage} for an unknown name.
[[nodiscard]] Samples samples_of_type(const std::string& name);
// The names that samples_of_type knows.
[[nodiscard]] const std::vector<std::string>& type_names();

[[nodiscard]] std::size_t bytes_per_sample(const Samples& samples);

// The samples as float, rounded to nearest where float has fewer digits.
[[nodiscard]] std::vector<float> as_floats(const Samples& samples, const Job& job);

struct SampleRange {
  double lo = 0;
  double hi = 0;
};

// The least and greatest sample. `volume` must not be empty.
[[nodiscard]] SampleRange sample_range(const Volume& volume, const Job& job);

// One byte a sample, x fastest: 1 where the sample equals `label`, else 0.
[[nodiscard]] std::vector<std::uint8_t> mask_of_label(const Volume& volume, double label,
                                                      const Job& job);
// The same, 1 where the sample is not zero.
[[nodiscard]] std::vector<std::uint8_t> mask_of_nonzero(const Volume& volume, const Job& job);
// The same, 1 where the sample is `iso` or more.
[[nodiscard]] std::vector<std::uint8_t> mask_above(const Volume& volume, double iso,
                                                   const Job& job);

}  // namespace sdfgrid
