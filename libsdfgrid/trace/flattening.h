// trace/flattening.h: how the trilinear field of a grid becomes 1-Lipschitz (internal to trace/).
#pragma once

#include <array>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/core/lattice.h"
#include "sdfgrid/grid/atlas.h"

namespace sdfgrid {

// The field's values v, voxels, go to phi(v), where phi(0) = 0 and phi' is one over the steepest
// gradient that the field has anywhere at that value. Between samples distances are steeper than 1
// where two sides are equally near, which a cube has at every depth inside, and outside beside its
// edges only.
class Flattening {
 public:
  Flattening(const Atlas& atlas, const Job& job);

  // phi. Beyond all values of slope 1.
  [[nodiscard]] double operator()(double v) const;
  // The values that are known inside, voxels: all, where no slot is without samples.
  [[nodiscard]] double reach_inside() const;
  // In cells of the atlas a box of all where phi is below a level, if that is within the band.
  [[nodiscard]] Box cells_below(double level) const;

 private:
  bool cut_off_ = false;                     // there are slots without samples inside
  double least_ = 0;                         // of all samples, voxels
  double outside_ = 0;                       // phi where there are none
  double bins_per_voxel_ = 1;                // of the values
  std::array<std::vector<double>, 2> sums_;  // of phi at the ends of the bins, inside and outside
  // Of the cells with negative samples, then with such below the start of bin 0, 1, ... too.
  std::vector<Box> boxes_;
};

}  // namespace sdfgrid
