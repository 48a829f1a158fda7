// trace/simd_double.h: sixteen doubles beside the floats of core/simd.h, for the *_kernel.cpp files
// of trace/ only (not installed), where places far from zero are made relative to one nearby.
#pragma once

#include "sdfgrid/core/simd.h"

namespace sdfgrid::SDFGRID_ISA {

// Sixteen doubles in parts of the machine's own width, as F16 is, and what fills half of one such.
#if defined(__AVX512F__)
inline constexpr int kDoubleBytes = 64;
#else
inline constexpr int kDoubleBytes = kPartBytes;
#endif
inline constexpr int kDoubleParts = 128 / kDoubleBytes;
inline constexpr int kPartLanes = kDoubleBytes / 8;
using DPart = double __attribute__((vector_size(kDoubleBytes)));
using FHalf = float __attribute__((vector_size(kDoubleBytes / 2)));
using IHalf = std::int32_t __attribute__((vector_size(kDoubleBytes / 2)));
struct alignas(64) D16 {
  DPart part[kDoubleParts];
};

template <class F>
inline D16 each_part(F f) {
  D16 r;
  for (int i = 0; i < kDoubleParts; ++i) r.part[i] = f(i);
  return r;
}
inline DPart splat_part(double v) { return DPart{} + v; }
inline D16 splat16(double v) {
  return each_part([&](int) { return splat_part(v); });
}
inline D16 load16(const double* p) {
  return each_part([&](int i) {
    DPart v;
    __builtin_memcpy(&v, p + static_cast<long>(i) * kPartLanes, sizeof v);
    return v;
  });
}
inline void store16(double* p, const D16& v) {
  for (int i = 0; i < kDoubleParts; ++i) {
    __builtin_memcpy(p + static_cast<long>(i) * kPartLanes, &v.part[i], sizeof v.part[i]);
  }
}
inline D16 operator+(const D16& a, const D16& b) {
  return each_part([&](int i) { return a.part[i] + b.part[i]; });
}
inline D16 operator-(const D16& a, const D16& b) {
  return each_part([&](int i) { return a.part[i] - b.part[i]; });
}
inline D16 operator*(const D16& a, const D16& b) {
  return each_part([&](int i) { return a.part[i] * b.part[i]; });
}
inline D16 operator/(const D16& a, const D16& b) {
  return each_part([&](int i) { return a.part[i] / b.part[i]; });
}
inline DPart min(const DPart& a, const DPart& b) { return a < b ? a : b; }
inline DPart max(const DPart& a, const DPart& b) { return a > b ? a : b; }
inline D16 min(const D16& a, const D16& b) {
  return each_part([&](int i) { return min(a.part[i], b.part[i]); });
}
inline D16 max(const D16& a, const D16& b) {
  return each_part([&](int i) { return max(a.part[i], b.part[i]); });
}
inline D16 sqrt(const D16& a) {
  return each_part([&](int i) {
#if defined(__AVX512F__)
    return (DPart)_mm512_sqrt_pd((__m512d)a.part[i]);
#elif defined(__AVX2__)
    return (DPart)_mm256_sqrt_pd((__m256d)a.part[i]);
#else
    DPart r;
    for (int k = 0; k < kPartLanes; ++k) r[k] = __builtin_sqrt(a.part[i][k]);
    return r;
#endif
  });
}

// The inverse of a, and of its root (a > 0), in full precision. The machine's own division and root
// take 16 to 31 cycles a part with AVX-512, an estimate of 14 bits and two steps of Newton's method
// a few.
inline D16 inverse(const D16& a) {
#if defined(__AVX512F__)
  return each_part([&](int i) {
    const auto r = (DPart)_mm512_rcp14_pd((__m512d)a.part[i]);
    const DPart s = r + r * (1 - a.part[i] * r);
    return s + s * (1 - a.part[i] * s);
  });
#else
  return splat16(1) / a;
#endif
}
inline D16 inverse_root(const D16& a) {
#if defined(__AVX512F__)
  return each_part([&](int i) {
    const DPart half = 0.5 * a.part[i];
    const auto r = (DPart)_mm512_rsqrt14_pd((__m512d)a.part[i]);
    const DPart s = r + r * (0.5 - half * r * r);
    return s + s * (0.5 - half * s * s);
  });
#else
  return splat16(1) / sqrt(a);
#endif
}

// Two halves as one, in registers: a load of what two stores have just written waits for both.
#if defined(__AVX512F__)
inline F16 joined(FHalf low, FHalf high) {
  const __m512 wide = _mm512_castps256_ps512((__m256)low);
  return (F16)_mm512_insertf32x8(wide, (__m256)high, 1);
}
inline I16 joined(IHalf low, IHalf high) { return (I16)joined((FHalf)low, (FHalf)high); }
template <class Half, class Whole>
inline Half half_of(const Whole& a, int i) {
  return (Half)(i == 0 ? _mm512_castps512_ps256((__m512)a) : _mm512_extractf32x8_ps((__m512)a, 1));
}
#else
template <class Whole, class Half>
inline Whole joined_part(const Half& low, const Half& high) {
#if defined(__AVX2__)
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
#else
  return __builtin_shufflevector(low, high, 0, 1, 2, 3);
#endif
}
template <class Half, class Whole>
inline Half half_of(const Whole& a, int i) {
  const auto whole = a.part[i / 2];
#if defined(__AVX2__)
  return i % 2 == 0 ? __builtin_shufflevector(whole, whole, 0, 1, 2, 3)
                    : __builtin_shufflevector(whole, whole, 4, 5, 6, 7);
#else
  return i % 2 == 0 ? __builtin_shufflevector(whole, whole, 0, 1)
                    : __builtin_shufflevector(whole, whole, 2, 3);
#endif
}
#endif

template <class Whole, class Half>
inline Whole converted(const D16& a) {
#if defined(__AVX512F__)
  return joined(__builtin_convertvector(a.part[0], Half), __builtin_convertvector(a.part[1], Half));
#else
  Whole r;
  for (int i = 0; i < kParts; ++i) {
    const Half low = __builtin_convertvector(a.part[2 * i], Half);
    const Half high = __builtin_convertvector(a.part[2 * i + 1], Half);
    r.part[i] = joined_part<decltype(+r.part[i])>(low, high);
  }
  return r;
#endif
}
// Towards zero.
inline I16 to_int(const D16& a) { return converted<I16, IHalf>(a); }
inline F16 to_float(const D16& a) { return converted<F16, FHalf>(a); }
inline D16 to_double(const F16& a) {
  return each_part([&](int i) { return __builtin_convertvector(half_of<FHalf>(a, i), DPart); });
}
inline D16 to_double(const I16& a) {
  return each_part([&](int i) { return __builtin_convertvector(half_of<IHalf>(a, i), DPart); });
}

}  // namespace sdfgrid::SDFGRID_ISA
