// field/local_bounds.h: how steep a field is, place by place: an octree over a region, built where
// it is asked, shared by all rays. Along a ray a tracer may step as far as the value lasts, through
// cell after cell, if it falls no faster than their slopes allow.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "sdfgrid/field/field.h"

namespace sdfgrid {

class LocalBounds {
 public:
  struct Cell {
    Box box;
    double slope;  // bound on |grad f| in the box, in (0, 1]
  };

  static constexpr int kLevels = 6;  // enough for a field alone
  // The region must be finite; `levels` (1 to 7) bounds the depth. A cell is split only where its
  // bound is more than a tenth above what a single point of it has.
  LocalBounds(Field field, const Box& region, int levels = kLevels);

  // The smallest cell around p, which must be in the region. May be called from many threads.
  [[nodiscard]] Cell at(const glm::dvec3& p) const;

  // How far is free, of a point p in the region where the field is `value` or minus that: along a
  // unit vector, against it, and to the surface as long as the slope of p's cell goes on.
  struct Free {
    double ahead, back, surface;
  };
  [[nodiscard]] Free free(const glm::dvec3& p, const glm::dvec3& along, double value) const;

  // Cells whose bounds have been computed so far.
  [[nodiscard]] std::size_t computed() const;

 private:
  // 0: not computed yet; > 0: a bound that is final; < 0: minus a bound, its cell is split.
  using Slope = std::atomic<float>;
  // A cell by its place in its level.
  struct Place {
    glm::ivec3 cell;
    int level;
    double slope;
  };

  [[nodiscard]] float slope(const glm::ivec3& cell, int level) const;
  [[nodiscard]] Place place(const glm::dvec3& p) const;
  [[nodiscard]] double way(Place at, const glm::dvec3& p, const glm::dvec3& along,
                           double value) const;
  [[nodiscard]] Box box(const glm::ivec3& cell, int level) const;

  Field field_;
  Box region_;
  int levels_;
  std::vector<glm::dvec3> edges_;  // of each level's cells
  glm::dvec3 per_edge_;            // cells of the last level in a unit of length
  double over_;                    // so far beyond a cell's wall one is surely in the next
  std::vector<std::unique_ptr<Slope[]>> slopes_;  // of each level, 8^level cells
  // Of each cell of the last level the smallest one around it that is known: its slope, rounded up,
  // the last three bits of which are its level; 0: none yet.
  std::unique_ptr<std::atomic<std::uint32_t>[]> smallest_;
};

}  // namespace sdfgrid
