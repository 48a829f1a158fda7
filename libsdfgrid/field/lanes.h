// field/lanes.h: sixteen floats as a number type of the ops, for the *_kernel.cpp files of field/
// only (not installed). A struct, unlike F16 of core/simd.h, so that ops find its functions by
// argument. Every instruction set gives the same bits: nothing is contracted (these files are
// compiled with -ffp-contract=off), nothing is an estimate, and what core/simd.h rounds or cuts off
// as the machine likes is pinned down here.
#pragma once

#include "sdfgrid/core/simd.h"
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace sdfgrid::SDFGRID_ISA {

inline I16 float_bits(F16 a) {
  I16 r;
  __builtin_memcpy(&r, &a, sizeof r);
  return r;
}
inline F16 bits_float(I16 a) {
  F16 r;
  __builtin_memcpy(&r, &a, sizeof r);
  return r;
}

// The largest whole number not above a, of any float; -0 of -0.
inline F16 whole(F16 a) {
#if defined(__AVX512F__)
  return floor(a);
#elif defined(__AVX2__)
  return by_part<F16>([&](int i) { return (FPart)_mm256_floor_ps((__m256)a.part[i]); });
#else
  constexpr float kAllWhole = 8388608;  // from here on every float is
  const F16 below = bits_float(float_bits(floor(a)) | (float_bits(a) & splat(-0x7fffffff - 1)));
  return select(abs(a) < kAllWhole, below, a);
#endif
}

// a * b + c rounded once, on machines that have no instruction for it, too.
#if defined(__FMA__)
inline F16 fused(F16 a, F16 b, F16 c) { return fma(a, b, c); }
#elif defined(__SSE2__)
// Where two lanes of a sum that was rounded to double may have to be rounded to another float than
// it is: half way between two of them, or below the least normal one.
inline __m128d doubtful(__m128d sum) {
  const __m128i low = _mm_and_si128(_mm_castpd_si128(sum), _mm_set1_epi64x(0x1fffffff));
  const __m128i half_way = _mm_cmpeq_epi32(low, _mm_set1_epi64x(0x110000000));
  const __m128d least = _mm_set1_pd(0x1p-126);
  const __m128d small = _mm_and_pd(_mm_cmplt_pd(sum, least), _mm_cmpgt_pd(sum, -least));
  const __m128d not_zero = _mm_cmpneq_pd(sum, _mm_setzero_pd());
  return _mm_or_pd(_mm_castsi128_pd(half_way), _mm_and_pd(small, not_zero));
}
inline __m128d sum_of_two(__m128 a, __m128 b, __m128 c) {  // of the lower two; the product is exact
  return _mm_add_pd(_mm_mul_pd(_mm_cvtps_pd(a), _mm_cvtps_pd(b)), _mm_cvtps_pd(c));
}
inline F16 fused(const F16& a, const F16& b, const F16& c) {
  const auto upper = [](__m128 v) { return _mm_movehl_ps(v, v); };
  __m128d doubt = _mm_setzero_pd();
  F16 r = by_part<F16>([&](int i) {
    const auto x = (__m128)a.part[i];
    const auto y = (__m128)b.part[i];
    const auto z = (__m128)c.part[i];
    const __m128d first = sum_of_two(x, y, z);
    const __m128d second = sum_of_two(upper(x), upper(y), upper(z));
    doubt = _mm_or_pd(doubt, _mm_or_pd(doubtful(first), doubtful(second)));
    return (FPart)_mm_movelh_ps(_mm_cvtpd_ps(first), _mm_cvtpd_ps(second));
  });
  if (_mm_movemask_epi8(_mm_castpd_si128(doubt)) != 0) {
    for (int i = 0; i < kLanes; ++i) r[i] = __builtin_fmaf(a[i], b[i], c[i]);
  }
  return r;
}
#else
inline F16 fused(const F16& a, const F16& b, const F16& c) {
  F16 r;
  for (int i = 0; i < kLanes; ++i) r[i] = __builtin_fmaf(a[i], b[i], c[i]);
  return r;
}
#endif

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
// Of what is below 0 by rounding, 0. The machine's own root, though with AVX-512 an estimate and a
// step of Newton's method are quicker (by 4 % over a scene of 127 ops): those are not rounded
// alike.
inline Lanes sqrt(Lanes a) { return sqrt(max(a.v, splat(0.0F))); }
// The root inside of another one, by multiplications where the machine can start from an estimate:
// its unit for roots takes one every 12 cycles, which a formula of two of them waits for (a torus
// takes 0.7 of the time). Markstein's steps (P. Markstein, IA-64 and Elementary Functions, 2000)
// round as that unit does, which a test compares; of what is below 2^-96, where they would lose
// digits, 0 is taken on every machine.
inline constexpr float kLeastSquare = 0x1p-96F;
inline constexpr float kMostSquare = 0x1.fffffep127F;
#if defined(__AVX512F__)
inline Lanes inner_root(Lanes sum) {
  const __mmask16 some = _mm512_cmp_ps_mask((__m512)sum.v, (__m512)splat(kLeastSquare), _CMP_GE_OQ);
  const F16 a = min(sum.v, splat(kMostSquare));
  const F16 estimate = (F16)_mm512_rsqrt14_ps((__m512)a);
  const F16 g = a * estimate;
  const F16 h = estimate * 0.5F;
  const F16 miss = fma(-g, h, splat(0.5F));
  const F16 root = fma(g, miss, g);
  const F16 half = fma(h, miss, h);  // of 1 / root
  const F16 rest = fma(-root, root, a);
  return (F16)_mm512_maskz_fmadd_ps(some, (__m512)rest, (__m512)half, (__m512)root);
}
#else
inline Lanes inner_root(const Lanes& sum) {
  const F16 root = sqrt(min(sum.v, splat(kMostSquare)));
  return select(sum.v >= kLeastSquare, root, splat(0.0F));
}
#endif

// Of number.h, without what only other numbers need: a sum of squares is not below 0, and outside
// of a box nothing has to be added.
inline Lanes length(Lanes x, Lanes y, Lanes z) { return sqrt(x.v * x.v + y.v * y.v + z.v * z.v); }
inline Lanes inner_length(Lanes x, Lanes y) { return inner_root(x.v * x.v + y.v * y.v); }
inline Lanes box_distance(Lanes x, Lanes y, Lanes z) {
  const Lanes none = 0.0F;
  const Lanes largest = max(x, max(y, z));
  return select(largest > none, length(max(x, none), max(y, none), max(z, none)), largest);
}

inline Lanes floor(Lanes a) { return whole(a.v); }
inline Lanes sign(Lanes a) { return select(a.v < 0.0F, splat(-1.0F), splat(1.0F)); }

}  // namespace sdfgrid::SDFGRID_ISA
