// field/smooth_interval.h: an interval that knows whether the function that it is a value of is
// smooth or at least continuous over the box: run over a formula it tells where derivatives may be
// trusted (internal to field/). Widened by what doubles round, not floats: a root of what is nearly
// 0 makes much of little.
#pragma once

#include <numbers>

#include "sdfgrid/field/interval.h"

namespace sdfgrid::ops {

// What is known of a function over a box.
struct Behaviour {
  bool smooth = true, continuous = true;
  friend Behaviour operator&(Behaviour a, Behaviour b) {
    return {a.smooth && b.smooth, a.continuous && b.continuous};
  }
};
inline Behaviour smooth_if(bool smooth) { return {smooth, true}; }
inline Behaviour no_jump_if(bool smooth) { return {smooth, smooth}; }

struct SmoothInterval {
  Interval v;
  Behaviour is;

  SmoothInterval() = default;
  SmoothInterval(double c) : v(c) {}
  SmoothInterval(const Interval& i, Behaviour b = {}) : v(i), is(b) {}
};

inline Interval tight(double lo, double hi) {
  const Interval r = widened(lo, hi, 0x1p-50);
  return {lo >= 0 ? greater(r.lo, 0) : r.lo, hi <= 0 ? lesser(r.hi, 0) : r.hi};
}
inline bool apart(const Interval& a, const Interval& b) { return a.hi <= b.lo || b.hi <= a.lo; }

inline SmoothInterval operator+(const SmoothInterval& a, const SmoothInterval& b) {
  return {tight(a.v.lo + b.v.lo, a.v.hi + b.v.hi), a.is & b.is};
}
inline SmoothInterval operator-(const SmoothInterval& a) { return {-a.v, a.is}; }
inline SmoothInterval operator-(const SmoothInterval& a, const SmoothInterval& b) { return a + -b; }
inline SmoothInterval operator*(const SmoothInterval& a, const SmoothInterval& b) {
  const double p = product(a.v.lo, b.v.lo);
  const double q = product(a.v.lo, b.v.hi);
  const double r = product(a.v.hi, b.v.lo);
  const double s = product(a.v.hi, b.v.hi);
  return {tight(lesser(lesser(p, q), lesser(r, s)), greater(greater(p, q), greater(r, s))),
          a.is & b.is};
}
inline SmoothInterval operator/(const SmoothInterval& a, const SmoothInterval& b) {
  if (b.v.contains(0)) return {a.v / b.v, {false, false}};
  return a * SmoothInterval(tight(1 / b.v.hi, 1 / b.v.lo), b.is);
}
inline SmoothInterval square(const SmoothInterval& a) {
  const Interval m = abs(a.v);
  return {tight(m.lo * m.lo, m.hi * m.hi), a.is};
}
inline SmoothInterval sqrt(const SmoothInterval& a) {
  return {tight(std::sqrt(greater(a.v.lo, 0)), std::sqrt(greater(a.v.hi, 0))),
          a.is & smooth_if(a.v.lo > 0)};
}
inline SmoothInterval exp(const SmoothInterval& a) {
  return {tight(std::exp(a.v.lo), std::exp(a.v.hi)), a.is};
}
inline SmoothInterval log(const SmoothInterval& a) {
  return {tight(std::log(greater(a.v.lo, 0)), std::log(greater(a.v.hi, 0))),
          a.is & no_jump_if(a.v.lo > 0)};
}
// To a number above 0; 0 where a is below 0.
inline SmoothInterval pow(const SmoothInterval& a, const Interval& b) {
  return {tight(std::pow(greater(a.v.lo, 0), b.lo), std::pow(greater(a.v.hi, 0), b.lo)),
          a.is & smooth_if(a.v.lo > 0)};
}
inline SmoothInterval cos(const SmoothInterval& a) {
  return {cos(a.v, (1 + magnitude(a.v)) * 0x1p-50), a.is};
}
inline SmoothInterval sin(const SmoothInterval& a) {
  return cos(a - SmoothInterval(std::numbers::pi / 2));
}
inline SmoothInterval acos(const SmoothInterval& a) {
  return {acos(a.v, 0x1p-49), a.is & smooth_if(a.v.lo > -1 && a.v.hi < 1)};
}
inline SmoothInterval atan2(const SmoothInterval& y, const SmoothInterval& x) {
  const bool cut = x.v.lo <= 0 && y.v.lo <= 0 && y.v.hi >= 0;
  return {atan2(y.v, x.v, 0x1p-49), x.is & y.is & no_jump_if(!cut)};
}
inline SmoothInterval abs(const SmoothInterval& a) {
  return {abs(a.v), a.is & smooth_if(a.v.lo >= 0 || a.v.hi <= 0)};
}
inline SmoothInterval sign(const SmoothInterval& a) {
  return {sign(a.v), a.is & no_jump_if(a.v.lo >= 0 || a.v.hi < 0)};
}
inline SmoothInterval floor(const SmoothInterval& a) {
  const Interval r = floor(a.v);
  return {r, a.is & no_jump_if(r.lo == r.hi)};
}
inline SmoothInterval min(const SmoothInterval& a, const SmoothInterval& b) {
  return {min(a.v, b.v), a.is & b.is & smooth_if(apart(a.v, b.v))};
}
inline SmoothInterval max(const SmoothInterval& a, const SmoothInterval& b) {
  return {max(a.v, b.v), a.is & b.is & smooth_if(apart(a.v, b.v))};
}

}  // namespace sdfgrid::ops
