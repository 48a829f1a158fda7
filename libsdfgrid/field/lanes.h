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

struct Lanes {
  F16 v;

  Lanes() = default;
  Lanes(F16 a) : v(a) {}
  Lanes(float a) : v(splat(a)) {}
};

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
inline Lanes sqrt(Lanes a) { return sqrt(max(a.v, splat(0.0F))); }
inline Lanes floor(Lanes a) { return floor(a.v); }
inline Lanes sign(Lanes a) { return select(a.v < 0.0F, splat(-1.0F), splat(1.0F)); }

}  // namespace sdfgrid::SDFGRID_ISA
