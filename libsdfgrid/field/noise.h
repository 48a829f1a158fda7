// field/noise.h: gradient noise, written once for all number types (internal to field/).
#pragma once

#include <type_traits>

#include "sdfgrid/field/dual.h"
#include "sdfgrid/field/interval.h"

namespace sdfgrid::ops {

// The permutation (34 x + 1) x mod 289 in floats: every value is a whole number below 2^22, so
// exact. (S. Gustavson and I. McEwan, A. Efficient computational noise in GLSL, 2012, has the
// idea.)
template <class T>
T remainder_289(const T& x) {
  return x - floor((x + 0.5F) * (1.0F / 289)) * 289.0F;
}
template <class T>
T permuted(const T& x) {
  return remainder_289((x * 34.0F + 1.0F) * x);
}

// The gradient of a corner along d: one of the twelve directions to the edges of a cube, each of
// length sqrt(2), as in K. Perlin, Improving noise, 2002.
template <class T>
T edge_gradient(const T& hash, const T& x, const T& y, const T& z) {
  // 289 is no multiple of 12: the bias is below 1 in 24.
  const T kind = floor((hash + 0.5F) * (1.0F / 24.0834F));  // 0 to 11
  const T pair = floor((kind + 0.5F) * 0.25F);              // which two coordinates
  const T rest = kind - pair * 4.0F;                        // which signs
  const T high = floor((rest + 0.5F) * 0.5F);
  const T low = rest - high * 2.0F;
  const T u = select(pair < T(1.5F), x, y);
  const T v = select(pair < T(0.5F), y, z);
  return u * (T(1.0F) - low * 2.0F) + v * (T(1.0F) - high * 2.0F);
}

template <class T>
T faded(const T& t) {
  return t * t * t * (t * (t * 6.0F - 15.0F) + 10.0F);
}

// Perlin's noise with the quintic fade: within [-1, 1], 0 at whole coordinates; twice
// differentiable. Repeats every 289. `salt` (whole, below 1000) chooses another noise. Its slope is
// at most kNoiseSlope (Hart's 3 belongs to the cubic fade).
inline constexpr float kNoiseSlope = 3.7501F;

template <class T>
T noise(const Point<T>& p, float salt) {
  const T fx = floor(p.x);
  const T fy = floor(p.y);
  const T fz = floor(p.z);
  const T x = p.x - fx;
  const T y = p.y - fy;
  const T z = p.z - fz;
  const T u = faded(x);
  const T v = faded(y);
  const T w = faded(z);
  const T one(1.0F);
  const auto edge = [&](int i, int j) {  // the edge along z at corner (i, j)
    const T column = permuted(permuted(remainder_289(fx + (salt + static_cast<float>(i)))) +
                              remainder_289(fy + static_cast<float>(j)));
    const T dx = x - static_cast<float>(i);
    const T dy = y - static_cast<float>(j);
    const T lower = permuted(remainder_289(column + remainder_289(fz)));
    const T upper = permuted(remainder_289(column + remainder_289(fz + 1.0F)));
    return mix(edge_gradient(lower, dx, dy, z), edge_gradient(upper, dx, dy, z - one), w);
  };
  return mix(mix(edge(0, 0), edge(0, 1), v), mix(edge(1, 0), edge(1, 1), v), u);
}

// Over a box: its value in the middle, spread by its slope.
inline Interval noise(const Point<Interval>& p, float salt) {
  const Point<double> middle = {0.5 * (p.x.lo + p.x.hi), 0.5 * (p.y.lo + p.y.hi),
                                0.5 * (p.z.lo + p.z.hi)};
  const double dx = p.x.hi - p.x.lo;
  const double dy = p.y.hi - p.y.lo;
  const double dz = p.z.hi - p.z.lo;
  const double half = 0.5 * kNoiseSlope * std::sqrt(dx * dx + dy * dy + dz * dz);
  if (!(half < 1)) return {-1.0001, 1.0001};
  const double size = std::fabs(middle.x) + std::fabs(middle.y) + std::fabs(middle.z);
  const double value = noise(middle, salt);
  const double slack = half + 1e-5 + size * 4 * kFloatSlack;
  return meet(Interval(-1.0001, 1.0001), Interval(value - slack, value + slack));
}
template <int N>
Dual<Interval, N> noise(const Point<Dual<Interval, N>>& p, float salt) {
  const Interval slope(-kNoiseSlope, kNoiseSlope);
  return Dual<Interval, N>::make(noise(Point<Interval>{p.x.v, p.y.v, p.z.v}, salt), [&](int i) {
    return slope * p.x.d[i] + slope * p.y.d[i] + slope * p.z.d[i];
  });
}

// Octaves of noise, each of twice the frequency of the one before and 2^-beta/2 of its amplitude
// (a power spectrum of 1 / f^beta), moved apart so that their zeros do not meet.
struct Octaves {
  float frequency, amplitude, octaves, beta, seed;

  template <class T>
  T value(const Point<T>& p) const {
    T sum(0.0F);
    float f = frequency;
    float a = amplitude;
    const float fall = __builtin_exp2f(-0.5F * beta);
    for (int i = 0; i < static_cast<int>(octaves); ++i) {
      const float shift = 0.37F * static_cast<float>(i);
      const float salt = seed + 31.0F * static_cast<float>(i);
      sum = sum + noise(Point<T>{p.x * f + shift, p.y * f + shift, p.z * f + shift}, salt) * a;
      f *= 2;
      a *= fall;
    }
    return sum;
  }
  // Bounds on its slope and its size.
  [[nodiscard]] double slope() const { return sum(true) * kNoiseSlope; }
  [[nodiscard]] double largest() const { return sum(false); }

 private:
  [[nodiscard]] double sum(bool of_slopes) const {
    double total = 0;
    double f = frequency;
    double a = amplitude;
    for (int i = 0; i < static_cast<int>(octaves); ++i) {
      total += of_slopes ? a * f : a;
      f *= 2;
      a *= std::exp2(-0.5 * beta);
    }
    return total;
  }
};

}  // namespace sdfgrid::ops
