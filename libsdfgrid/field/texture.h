// field/texture.h: a picture of heights that repeats in both directions, smooth between its
// samples, written once for all number types (internal to field/).
#pragma once

#include "sdfgrid/field/dual.h"
#include "sdfgrid/field/interval.h"

namespace sdfgrid::ops {

// Row by row, width * height samples in [least, most].
struct Texture {
  const float* values;
  int width, height;
  float least, most;
};

// A place as an index, whatever it is: beyond 2^22 wrapped() may round it out of the picture.
inline int index_in(double place, int size) {
  return place > 0 ? (place < size ? static_cast<int>(place) : size - 1) : 0;  // NaN is 0
}

// The sample at a whole place within the picture. Kernels and text have their own.
inline double texel(const Texture& t, const double& column, const double& row) {
  return t.values[index_in(row, t.height) * t.width + index_in(column, t.width)];
}
template <class T, int N>
Dual<T, N> texel(const Texture& t, const Dual<T, N>& column, const Dual<T, N>& row) {
  return Dual<T, N>(texel(t, column.v, row.v));
}

// A whole place within [0, size); exact below kExactPlaces.
inline constexpr double kExactPlaces = 0x1p22;
template <class T>
T wrapped(const T& place, int size) {
  const auto n = static_cast<float>(size);
  return place - floor((place + 0.5F) * (1 / n)) * n;
}

// The quadratic B-spline over the samples, u to the right and v down; sample (i, j) stands at
// (i + 0.5, j + 0.5). No larger or smaller than the nine samples around, and its derivatives are
// means of the differences between them.
template <class T>
T texture(const Texture& t, const T& u, const T& v) {
  const T left = floor(u);
  const T top = floor(v);
  const T x = u - left - 0.5F;
  const T y = v - top - 0.5F;
  const auto weight = [](const T& s, int i) {
    return i == 1 ? T(0.75F) - square(s) : square(i == 0 ? T(0.5F) - s : s + 0.5F) * 0.5F;
  };
  T columns[3];
  for (int i = 0; i < 3; ++i) columns[i] = wrapped(left + static_cast<float>(i - 1), t.width);
  T sum(0.0F);
  for (int j = 0; j < 3; ++j) {
    const T row = wrapped(top + static_cast<float>(j - 1), t.height);
    T along(0.0F);
    for (int i = 0; i < 3; ++i) along = along + texel(t, columns[i], row) * weight(x, i);
    sum = sum + along * weight(y, j);
  }
  return sum;
}

// Over a box: all samples that take part anywhere in it.
inline Interval texture(const Texture& t, const Interval& u, const Interval& v) {
  const double left = std::floor(u.lo) - 1;
  const double right = std::floor(u.hi) + 1;
  const double top = std::floor(v.lo) - 1;
  const double bottom = std::floor(v.hi) + 1;
  double lo = t.least;
  double hi = t.most;
  constexpr double kFew = 1024;
  const bool exact = std::fmax(std::fabs(left), std::fabs(right)) < kExactPlaces &&
                     std::fmax(std::fabs(top), std::fabs(bottom)) < kExactPlaces;
  if (exact && (right - left) * (bottom - top) < kFew) {
    lo = kInfinity;
    hi = -kInfinity;
    for (double row = top; row <= bottom; ++row) {
      for (double column = left; column <= right; ++column) {
        const double s = texel(t, wrapped(column, t.width), wrapped(row, t.height));
        lo = std::fmin(lo, s);
        hi = std::fmax(hi, s);
      }
    }
  }
  const double slack = 8 * kFloatSlack * std::fmax(std::fabs(t.least), std::fabs(t.most));
  return {lo - slack, hi + slack};
}

}  // namespace sdfgrid::ops
