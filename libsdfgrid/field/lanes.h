// field/lanes.h: sixteen floats as a number type of the ops, for the *_kernel.cpp files of field/
// only (not installed). A struct, unlike F16 of core/simd.h, so that ops find its functions by
// argument.
#pragma once

#include "sdfgrid/core/simd.h"

namespace sdfgrid::SDFGRID_ISA {

struct Mask {
  I16 m;
};
inline Mask operator&(Mask a, Mask b) { return {a.m & b.m}; }
inline Mask operator|(Mask a, Mask b) { return {a.m | b.m}; }
inline Mask operator!(Mask a) { return {~a.m}; }
inline bool any(Mask a) { return any(a.m); }

struct Lanes {
  F16 v;

  Lanes() = default;
  Lanes(F16 a) : v(a) {}
  Lanes(float a) : v(splat(a)) {}
};

inline float first_of(Lanes a) { return a.v[0]; }
inline Lanes operator+(Lanes a, Lanes b) { return a.v + b.v; }
inline Lanes operator-(Lanes a, Lanes b) { return a.v - b.v; }
inline Lanes operator*(Lanes a, Lanes b) { return a.v * b.v; }
inline Lanes operator/(Lanes a, Lanes b) { return a.v / b.v; }
inline Lanes operator-(Lanes a) { return -a.v; }
inline Lanes& operator+=(Lanes& a, Lanes b) { return a = a + b; }
inline Lanes& operator-=(Lanes& a, Lanes b) { return a = a - b; }
inline Lanes& operator*=(Lanes& a, Lanes b) { return a = a * b; }
inline Mask operator<(Lanes a, Lanes b) { return {a.v < b.v}; }
inline Mask operator>(Lanes a, Lanes b) { return {a.v > b.v}; }
inline Mask operator<=(Lanes a, Lanes b) { return {a.v <= b.v}; }
inline Mask operator>=(Lanes a, Lanes b) { return {a.v >= b.v}; }
inline Lanes select(Mask m, Lanes yes, Lanes no) { return select(m.m, yes.v, no.v); }

inline Lanes min(Lanes a, Lanes b) { return min(a.v, b.v); }
inline Lanes max(Lanes a, Lanes b) { return max(a.v, b.v); }
inline Lanes abs(Lanes a) { return abs(a.v); }
inline Lanes square(Lanes a) { return a.v * a.v; }
// Of what is below 0 by rounding, 0.
#if defined(__AVX512F__)
// Most ops wait for their square roots, and the machine's own takes four times as long as an
// estimate of 14 bits and one step of Newton's method on the exact remainder, which is within 0.6
// units in the last place.
inline Lanes sqrt(Lanes a) {
  const __mmask16 positive = _mm512_cmp_ps_mask((__m512)a.v, _mm512_setzero_ps(), _CMP_GT_OQ);
  const F16 r = (F16)_mm512_maskz_rsqrt14_ps(positive, (__m512)a.v);
  const F16 s = a.v * r;
  return fma(fma(-s, s, a.v), 0.5F * r, s);
}
#else
inline Lanes sqrt(Lanes a) { return sqrt(max(a.v, splat(0.0F))); }
#endif
inline Lanes floor(Lanes a) { return floor(a.v); }
inline Lanes sign(Lanes a) { return select(a.v < 0.0F, splat(-1.0F), splat(1.0F)); }

}  // namespace sdfgrid::SDFGRID_ISA
