// tests/trace/bisection.h: where a function that is a cubic on a segment first falls to a level,
// found the slow way: it is only ever evaluated, split where its derivative is zero, and bisected.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

namespace sdfgrid::test {

// The zeros in (0, 1) of the derivative of the cubic through g[i] at i / 3, ascending; at most two.
template <class Real>
int turning_points(const Real (&g)[4], Real (&at)[2]) {
  const Real a = Real(13.5) * (g[3] - 3 * g[2] + 3 * g[1] - g[0]);
  const Real b = Real(4.5) * (2 * g[0] - 5 * g[1] + 4 * g[2] - g[3]);  // half of the middle one
  const Real c = Real(0.5) * (-11 * g[0] + 18 * g[1] - 9 * g[2] + 2 * g[3]);
  const Real discriminant = b * b - a * c;
  if (!(discriminant > 0)) return 0;
  const Real q = -(b + std::copysign(std::sqrt(discriminant), b));
  int count = 0;
  for (const Real u : {q / a, c / q}) {
    if (u > 0 && u < 1) at[count++] = u;
  }
  if (count == 2 && at[0] > at[1]) std::swap(at[0], at[1]);
  return count;
}

// The first t in [lo, hi] where f(t) <= level.
template <class Real, class F>
std::optional<Real> first_at_most(const F& f, Real lo, Real hi, Real level) {
  if (f(lo) <= level) return lo;
  const Real length = hi - lo;
  const Real g[4] = {f(lo), f(lo + length / 3), f(lo + 2 * length / 3), f(hi)};
  Real turns[2];
  const int count = turning_points(g, turns);
  Real from = lo;
  for (int i = 0; i <= count; ++i) {
    Real to = i < count ? lo + turns[i] * length : hi;
    if (f(to) <= level) {
      for (Real middle = (from + to) / 2; middle > from && middle < to; middle = (from + to) / 2) {
        (f(middle) <= level ? to : from) = middle;
      }
      return to;
    }
    from = to;
  }
  return std::nullopt;
}

}  // namespace sdfgrid::test
