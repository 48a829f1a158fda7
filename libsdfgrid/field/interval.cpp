#include "sdfgrid/field/interval.h"

#include <initializer_list>
#include <numbers>

namespace sdfgrid::ops {
namespace {

constexpr double kPi = std::numbers::pi;

// The kernels' argument reduction loses absolute precision in proportion to the argument.
Interval trigonometric_slack(double lo, double hi, const Interval& argument) {
  const double slack = kFunctionSlack + magnitude(argument) * kFloatSlack;
  return {std::fmax(lo - slack, -1 - kFunctionSlack), std::fmin(hi + slack, 1 + kFunctionSlack)};
}

}  // namespace

Interval cos(const Interval& a) {
  if (!(a.hi - a.lo < 2 * kPi) || magnitude(a) > 1e6)
    return {-1 - kFunctionSlack, 1 + kFunctionSlack};
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
  return trigonometric_slack(lo, hi, a);
}

Interval sin(const Interval& a) { return cos(Interval(a.lo - kPi / 2, a.hi - kPi / 2)); }

Interval atan2(const Interval& y, const Interval& x) {
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
  const Interval r(lo - kFunctionSlack * 4, hi + kFunctionSlack * 4);
  return std::isnan(lo + hi) ? all : r;
}

Interval acos(const Interval& a) {
  const Interval r(ops::acos(a.hi), ops::acos(a.lo));
  return {r.lo - kFunctionSlack * 4, r.hi + kFunctionSlack * 4};
}

}  // namespace sdfgrid::ops
