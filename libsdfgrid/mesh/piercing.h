// mesh/piercing.h: which triangles a line pierces, decided so that a closed surface is always
// pierced an even number of times (not installed).
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "sdfgrid/mesh/soup.h"

namespace sdfgrid {

// The triangles of a soup in bins over the (y, z) plane, for lines along x.
class Piercing {
 public:
  explicit Piercing(const TriangleSoup& soup);

  // Calls visit(triangle, x, direction) for every triangle that the line through (y, z) along x
  // pierces: x is where, relative to soup.origin; direction is +1 or -1, opposite for triangles
  // that face opposite ways. A line through an edge or a corner counts as beside it, on the same
  // side for all triangles there.
  template <class Visit>
  void along_x(double y, double z, Visit visit) const {
    const std::size_t bin = bin_of(y, z);
    if (bin == kNowhere) return;
    for (std::size_t i = first_[bin]; i < first_[bin + 1]; ++i) {
      double x = 0.0;
      const int direction = pierce(triangles_[i], y, z, x);
      if (direction != 0) visit(triangles_[i], x, direction);
    }
  }

 private:
  static constexpr std::size_t kNowhere = ~std::size_t{0};
  struct Span {
    glm::ivec2 lo, hi;
  };

  [[nodiscard]] Span span(const glm::uvec3& t) const;
  [[nodiscard]] std::size_t count_entries() const;
  void set_resolution(int cells);
  [[nodiscard]] std::size_t bin_of(double y, double z) const;
  [[nodiscard]] int pierce(std::uint32_t t, double y, double z, double& x) const;

  const TriangleSoup& soup_;
  glm::dvec2 lo_{0.0}, size_{0.0}, scale_{0.0};
  int cells_ = 1;  // bins a side
  std::vector<std::size_t> first_;
  std::vector<std::uint32_t> triangles_;
};

}  // namespace sdfgrid
