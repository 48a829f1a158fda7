// trace/simd_double.h: sixteen doubles beside the floats of core/simd.h, for the *_kernel.cpp files
// of trace/ only (not installed), where places far from zero are made relative to one nearby.
#pragma once

#include "sdfgrid/core/simd.h"

namespace sdfgrid::SDFGRID_ISA {

// Sixteen doubles in two halves: compilers split no wider vector well.
typedef double D8 __attribute__((vector_size(64)));
typedef std::int64_t L8 __attribute__((vector_size(64)));
typedef float F8 __attribute__((vector_size(32)));
typedef std::int32_t I8 __attribute__((vector_size(32)));
struct D16 {
  D8 half[2];
};

template <class F>
inline D16 each_half(F f) {
  return {{f(0), f(1)}};
}
inline D8 splat8(double v) { return D8{} + v; }
inline D16 splat16(double v) { return {{splat8(v), splat8(v)}}; }
inline D16 load16(const double* p) {
  D16 v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
inline void store16(double* p, const D16& v) { __builtin_memcpy(p, &v, sizeof v); }
inline D16 operator+(const D16& a, const D16& b) {
  return each_half([&](int h) { return a.half[h] + b.half[h]; });
}
inline D16 operator-(const D16& a, const D16& b) {
  return each_half([&](int h) { return a.half[h] - b.half[h]; });
}
inline D16 operator*(const D16& a, const D16& b) {
  return each_half([&](int h) { return a.half[h] * b.half[h]; });
}
inline D16 operator/(const D16& a, const D16& b) {
  return each_half([&](int h) { return a.half[h] / b.half[h]; });
}
inline D16 min(const D16& a, const D16& b) {
  return each_half([&](int h) { return a.half[h] < b.half[h] ? a.half[h] : b.half[h]; });
}
inline D16 max(const D16& a, const D16& b) {
  return each_half([&](int h) { return a.half[h] > b.half[h] ? a.half[h] : b.half[h]; });
}
inline D16 sqrt(const D16& a) {
#if defined(__AVX512F__)
  return each_half([&](int h) { return (D8)_mm512_sqrt_pd((__m512d)a.half[h]); });
#else
  D16 r;
  for (int h = 0; h < 2; ++h) {
    for (int i = 0; i < 8; ++i) r.half[h][i] = __builtin_sqrt(a.half[h][i]);
  }
  return r;
#endif
}
// Two halves as one: in registers where the machine has such wide ones, for a load of what two
// stores have just written waits for both.
template <class Whole, class Half>
inline Whole joined(const Half& low, const Half& high) {
#if defined(__AVX512F__)
  const __m512 wide = _mm512_castps256_ps512((__m256)low);
  return (Whole)_mm512_insertf32x8(wide, (__m256)high, 1);
#else
  Whole r;
  __builtin_memcpy(&r, &low, sizeof low);
  __builtin_memcpy(reinterpret_cast<char*>(&r) + sizeof low, &high, sizeof high);
  return r;
#endif
}
// Towards zero.
inline I16 to_int(const D16& a) {
  return joined<I16>(__builtin_convertvector(a.half[0], I8),
                     __builtin_convertvector(a.half[1], I8));
}
inline F16 to_float(const D16& a) {
  return joined<F16>(__builtin_convertvector(a.half[0], F8),
                     __builtin_convertvector(a.half[1], F8));
}
template <class Half, class Whole>
inline D16 to_double(const Whole& a) {
  return each_half([&](int h) {
    Half part;
    __builtin_memcpy(&part, reinterpret_cast<const char*>(&a) + h * sizeof part, sizeof part);
    return __builtin_convertvector(part, D8);
  });
}
inline D16 to_double(F16 a) { return to_double<F8>(a); }
inline D16 to_double(I16 a) { return to_double<I8>(a); }

}  // namespace sdfgrid::SDFGRID_ISA
