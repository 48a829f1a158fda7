// core/simd.h: sixteen lanes at a time, for the *_kernel.cpp files only (not installed). GCC and
// Clang vector extensions: the compiler splits them to what the instruction set has, so one source
// serves SSE2, AVX2 and AVX-512. Everything lives in the namespace of its instruction set, because
// two builds of one inline function must not be merged by the linker.
#pragma once

#include <cstdint>
#if defined(__AVX2__)
#include <immintrin.h>
#endif

#ifndef SDFGRID_ISA
#error "simd.h is for kernels built by sdfgrid_kernel()"
#endif

namespace sdfgrid::SDFGRID_ISA {

inline constexpr int kLanes = 16;

typedef float F16 __attribute__((vector_size(64)));         // sixteen floats
typedef std::int32_t I16 __attribute__((vector_size(64)));  // sixteen ints; as a mask: 0 or -1

inline F16 splat(float v) { return F16{} + v; }
inline I16 splat(std::int32_t v) { return I16{} + v; }
inline F16 select(I16 mask, F16 yes, F16 no) { return mask ? yes : no; }
inline I16 select(I16 mask, I16 yes, I16 no) { return mask ? yes : no; }

inline F16 load(const float* p) {
  F16 v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
inline I16 load(const std::int32_t* p) {
  I16 v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
inline void store(float* p, F16 v) { __builtin_memcpy(p, &v, sizeof v); }
inline void store(std::int32_t* p, I16 v) { __builtin_memcpy(p, &v, sizeof v); }

#if defined(__AVX512F__)

inline F16 min(F16 a, F16 b) { return (F16)_mm512_min_ps((__m512)a, (__m512)b); }
inline F16 max(F16 a, F16 b) { return (F16)_mm512_max_ps((__m512)a, (__m512)b); }
inline F16 sqrt(F16 a) { return (F16)_mm512_sqrt_ps((__m512)a); }
inline F16 abs(F16 a) { return (F16)_mm512_abs_ps((__m512)a); }
inline F16 floor(F16 a) { return (F16)_mm512_floor_ps((__m512)a); }
// One bit a lane, lane 0 lowest.
inline std::uint32_t bits(I16 mask) { return _mm512_movepi32_mask((__m512i)mask); }
inline I16 to_int(F16 a) { return (I16)_mm512_cvttps_epi32((__m512)a); }
inline F16 to_float(I16 a) { return (F16)_mm512_cvtepi32_ps((__m512i)a); }
inline F16 gather(const float* p, I16 index) {
  return (F16)_mm512_i32gather_ps((__m512i)index, p, 4);
}
inline I16 gather(const std::int32_t* p, I16 index) {
  return (I16)_mm512_i32gather_epi32((__m512i)index, p, 4);
}

#else

namespace detail {
template <class V, class F>
inline V each(F f) {
  V r;
  for (int i = 0; i < kLanes; ++i) r[i] = f(i);
  return r;
}
}  // namespace detail

inline F16 min(F16 a, F16 b) { return a < b ? a : b; }
inline F16 max(F16 a, F16 b) { return a > b ? a : b; }
inline F16 abs(F16 a) { return (F16)((I16)a & splat(0x7fffffff)); }
inline F16 sqrt(F16 a) {
  return detail::each<F16>([&](int i) { return __builtin_sqrtf(a[i]); });
}
inline I16 to_int(F16 a) { return __builtin_convertvector(a, I16); }
inline F16 to_float(I16 a) { return __builtin_convertvector(a, F16); }
inline F16 floor(F16 a) {
  const F16 t = to_float(to_int(a));
  return select(t > a, t - 1.0F, t);
}
inline std::uint32_t bits(I16 mask) {
#if defined(__AVX2__)
  __m256 half[2];
  __builtin_memcpy(half, &mask, sizeof half);
  return static_cast<std::uint32_t>(_mm256_movemask_ps(half[0])) |
         static_cast<std::uint32_t>(_mm256_movemask_ps(half[1])) << 8;
#else
  std::uint32_t r = 0;
  for (int i = 0; i < kLanes; ++i) r |= (static_cast<std::uint32_t>(mask[i]) & 1U) << i;
  return r;
#endif
}
inline F16 gather(const float* p, I16 index) {
  return detail::each<F16>([&](int i) { return p[index[i]]; });
}
inline I16 gather(const std::int32_t* p, I16 index) {
  return detail::each<I16>([&](int i) { return p[index[i]]; });
}

#endif

inline bool any(I16 mask) { return bits(mask) != 0; }
inline bool all(I16 mask) { return bits(mask) == 0xffffU; }

}  // namespace sdfgrid::SDFGRID_ISA
