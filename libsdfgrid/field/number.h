// field/number.h: what a number type of the ops is, and the arithmetic that all share (internal to
// field/). An op's formula is a template over its number type T; the readings of a field are types:
//
//   double                 a value (tests, centres of boxes)
//   SDFGRID_ISA::Lanes     sixteen floats (lanes.h; kernels only)
//   Interval               all values over a box (interval.h)
//   Dual<T, N>             a value with its derivatives (dual.h), over any of these
//   Text                   GLSL (text.h)
//
// Each has + - * /, sqrt exp log sin cos atan2 acos pow floor abs sign min max square, comparisons
// that give a mask, masks with & | !, and select(mask, yes, no). Formulas never branch on values.
#pragma once

#include <cmath>

namespace sdfgrid::ops {

template <class T>
struct Point {
  T x, y, z;
};

// The parts of the arithmetic that double lacks or has elsewhere. Never called by kernels.
inline double sqrt(double a) { return std::sqrt(a > 0 ? a : 0.0); }
inline double exp(double a) { return std::exp(a); }
// As single precision has it: of what is not above 0 about -87.
inline double log(double a) { return std::log(a > 1.17549435e-38 ? a : 1.17549435e-38); }
inline double sin(double a) { return std::sin(a); }
inline double cos(double a) { return std::cos(a); }
inline double atan2(double y, double x) { return std::atan2(y, x); }
inline double acos(double a) { return std::acos(a < -1 ? -1.0 : (a > 1 ? 1.0 : a)); }
inline double floor(double a) { return std::floor(a); }
inline double abs(double a) { return std::fabs(a); }
inline double min(double a, double b) { return a < b ? a : b; }
inline double max(double a, double b) { return a > b ? a : b; }
inline double square(double a) { return a * a; }
inline double sign(double a) { return a < 0 ? -1.0 : 1.0; }
inline double pow(double a, double b) { return a > 0 ? std::pow(a, b) : 0.0; }
inline double select(bool m, double yes, double no) { return m ? yes : no; }

template <class T>
inline T length(const T& x, const T& y) {
  return sqrt(square(x) + square(y));
}
// A length that goes into another one: lanes take its root in another way (lanes.h, which has its
// own of the next two and of box_distance() too).
template <class T>
inline T inner_length(const T& x, const T& y) {
  return length(x, y);
}
template <class T>
inline T length(const T& x, const T& y, const T& z) {
  return sqrt(square(x) + square(y) + square(z));
}
template <class T>
inline T length(const Point<T>& p) {
  return length(p.x, p.y, p.z);
}
// Limits are numbers of the op, not of the reading: F is float or double.
template <class T, class F>
inline T clamp(const T& a, F lo, F hi) {
  return min(max(a, T(lo)), T(hi));
}
template <class T>
inline T positive(const T& a) {
  return max(a, T(0.0F));
}
template <class T>
inline T mix(const T& a, const T& b, const T& t) {
  return a + (b - a) * t;
}
template <class T>
inline T dot(const Point<T>& a, const Point<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
// With three constants of the op.
template <class T>
inline T dot(const float n[3], const Point<T>& p) {
  return p.x * n[0] + p.y * n[1] + p.z * n[2];
}
template <class T>
inline Point<T> minus(const Point<T>& p, const float c[3]) {
  return {p.x - c[0], p.y - c[1], p.z - c[2]};
}
// Distance to a box whose faces lie at the three signed offsets from the point.
template <class T>
inline T box_distance(const T& x, const T& y, const T& z) {
  return length(positive(x), positive(y), positive(z)) + min(max(x, max(y, z)), T(0.0F));
}
template <class T>
inline T rectangle_distance(const T& x, const T& y) {
  return length(positive(x), positive(y)) + min(max(x, y), T(0.0F));
}

}  // namespace sdfgrid::ops
