// field/local_bounds.h: how steep a field is, place by place: an octree over a region, built where
// it is asked, shared by all rays. Within a cell a tracer may step by value / slope, as far as the
// cell goes.
#pragma once

#include <atomic>
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

  // The region must be finite; `levels` (1 to 7) bounds the depth. A cell is split only where its
  // bound is more than a tenth above what a single point of it has.
  LocalBounds(Field field, const Box& region, int levels = 5);

  // The smallest cell around p, which must be in the region. May be called from many threads.
  [[nodiscard]] Cell at(const glm::dvec3& p) const;

  // Cells whose bounds have been computed so far.
  [[nodiscard]] std::size_t computed() const;

 private:
  // 0: not computed yet; > 0: a bound that is final; < 0: minus a bound, its cell is split.
  using Slope = std::atomic<float>;

  [[nodiscard]] float slope(const glm::ivec3& cell, int level) const;
  [[nodiscard]] Box box(const glm::ivec3& cell, int level) const;

  Field field_;
  Box region_;
  int levels_;
  std::vector<std::unique_ptr<Slope[]>> slopes_;  // of each level, 8^level cells
};

}  // namespace sdfgrid
