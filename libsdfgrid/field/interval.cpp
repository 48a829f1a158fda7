#include "sdfgrid/field/interval.h"

#include <initializer_list>
#include <numbers>

namespace sdfgrid::ops {
namespace {

constexpr double kPi = std::numbers::pi;

}  // namespace

Interval cos(const Interval& a, double slack) {
  const Interval all(-1 - kFunctionSlack, 1 + kFunctionSlack);
  if (!(a.hi - a.lo < 2 * kPi) || magnitude(a) > 1e6) return all;
  // Multiples of pi within [lo, hi]: even ones are maxima, odd ones minima.
  const double first = std::ceil(a.lo / kPi);
  const double last = std::floor(a.hi / kPi);
  double lo = std::fmin(std::cos(a.lo), std::cos(a.hi));
  double hi = std::fmax(std::cos(a.lo), std::cos(a.hi));
  for (double k = first; k <= last; ++k) {
    const bool even = std::fmod(k, 2.0) == 0;
    lo = even ? lo : -1;
    hi = even ? 1 : hi;
  }
  return {std::fmax(lo - slack, all.lo), std::fmin(hi + slack, all.hi)};
}

Interval cos(const Interval& a) {
  // The kernels' argument reduction loses absolute precision in proportion to the argument.
  return cos(a, kFunctionSlack + magnitude(a) * kFloatSlack);
}

Interval sin(const Interval& a) { return cos(Interval(a.lo - kPi / 2, a.hi - kPi / 2)); }

Interval atan2(const Interval& y, const Interval& x, double slack) {
  const Interval all(-kPi - kFunctionSlack, kPi + kFunctionSlack);
  if (x.lo <= 0 && y.lo <= 0 && y.hi >= 0) return all;  // touches the cut
  double lo = kInfinity;
  double hi = -kInfinity;
  for (const double v : {y.lo, y.hi}) {
    for (const double u : {x.lo, x.hi}) {
      const double angle = std::atan2(v, u);
      lo = std::fmin(lo, angle);
      hi = std::fmax(hi, angle);
    }
  }
  const Interval r(lo - slack, hi + slack);
  return std::isnan(lo + hi) ? all : r;
}

Interval atan2(const Interval& y, const Interval& x) { return atan2(y, x, kFunctionSlack * 4); }

Interval acos(const Interval& a, double slack) {
  return {ops::acos(a.hi) - slack, ops::acos(a.lo) + slack};
}

Interval acos(const Interval& a) { return acos(a, kFunctionSlack * 4); }

}  // namespace sdfgrid::ops
