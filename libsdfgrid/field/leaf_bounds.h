// field/leaf_bounds.h: the box of a leaf, found from its formula by interval arithmetic over
// half-spaces (internal to field/).
#pragma once

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/field/interval.h"
#include "sdfgrid/field/ops.h"
#include "sdfgrid/field/parameters.h"

namespace sdfgrid::ops {

// The least c, as far as `excluded(c)` (true for all larger c) can tell; infinite if there is none
// within kAny.
template <class Excluded>
double first_excluded(const Excluded& excluded) {
  if (!excluded(kAny)) return kInfinity;
  if (excluded(-kAny)) return -kInfinity;
  double lo = -kAny;  // not excluded
  double hi = kAny;
  // The places are as dense around zero as floats are.
  while (hi - lo > 1e-6 * std::fmax(std::fabs(lo), std::fabs(hi)) && hi - lo > 1e-9) {
    double middle = 0;
    if (lo > 1e-9 && hi > 0) {
      middle = std::sqrt(lo * hi);
    } else if (hi < -1e-9) {
      middle = -std::sqrt(lo * hi);
    } else if (hi > 0 && lo < 0) {
      middle = 0;
    } else {
      middle = lo < 0 ? std::fmin(-1e-9, 1e-3 * lo) : std::fmax(1e-9, 1e-3 * hi);
    }
    if (!(middle > lo && middle < hi)) break;
    (excluded(middle) ? hi : lo) = middle;
  }
  return hi;
}

template <class Op>
Box leaf_bounds(const Op& op, Data data, double level) {
  Box box{glm::dvec3(-kInfinity), glm::dvec3(kInfinity)};
  const auto excluded = [&](int axis, const Interval& slab) {
    Interval c[3] = {everything(), everything(), everything()};
    c[axis] = slab;
    return leaf_value(op, Point<Interval>{c[0], c[1], c[2]}, data).lo > level;
  };
  for (int axis = 0; axis < 3; ++axis) {
    box.hi[axis] = first_excluded([&](double c) { return excluded(axis, Interval(c, kInfinity)); });
    box.lo[axis] =
        -first_excluded([&](double c) { return excluded(axis, Interval(-kInfinity, -c)); });
    if (box.lo[axis] > box.hi[axis]) return {};
  }
  return box;
}

}  // namespace sdfgrid::ops
