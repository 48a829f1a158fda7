// field/interval.h: the number type of all values over a box (internal to field/). Every result is
// widened by more than what a float rounds, so that an interval holds not only the true values but
// those that the batch kernels compute: pruning relies on it.
#pragma once

#include <cmath>
#include <limits>

#include "sdfgrid/field/number.h"

namespace sdfgrid::ops {

struct Interval {
  double lo = 0, hi = 0;

  Interval() = default;
  Interval(double v) : lo(v), hi(v) {}
  Interval(double l, double h) : lo(l), hi(h) {}
  [[nodiscard]] bool contains(double v) const { return lo <= v && v <= hi; }
};

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kFloatSlack = 0x1p-22;     // four times what a float rounds
inline constexpr double kFunctionSlack = 0x1p-20;  // what the kernels' exp, sin, ... may be off

// Of numbers that are not NaN, as every bound is: without a call.
inline double lesser(double a, double b) { return b < a ? b : a; }
inline double greater(double a, double b) { return b > a ? b : a; }

inline Interval everything() { return {-kInfinity, kInfinity}; }

inline Interval widened(double lo, double hi, double slack = kFloatSlack) {
  if (!(lo <= hi)) return everything();  // NaN, of infinities
  return {lo * (1 - std::copysign(slack, lo)) - 1e-37, hi * (1 + std::copysign(slack, hi)) + 1e-37};
}
inline Interval hull(const Interval& a, const Interval& b) {
  return {lesser(a.lo, b.lo), greater(a.hi, b.hi)};
}
// The values that are in both; `a` where rounding let them miss each other.
inline Interval meet(const Interval& a, const Interval& b) {
  const double lo = greater(a.lo, b.lo);
  const double hi = lesser(a.hi, b.hi);
  return lo <= hi ? Interval(lo, hi) : a;
}
// The largest absolute value.
inline double magnitude(const Interval& a) { return greater(std::fabs(a.lo), std::fabs(a.hi)); }

inline Interval operator-(const Interval& a) { return {-a.hi, -a.lo}; }
inline Interval operator+(const Interval& a, const Interval& b) {
  return widened(a.lo + b.lo, a.hi + b.hi);
}
inline Interval operator-(const Interval& a, const Interval& b) {
  return widened(a.lo - b.hi, a.hi - b.lo);
}
inline double product(double a, double b) { return a == 0 || b == 0 ? 0.0 : a * b; }
inline Interval operator*(const Interval& a, const Interval& b) {
  const double p = product(a.lo, b.lo);
  const double q = product(a.lo, b.hi);
  const double r = product(a.hi, b.lo);
  const double s = product(a.hi, b.hi);
  return widened(lesser(lesser(p, q), lesser(r, s)), greater(greater(p, q), greater(r, s)));
}
// With a constant of the op.
inline Interval operator*(const Interval& a, float b) {
  const double p = product(a.lo, b);
  const double q = product(a.hi, b);
  return b < 0 ? widened(q, p) : widened(p, q);
}
inline Interval operator/(const Interval& a, const Interval& b) {
  if (b.lo <= 0 && b.hi >= 0) {
    if (b.lo == 0 && b.hi > 0 && a.lo >= 0) return widened(product(a.lo, 1 / b.hi), kInfinity);
    if (b.lo == 0 && b.hi > 0 && a.hi <= 0) return widened(-kInfinity, product(a.hi, 1 / b.hi));
    return everything();
  }
  return a * Interval(1 / b.hi, 1 / b.lo);
}
inline Interval& operator+=(Interval& a, const Interval& b) { return a = a + b; }
inline Interval& operator-=(Interval& a, const Interval& b) { return a = a - b; }
inline Interval& operator*=(Interval& a, const Interval& b) { return a = a * b; }

// A mask over a box: true everywhere, nowhere, or not known.
struct Maybe {
  bool possibly, certainly;
};
inline Maybe operator<(const Interval& a, const Interval& b) { return {a.lo < b.hi, a.hi < b.lo}; }
inline Maybe operator>(const Interval& a, const Interval& b) { return b < a; }
inline Maybe operator<=(const Interval& a, const Interval& b) {
  return {a.lo <= b.hi, a.hi <= b.lo};
}
inline Maybe operator>=(const Interval& a, const Interval& b) { return b <= a; }
inline Maybe operator&(Maybe a, Maybe b) {
  return {a.possibly && b.possibly, a.certainly && b.certainly};
}
inline Maybe operator|(Maybe a, Maybe b) {
  return {a.possibly || b.possibly, a.certainly || b.certainly};
}
inline Maybe operator!(Maybe a) { return {!a.certainly, !a.possibly}; }
inline Interval select(Maybe m, const Interval& yes, const Interval& no) {
  if (m.certainly) return yes;
  return m.possibly ? hull(yes, no) : no;
}

inline Interval min(const Interval& a, const Interval& b) {
  return {lesser(a.lo, b.lo), lesser(a.hi, b.hi)};
}
inline Interval max(const Interval& a, const Interval& b) {
  return {greater(a.lo, b.lo), greater(a.hi, b.hi)};
}
inline Interval abs(const Interval& a) {
  return {greater(greater(a.lo, -a.hi), 0), greater(-a.lo, a.hi)};
}
inline Interval sign(const Interval& a) { return {a.lo < 0 ? -1.0 : 1.0, a.hi < 0 ? -1.0 : 1.0}; }
// What rounding never makes negative.
inline Interval not_negative(const Interval& a) { return {greater(a.lo, 0), a.hi}; }
inline Interval square(const Interval& a) {
  const Interval m = abs(a);
  return not_negative(widened(m.lo * m.lo, m.hi * m.hi));
}
inline Interval sqrt(const Interval& a) {
  return not_negative(widened(std::sqrt(greater(a.lo, 0)), std::sqrt(greater(a.hi, 0))));
}
// As sqrt(square(x) + ...), widened once, not at each step: floats round such a sum three times, of
// which the root keeps half, and the root once more.
inline Interval root_of_squares(double lo, double hi) {
  return widened(std::sqrt(greater(lo - 1e-36, 0)), std::sqrt(hi + 1e-36));
}
inline Interval length(const Interval& x, const Interval& y) {
  const Interval u = abs(x);
  const Interval v = abs(y);
  return root_of_squares(u.lo * u.lo + v.lo * v.lo, u.hi * u.hi + v.hi * v.hi);
}
inline Interval length(const Interval& x, const Interval& y, const Interval& z) {
  const Interval u = abs(x);
  const Interval v = abs(y);
  const Interval w = abs(z);
  return root_of_squares(u.lo * u.lo + v.lo * v.lo + w.lo * w.lo,
                         u.hi * u.hi + v.hi * v.hi + w.hi * w.hi);
}
inline Interval floor(const Interval& a) { return {std::floor(a.lo), std::floor(a.hi)}; }
inline Interval exp(const Interval& a) {
  return not_negative(widened(std::exp(a.lo), std::exp(a.hi), kFunctionSlack));
}
inline Interval log(const Interval& a) {
  // Single precision ends at about e^-87.
  const Interval r = widened(std::log(std::fmax(a.lo, 0)), std::log(std::fmax(a.hi, 1.2e-38)));
  return {r.lo - kFunctionSlack, r.hi + kFunctionSlack};
}
// Of a >= 0.
inline Interval pow(const Interval& a, const Interval& b) { return exp(log(a) * b); }
Interval cos(const Interval& a);
Interval sin(const Interval& a);
Interval atan2(const Interval& y, const Interval& x);
Interval acos(const Interval& a);
// Widened by so much instead.
Interval cos(const Interval& a, double slack);
Interval atan2(const Interval& y, const Interval& x, double slack);
Interval acos(const Interval& a, double slack);

}  // namespace sdfgrid::ops
