// tests/trace/lattice_field.h: the field that an Atlas promises, copied sample by sample into a
// plain array, and its crossings along a ray found without any table: every cell on the way is
// looked at.
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "sdfgrid/grid/grid.h"
#include "sdfgrid/trace/camera.h"

namespace sdfgrid::test {

// Where the field may change its side for the first time: not before `early`, where it comes
// within kDoubt of zero, and at `late` at the latest, where it is as far beyond. Voxels.
struct Crossing {
  std::optional<double> early, late;
};

class LatticeField {
 public:
  static constexpr double kDoubt = 1e-9;  // voxels

  explicit LatticeField(const Grid& grid);

  // Indices of the first sample and the last; all beyond is the background.
  [[nodiscard]] const glm::ivec3& lo() const { return lo_; }
  [[nodiscard]] glm::ivec3 hi() const { return lo_ + size_ - 1; }
  [[nodiscard]] const Lattice& lattice() const { return lattice_; }

  // float(value / voxel), voxels.
  [[nodiscard]] float sample(const glm::ivec3& index) const;
  // The trilinear field, voxels, at an index point.
  [[nodiscard]] double at(const glm::dvec3& point) const;
  // Of the ray from `from` voxels on; t counts from its origin.
  [[nodiscard]] Crossing first_crossing(const Ray& world, double from) const;

 private:
  [[nodiscard]] std::size_t place(const glm::ivec3& index) const;
  [[nodiscard]] double in_cell(const glm::ivec3& cell, const glm::dvec3& point) const;
  [[nodiscard]] bool clip(const Ray& ray, double& from, double& to) const;
  void mark_cells();

  Lattice lattice_;
  glm::ivec3 lo_{0}, size_{0};
  float outside_ = 0;
  std::vector<float> samples_;
  std::vector<char> near_zero_;  // cells by their lowest sample
};

}  // namespace sdfgrid::test
