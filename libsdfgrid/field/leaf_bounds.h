// field/leaf_bounds.h: the box of a leaf, found from its formula by interval arithmetic over
// half-spaces (internal to field/).
#pragma once

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/field/interval.h"
#include "sdfgrid/field/ops.h"
#include "sdfgrid/field/parameters.h"

namespace sdfgrid::ops {

template <class Lowest>
double halved_to(const Lowest& lowest, double level, double hi) {
  double lo = -kAny;  // not excluded
  if (lowest(lo) > level) return -kInfinity;
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
    (lowest(middle) > level ? hi : lo) = middle;
  }
  return hi;
}

// Beyond what plane across an axis a leaf is not: the least c for which lowest(c), the least value
// on the far side of the plane at c, is above `level`; infinite if there is none within kAny. Of a
// distance lowest(c) grows with c as fast as c: a few steps of that slope are enough. What grows
// more slowly is halved to.
template <class Lowest>
double first_excluded(const Lowest& lowest, double level) {
  constexpr int kSteps = 8;
  double hi = kAny;
  double above = lowest(hi) - level;
  if (!(above > 0)) return kInfinity;
  const auto tight = [&] { return 1e-6 * std::fabs(hi) + 1e-9; };
  for (int i = 0; i < kSteps && above > tight(); ++i) {
    const double next = hi - std::fmin(above * (1 - 1e-6), hi + kAny);
    const double value = lowest(next) - level;
    if (!(value > 0)) break;
    hi = next;
    above = value;
  }
  if (above <= tight() && !(lowest(hi - 4 * tight()) > level)) return hi;
  return halved_to(lowest, level, hi);
}

template <class Op>
Box leaf_bounds(const Op& op, Data data, double level) {
  Box box{glm::dvec3(-kInfinity), glm::dvec3(kInfinity)};
  const auto lowest = [&](int axis, const Interval& slab) {
    Interval c[3] = {everything(), everything(), everything()};
    c[axis] = slab;
    return leaf_value(op, Point<Interval>{c[0], c[1], c[2]}, data).lo;
  };
  for (int axis = 0; axis < 3; ++axis) {
    box.hi[axis] =
        first_excluded([&](double c) { return lowest(axis, Interval(c, kInfinity)); }, level);
    box.lo[axis] =
        -first_excluded([&](double c) { return lowest(axis, Interval(-kInfinity, -c)); }, level);
    if (box.lo[axis] > box.hi[axis]) return {};
  }
  return box;
}

}  // namespace sdfgrid::ops
