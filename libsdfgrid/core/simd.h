// core/simd.h: sixteen lanes at a time, for the *_kernel.cpp files only (not installed). One source
// serves SSE2, AVX2 and AVX-512. Everything lives in the namespace of its instruction set, because
// two builds of one inline function must not be merged by the linker.
//
// With AVX-512 a value is one register, by the compiler's vector extensions. Elsewhere it is
// several of the machine's own width: left to split a wider vector itself, GCC 12 turns every
// comparison and choice into sixteen scalar ones, which is 6 to 10 times slower.
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

#if defined(__AVX512F__)

using F16 = float __attribute__((vector_size(64)));         // sixteen floats
using I16 = std::int32_t __attribute__((vector_size(64)));  // sixteen ints; as a mask: 0 or -1

inline F16 splat(float v) { return F16{} + v; }
inline I16 splat(std::int32_t v) { return I16{} + v; }
inline F16 select(I16 mask, F16 yes, F16 no) { return mask ? yes : no; }
inline I16 select(I16 mask, I16 yes, I16 no) { return mask ? yes : no; }

#else

#if defined(__AVX2__)
inline constexpr int kPartBytes = 32;
#else
inline constexpr int kPartBytes = 16;
#endif
inline constexpr int kParts = 64 / kPartBytes;
using FPart = float __attribute__((vector_size(kPartBytes)));
using IPart = std::int32_t __attribute__((vector_size(kPartBytes)));

template <class Part, class Scalar>
struct alignas(64) Wide {
  Part part[kParts];
  Scalar& operator[](int lane) { return reinterpret_cast<Scalar*>(this)[lane]; }
  Scalar operator[](int lane) const { return reinterpret_cast<const Scalar*>(this)[lane]; }
};
struct F16 : Wide<FPart, float> {};
struct I16 : Wide<IPart, std::int32_t> {};

template <class W, class Work>
inline W by_part(const Work& work) {
  W r;
  for (int i = 0; i < kParts; ++i) r.part[i] = work(i);
  return r;
}
inline F16 splat(float v) {
  return by_part<F16>([&](int) { return FPart{} + v; });
}
inline I16 splat(std::int32_t v) {
  return by_part<I16>([&](int) { return IPart{} + v; });
}

// The operators of a lane type, also with a number on either side.
// NOLINTBEGIN(bugprone-macro-parentheses): types and operators take none
#define SDFGRID_BINARY(W, Scalar, Result, op)                              \
  inline Result operator op(const W& a, const W& b) {                      \
    return by_part<Result>([&](int i) { return a.part[i] op b.part[i]; }); \
  }                                                                        \
  inline Result operator op(const W& a, Scalar b) {                        \
    return by_part<Result>([&](int i) { return a.part[i] op b; });         \
  }                                                                        \
  inline Result operator op(Scalar a, const W& b) {                        \
    return by_part<Result>([&](int i) { return a op b.part[i]; });         \
  }
#define SDFGRID_ARITHMETIC(W, Scalar, op) \
  SDFGRID_BINARY(W, Scalar, W, op)        \
  inline W& operator op##=(W& a, const W& b) { return a = a op b; }
SDFGRID_ARITHMETIC(F16, float, +)
SDFGRID_ARITHMETIC(F16, float, -)
SDFGRID_ARITHMETIC(F16, float, *)
SDFGRID_ARITHMETIC(F16, float, /)
SDFGRID_BINARY(F16, float, I16, <)
SDFGRID_BINARY(F16, float, I16, <=)
SDFGRID_BINARY(F16, float, I16, >)
SDFGRID_BINARY(F16, float, I16, >=)
SDFGRID_BINARY(F16, float, I16, ==)
SDFGRID_BINARY(F16, float, I16, !=)
SDFGRID_ARITHMETIC(I16, std::int32_t, +)
SDFGRID_ARITHMETIC(I16, std::int32_t, -)
SDFGRID_ARITHMETIC(I16, std::int32_t, *)
SDFGRID_ARITHMETIC(I16, std::int32_t, &)
SDFGRID_ARITHMETIC(I16, std::int32_t, |)
SDFGRID_ARITHMETIC(I16, std::int32_t, ^)
SDFGRID_ARITHMETIC(I16, std::int32_t, <<)
SDFGRID_ARITHMETIC(I16, std::int32_t, >>)
SDFGRID_BINARY(I16, std::int32_t, I16, <)
SDFGRID_BINARY(I16, std::int32_t, I16, <=)
SDFGRID_BINARY(I16, std::int32_t, I16, >)
SDFGRID_BINARY(I16, std::int32_t, I16, >=)
SDFGRID_BINARY(I16, std::int32_t, I16, ==)
SDFGRID_BINARY(I16, std::int32_t, I16, !=)
#undef SDFGRID_ARITHMETIC
#undef SDFGRID_BINARY
// NOLINTEND(bugprone-macro-parentheses)
inline F16 operator-(const F16& a) {
  return by_part<F16>([&](int i) { return -a.part[i]; });
}
inline I16 operator-(const I16& a) {
  return by_part<I16>([&](int i) { return -a.part[i]; });
}
inline I16 operator~(const I16& a) {
  return by_part<I16>([&](int i) { return ~a.part[i]; });
}
inline F16 select(const I16& mask, const F16& yes, const F16& no) {
  return by_part<F16>([&](int i) { return mask.part[i] ? yes.part[i] : no.part[i]; });
}
inline I16 select(const I16& mask, const I16& yes, const I16& no) {
  return by_part<I16>([&](int i) { return mask.part[i] ? yes.part[i] : no.part[i]; });
}

#endif

#if defined(__AVX512F__)

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

#else

// Part by part: copied whole, GCC 12 moves a value through memory sixteen bytes at a time, and a
// load of a wider part that follows has to wait for all of them (3 to 5 times slower with AVX2).
inline F16 load(const float* p) {
  return by_part<F16>([&](int i) {
    FPart v;
    __builtin_memcpy(&v, reinterpret_cast<const char*>(p) + i * kPartBytes, sizeof v);
    return v;
  });
}
inline I16 load(const std::int32_t* p) {
  return by_part<I16>([&](int i) {
    IPart v;
    __builtin_memcpy(&v, reinterpret_cast<const char*>(p) + i * kPartBytes, sizeof v);
    return v;
  });
}
inline void store(float* p, const F16& v) {
  for (int i = 0; i < kParts; ++i) {
    __builtin_memcpy(reinterpret_cast<char*>(p) + i * kPartBytes, &v.part[i], kPartBytes);
  }
}
inline void store(std::int32_t* p, const I16& v) {
  for (int i = 0; i < kParts; ++i) {
    __builtin_memcpy(reinterpret_cast<char*>(p) + i * kPartBytes, &v.part[i], kPartBytes);
  }
}

#endif

#if defined(__AVX512F__)

inline F16 min(F16 a, F16 b) { return (F16)_mm512_min_ps((__m512)a, (__m512)b); }
inline F16 max(F16 a, F16 b) { return (F16)_mm512_max_ps((__m512)a, (__m512)b); }
inline I16 min(I16 a, I16 b) { return (I16)_mm512_min_epi32((__m512i)a, (__m512i)b); }
inline I16 max(I16 a, I16 b) { return (I16)_mm512_max_epi32((__m512i)a, (__m512i)b); }
inline F16 sqrt(F16 a) { return (F16)_mm512_sqrt_ps((__m512)a); }
inline F16 fma(F16 a, F16 b, F16 c) {
  return (F16)_mm512_fmadd_ps((__m512)a, (__m512)b, (__m512)c);
}
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

inline F16 min(const F16& a, const F16& b) {
  return by_part<F16>([&](int i) { return a.part[i] < b.part[i] ? a.part[i] : b.part[i]; });
}
inline F16 max(const F16& a, const F16& b) {
  return by_part<F16>([&](int i) { return a.part[i] > b.part[i] ? a.part[i] : b.part[i]; });
}
inline I16 min(const I16& a, const I16& b) { return select(a < b, a, b); }
inline I16 max(const I16& a, const I16& b) { return select(a > b, a, b); }
inline F16 abs(const F16& a) {
  return by_part<F16>([&](int i) { return (FPart)((IPart)a.part[i] & 0x7fffffff); });
}
inline F16 sqrt(const F16& a) {
#if defined(__AVX2__)
  return by_part<F16>([&](int i) { return (FPart)_mm256_sqrt_ps((__m256)a.part[i]); });
#else
  F16 r;
  for (int i = 0; i < kLanes; ++i) r[i] = __builtin_sqrtf(a[i]);
  return r;
#endif
}
inline F16 fma(const F16& a, const F16& b, const F16& c) {
#if defined(__FMA__)
  return by_part<F16>([&](int i) {
    return (FPart)_mm256_fmadd_ps((__m256)a.part[i], (__m256)b.part[i], (__m256)c.part[i]);
  });
#else
  return a * b + c;
#endif
}
inline I16 to_int(const F16& a) {
  return by_part<I16>([&](int i) { return __builtin_convertvector(a.part[i], IPart); });
}
inline F16 to_float(const I16& a) {
  return by_part<F16>([&](int i) { return __builtin_convertvector(a.part[i], FPart); });
}
inline F16 floor(const F16& a) {
  const F16 t = to_float(to_int(a));
  return select(t > a, t - 1.0F, t);
}
inline std::uint32_t bits(const I16& mask) {
#if defined(__AVX2__)
  return static_cast<std::uint32_t>(_mm256_movemask_ps((__m256)mask.part[0])) |
         static_cast<std::uint32_t>(_mm256_movemask_ps((__m256)mask.part[1])) << 8;
#else
  std::uint32_t r = 0;
  for (int i = 0; i < kLanes; ++i) r |= (static_cast<std::uint32_t>(mask[i]) & 1U) << i;
  return r;
#endif
}
inline F16 gather(const float* p, const I16& index) {
#if defined(__AVX2__)
  return by_part<F16>(
      [&](int i) { return (FPart)_mm256_i32gather_ps(p, (__m256i)index.part[i], 4); });
#else
  F16 r;
  for (int i = 0; i < kLanes; ++i) r[i] = p[index[i]];
  return r;
#endif
}
inline I16 gather(const std::int32_t* p, const I16& index) {
#if defined(__AVX2__)
  return by_part<I16>(
      [&](int i) { return (IPart)_mm256_i32gather_epi32(p, (__m256i)index.part[i], 4); });
#else
  I16 r;
  for (int i = 0; i < kLanes; ++i) r[i] = p[index[i]];
  return r;
#endif
}

#endif

// a * b + c, rounded once where the machine has such an instruction. Written out where bits must be
// the same on AVX2 and AVX-512: which product of a sum the compiler fuses is its own choice.
inline double fma(double a, double b, double c) {
#if defined(__FMA__)
  return __builtin_fma(a, b, c);
#else
  return a * b + c;
#endif
}

inline bool any(I16 mask) { return bits(mask) != 0; }
inline bool all(I16 mask) { return bits(mask) == 0xffffU; }

}  // namespace sdfgrid::SDFGRID_ISA
