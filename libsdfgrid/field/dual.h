// field/dual.h: a value with its N partial derivatives, over any number type: derivatives of an
// op's formula without a second formula (internal to field/). Dual<Dual<T, 3>, 3> has second
// derivatives; Dual<Interval, N> bounds the derivatives over a box. Where a function has a kink, T
// = Interval gives the hull of the slopes on both sides, other types the slope on one side.
#pragma once

#include <array>
#include <type_traits>

#include "sdfgrid/field/interval.h"
#include "sdfgrid/field/number.h"

namespace sdfgrid::ops {

// What is left of a ratio part / whole of which |part| <= whole is known, where whole may be 0.
inline double unit_ratio(double part, double whole) { return whole > 0 ? part / whole : 0.0; }
inline Interval unit_ratio(const Interval& part, const Interval& whole) {
  if (magnitude(whole) == 0) return {-1, 1};
  return meet(Interval(-1, 1), part / whole);
}

template <class T, int N>
struct Dual {
  T v;
  std::array<T, N> d;

  Dual() = default;
  template <class C>
  requires std::is_arithmetic_v<C> Dual(C constant) : v(constant) { d.fill(T(0.0F)); }
  explicit Dual(const T& value) requires(!std::is_arithmetic_v<T>) : v(value) { d.fill(T(0.0F)); }
  // The i-th of the N variables.
  static Dual variable(const T& value, int i) {
    Dual r;
    r.v = value;
    r.d.fill(T(0.0F));
    r.d[i] = T(1.0F);
    return r;
  }
  // A value, each derivative of which is f(i).
  template <class F>
  static Dual make(const T& value, const F& f) {
    Dual r;
    r.v = value;
    for (int i = 0; i < N; ++i) r.d[i] = f(i);
    return r;
  }

  friend Dual operator+(const Dual& a, const Dual& b) {
    return make(a.v + b.v, [&](int i) { return a.d[i] + b.d[i]; });
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    return make(a.v - b.v, [&](int i) { return a.d[i] - b.d[i]; });
  }
  friend Dual operator-(const Dual& a) {
    return make(-a.v, [&](int i) { return -a.d[i]; });
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return make(a.v * b.v, [&](int i) { return a.d[i] * b.v + a.v * b.d[i]; });
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const T q = a.v / b.v;
    return make(q, [&](int i) { return (a.d[i] - q * b.d[i]) / b.v; });
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
    return make(value, [&](int i) { return slope * a.d[i]; });
  }
  friend Dual sqrt(const Dual& a) {
    const T r = sqrt(a.v);
    return chain(a, r, T(0.5F) / r);
  }
  friend Dual square(const Dual& a) { return chain(a, square(a.v), a.v * T(2.0F)); }
  friend Dual abs(const Dual& a) { return chain(a, abs(a.v), sign(a.v)); }
  friend Dual exp(const Dual& a) {
    const T r = exp(a.v);
    return chain(a, r, r);
  }
  friend Dual log(const Dual& a) { return chain(a, log(a.v), T(1.0F) / a.v); }
  friend Dual sin(const Dual& a) { return chain(a, sin(a.v), cos(a.v)); }
  friend Dual cos(const Dual& a) { return chain(a, cos(a.v), -sin(a.v)); }
  friend Dual acos(const Dual& a) {
    return chain(a, acos(a.v), T(-1.0F) / sqrt(T(1.0F) - square(a.v)));
  }
  friend Dual atan2(const Dual& y, const Dual& x) {
    const T r = square(x.v) + square(y.v);
    return make(atan2(y.v, x.v), [&](int i) { return (x.v * y.d[i] - y.v * x.d[i]) / r; });
  }
  friend Dual floor(const Dual& a) { return Dual(floor(a.v)); }
  friend Dual sign(const Dual& a) { return Dual(sign(a.v)); }
  // The exponent is a constant.
  template <class C>
  requires std::is_arithmetic_v<C>
  friend Dual pow(const Dual& a, C b) {
    return chain(a, pow(a.v, T(b)), pow(a.v, T(b - 1)) * T(b));
  }
  friend Dual length(const Dual& x, const Dual& y) {
    const T r = length(x.v, y.v);
    const T u = unit_ratio(x.v, r);
    const T v = unit_ratio(y.v, r);
    return make(r, [&](int i) { return u * x.d[i] + v * y.d[i]; });
  }
  friend Dual length(const Dual& x, const Dual& y, const Dual& z) {
    const T r = length(x.v, y.v, z.v);
    const T u = unit_ratio(x.v, r);
    const T v = unit_ratio(y.v, r);
    const T w = unit_ratio(z.v, r);
    return make(r, [&](int i) { return u * x.d[i] + v * y.d[i] + w * z.d[i]; });
  }
  // Of a dual of duals: the same ratio with its derivatives.
  friend Dual unit_ratio(const Dual& part, const Dual& whole) {
    const T q = unit_ratio(part.v, whole.v);
    return make(q, [&](int i) { return (part.d[i] - q * whole.d[i]) / whole.v; });
  }
};

template <class M, class T, int N>
inline Dual<T, N> select(M m, const Dual<T, N>& yes, const Dual<T, N>& no) {
  return Dual<T, N>::make(select(m, yes.v, no.v),
                          [&](int i) { return select(m, yes.d[i], no.d[i]); });
}

}  // namespace sdfgrid::ops
