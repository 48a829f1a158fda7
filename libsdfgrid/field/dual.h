// field/dual.h: a value with its N partial derivatives, over any number type: derivatives of an
// op's formula without a second formula (internal to field/). Dual<Dual<T, 3>, 3> has second
// derivatives; Dual<Interval, N> bounds the derivatives over a box. Where a function has a kink, T
// = Interval gives the hull of the slopes on both sides, other types the slope on one side. Where
// it jumps within an interval its slope has no bound.
#pragma once

#include <array>
#include <type_traits>

#include "sdfgrid/field/interval.h"
#include "sdfgrid/field/number.h"
#include "sdfgrid/field/steepness.h"

namespace sdfgrid::ops {

// What is left of a ratio part / whole of which |part| <= whole is known, where whole may be 0.
template <class T>
T unit_ratio(const T& part, const T& whole) {
  return select(whole > T(0.0F), part / whole, T(0.0F));
}
inline Interval unit_ratio(const Interval& part, const Interval& whole) {
  if (magnitude(whole) == 0) return {-1, 1};
  return meet(Interval(-1, 1), part / whole);
}

// Whether a function jumps between the values of an argument: other numbers than intervals are
// points, at which they have the slope on one side.
template <class T>
constexpr bool floor_jumps(const T&) {
  return false;
}
template <class T>
constexpr bool sign_jumps(const T&) {
  return false;
}
template <class T>
constexpr bool atan2_jumps(const T&, const T&) {
  return false;
}
template <class T>
constexpr bool log_ends(const T&) {
  return false;
}
inline bool floor_jumps(const Interval& a) { return std::floor(a.lo) != std::floor(a.hi); }
inline bool sign_jumps(const Interval& a) { return a.lo < 0 && a.hi >= 0; }
inline bool atan2_jumps(const Interval& y, const Interval& x) {
  return x.lo <= 0 && y.lo < 0 && y.hi >= 0;
}
// Below 0 a logarithm is whatever a reading makes of it.
inline bool log_ends(const Interval& a) { return a.lo <= 0; }

template <class T>
T side(const T& a) {
  return sign(a);
}
template <class T>
T slope_or_jump(const T& slope, bool) {
  return slope;
}
inline Interval slope_or_jump(const Interval& slope, bool jumps) {
  return jumps ? everything() : slope;
}

template <class T, int N>
struct Dual {
  T v;
  std::array<T, N> d;
  [[no_unique_address]] Steepness<T> steepness;

  Dual() = default;
  template <class C>
  requires std::is_arithmetic_v<C> Dual(C constant)
      : v(constant), steepness(Steepness<T>::at_most(0)) {
    d.fill(T(0.0F));
  }
  explicit Dual(const T& value) requires(!std::is_arithmetic_v<T>)
      : v(value), steepness(Steepness<T>::at_most(0)) {
    d.fill(T(0.0F));
  }
  // The i-th of the N variables.
  static Dual variable(const T& value, int i) {
    Dual r;
    r.v = value;
    r.d.fill(T(0.0F));
    r.d[i] = T(1.0F);
    r.steepness = Steepness<T>::at_most(1);
    return r;
  }
  // A value, each derivative of which is f(i), and what is known of all together.
  template <class F>
  static Dual make(const T& value, const F& f, Steepness<T> steepness = {}) {
    Dual r;
    r.v = value;
    for (int i = 0; i < N; ++i) r.d[i] = f(i);
    r.steepness = steepness.and_of(r.d);
    return r;
  }
  // A value that changes only where it jumps.
  static Dual steps(const T& value, bool jumps) {
    return make(value, [&](int) { return slope_or_jump(T(0.0F), jumps); });
  }

  friend Dual operator+(const Dual& a, const Dual& b) {
    return make(
        a.v + b.v, [&](int i) { return a.d[i] + b.d[i]; }, a.steepness + b.steepness);
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    return make(
        a.v - b.v, [&](int i) { return a.d[i] - b.d[i]; }, a.steepness + b.steepness);
  }
  friend Dual operator-(const Dual& a) {
    return make(
        -a.v, [&](int i) { return -a.d[i]; }, a.steepness);
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return make(
        a.v * b.v, [&](int i) { return a.d[i] * b.v + a.v * b.d[i]; },
        b.v * a.steepness + a.v * b.steepness);
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const T q = a.v / b.v;
    return make(
        q, [&](int i) { return (a.d[i] - q * b.d[i]) / b.v; },
        (a.steepness + q * b.steepness) / b.v);
  }
  friend Dual& operator+=(Dual& a, const Dual& b) { return a = a + b; }
  friend Dual& operator-=(Dual& a, const Dual& b) { return a = a - b; }
  friend Dual& operator*=(Dual& a, const Dual& b) { return a = a * b; }
  friend auto operator<(const Dual& a, const Dual& b) { return a.v < b.v; }
  friend auto operator>(const Dual& a, const Dual& b) { return a.v > b.v; }
  friend auto operator<=(const Dual& a, const Dual& b) { return a.v <= b.v; }
  friend auto operator>=(const Dual& a, const Dual& b) { return a.v >= b.v; }
  friend Dual min(const Dual& a, const Dual& b) { return select(a.v < b.v, a, b); }
  friend Dual max(const Dual& a, const Dual& b) { return select(a.v > b.v, a, b); }

  // f(a) whose derivative at a is `slope`.
  friend Dual chain(const Dual& a, const T& value, const T& slope) {
    return make(
        value, [&](int i) { return slope * a.d[i]; }, slope * a.steepness);
  }
  friend Dual sqrt(const Dual& a) {
    const T r = sqrt(a.v);
    return chain(a, r, T(0.5F) / r);
  }
  friend Dual square(const Dual& a) { return chain(a, square(a.v), a.v * T(2.0F)); }
  friend Dual abs(const Dual& a) { return chain(a, abs(a.v), side(a.v)); }
  friend Dual exp(const Dual& a) {
    const T r = exp(a.v);
    return chain(a, r, r);
  }
  friend Dual log(const Dual& a) {
    return chain(a, log(a.v), slope_or_jump(T(1.0F) / a.v, log_ends(a.v)));
  }
  friend Dual sin(const Dual& a) { return chain(a, sin(a.v), cos(a.v)); }
  friend Dual cos(const Dual& a) { return chain(a, cos(a.v), -sin(a.v)); }
  friend Dual acos(const Dual& a) {
    return chain(a, acos(a.v), T(-1.0F) / sqrt(T(1.0F) - square(a.v)));
  }
  friend Dual atan2(const Dual& y, const Dual& x) {
    const T r = square(x.v) + square(y.v);
    const bool jumps = atan2_jumps(y.v, x.v);
    return make(atan2(y.v, x.v),
                [&](int i) { return slope_or_jump((x.v * y.d[i] - y.v * x.d[i]) / r, jumps); });
  }
  friend Dual floor(const Dual& a) { return steps(floor(a.v), floor_jumps(a.v)); }
  friend Dual sign(const Dual& a) { return steps(sign(a.v), sign_jumps(a.v)); }
  // The slope of abs: of its kink nothing is said but what is on both sides.
  friend Dual side(const Dual& a) { return Dual(side(a.v)); }
  friend bool log_ends(const Dual& a) { return log_ends(a.v); }
  friend bool floor_jumps(const Dual& a) { return floor_jumps(a.v); }
  friend bool sign_jumps(const Dual& a) { return sign_jumps(a.v); }
  friend bool atan2_jumps(const Dual& y, const Dual& x) { return atan2_jumps(y.v, x.v); }
  friend Dual slope_or_jump(const Dual& slope, bool jumps) {
    return make(slope_or_jump(slope.v, jumps),
                [&](int i) { return slope_or_jump(slope.d[i], jumps); });
  }
  // The exponent is a constant.
  template <class C>
  requires std::is_arithmetic_v<C>
  friend Dual pow(const Dual& a, C b) { return chain(a, pow(a.v, b), pow(a.v, b - 1) * T(b)); }
  // Of a length, whose gradient is a unit vector times the matrix of all derivatives, and of any
  // map with these values.
  template <class... D>
  static Steepness<T> joint(const D&... of) {
    if constexpr (Steepness<T>::kKnown) {
      return ops::joint(std::array{&of.d...}, std::array{of.steepness.most...});
    } else {
      return {};
    }
  }
  friend Dual length(const Dual& x, const Dual& y) {
    const T r = length(x.v, y.v);
    const T u = unit_ratio(x.v, r);
    const T v = unit_ratio(y.v, r);
    return make(
        r, [&](int i) { return u * x.d[i] + v * y.d[i]; }, joint(x, y));
  }
  friend Dual length(const Dual& x, const Dual& y, const Dual& z) {
    const T r = length(x.v, y.v, z.v);
    const T u = unit_ratio(x.v, r);
    const T v = unit_ratio(y.v, r);
    const T w = unit_ratio(z.v, r);
    return make(
        r, [&](int i) { return u * x.d[i] + v * y.d[i] + w * z.d[i]; }, joint(x, y, z));
  }
  // Of a dual of duals: the same ratio with its derivatives.
  friend Dual unit_ratio(const Dual& part, const Dual& whole) {
    const T q = unit_ratio(part.v, whole.v);
    return make(q, [&](int i) { return (part.d[i] - q * whole.d[i]) / whole.v; });
  }
};

template <class M, class T, int N>
inline Dual<T, N> select(M m, const Dual<T, N>& yes, const Dual<T, N>& no) {
  return Dual<T, N>::make(
      select(m, yes.v, no.v), [&](int i) { return select(m, yes.d[i], no.d[i]); },
      select(m, yes.steepness, no.steepness));
}

}  // namespace sdfgrid::ops
