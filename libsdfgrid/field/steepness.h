// field/steepness.h: bounds on the length of a gradient over a box, beside those on its components
// (internal to field/). A box of vectors reaches farther than the vectors that it holds: around the
// origin each component of the gradient of length(x, y, z) lies from -1 to 1, and its length is 1.
#pragma once

#include <array>
#include <cmath>

#include "sdfgrid/field/interval.h"

namespace sdfgrid::ops {

// The length of a vector in a box, at most.
inline double norm(const Interval* d, int count) {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += magnitude(d[i]) * magnitude(d[i]);
  return std::isnan(sum) ? kInfinity : std::sqrt(sum);
}

// What a Dual over T knows of the length of its gradient: of numbers that are no intervals nothing,
// at no cost.
template <class T>
struct Steepness {
  static constexpr bool kKnown = false;
  static Steepness at_most(double) { return {}; }
  template <std::size_t N>
  [[nodiscard]] Steepness and_of(const std::array<T, N>&) const {
    return {};
  }
  friend Steepness operator+(Steepness, Steepness) { return {}; }
  friend Steepness operator*(const T&, Steepness) { return {}; }
  friend Steepness operator/(Steepness, const T&) { return {}; }
};
template <class M, class T>
Steepness<T> select(const M&, Steepness<T>, Steepness<T>) {
  return {};
}

template <>
struct Steepness<Interval> {
  static constexpr bool kKnown = true;
  double most = kInfinity;

  static Steepness at_most(double most) { return {most}; }
  // No more than the components allow.
  template <std::size_t N>
  [[nodiscard]] Steepness and_of(const std::array<Interval, N>& d) const {
    return {lesser(most, norm(d.data(), N))};
  }
  friend Steepness operator+(Steepness a, Steepness b) { return {a.most + b.most}; }
  friend Steepness operator*(const Interval& slope, Steepness a) {
    return {product(magnitude(slope), a.most)};
  }
  friend Steepness operator/(Steepness a, const Interval& by) { return Interval(1) / by * a; }
};
inline Steepness<Interval> select(Maybe m, Steepness<Interval> yes, Steepness<Interval> no) {
  if (m.certainly) return yes;
  return m.possibly ? Steepness<Interval>{greater(yes.most, no.most)} : no;
}

// The norm of a matrix of these rows, at most: the Frobenius norm, and the root of the largest row
// sum of the matrix times its transpose (Gershgorin).
template <std::size_t N, std::size_t Rows>
Steepness<Interval> joint(const std::array<const std::array<Interval, N>*, Rows>& rows,
                          const std::array<double, Rows>& most) {
  double trace = 0;
  double largest = 0;
  for (std::size_t i = 0; i < Rows; ++i) {
    double sum = most[i] * most[i];
    trace += sum;
    for (std::size_t j = 0; j < Rows; ++j) {
      if (j == i) continue;
      Interval dot(0);
      for (std::size_t k = 0; k < N; ++k) dot += (*rows[i])[k] * (*rows[j])[k];
      sum += lesser(product(most[i], most[j]), magnitude(dot));
    }
    largest = greater(largest, sum);
  }
  return {std::sqrt(lesser(trace, largest))};
}

}  // namespace sdfgrid::ops
