// trace/packet_cell.h: the cubic of sixteen rays' cells, and where it becomes negative; for
// packet_kernel.cpp only (not installed). The same mathematics as cubic.h, with the doubt that
// float leaves made explicit: packet_kernel.h says what for.
#pragma once

#include "sdfgrid/core/simd.h"

namespace sdfgrid::SDFGRID_ISA {

struct Cubic {
  F16 c0, c1, c2, c3;
  F16 operator()(F16 s) const { return ((c3 * s + c2) * s + c1) * s + c0; }
  F16 derivative(F16 s) const { return (3.0F * c3 * s + 2.0F * c2) * s + c1; }
};

// The trilinear field along from + s * direction: linear along z, then times y, then times x.
// corners[2 * x + y] are two samples, at z = 0 and 1.
inline Cubic make_cubic(const F16 (&corners)[4][2], const F16 (&from)[3],
                        const F16 (&direction)[3]) {
  F16 e0[4];
  F16 e1[4];
  for (int i = 0; i < 4; ++i) {
    const F16 difference = corners[i][1] - corners[i][0];
    e0[i] = corners[i][0] + from[2] * difference;
    e1[i] = direction[2] * difference;
  }
  F16 q0[2];
  F16 q1[2];
  F16 q2[2];
  for (int i = 0; i < 2; ++i) {
    const F16 d0 = e0[2 * i + 1] - e0[2 * i];
    const F16 d1 = e1[2 * i + 1] - e1[2 * i];
    q0[i] = e0[2 * i] + from[1] * d0;
    q1[i] = e1[2 * i] + from[1] * d1 + direction[1] * d0;
    q2[i] = direction[1] * d1;
  }
  const F16 d0 = q0[1] - q0[0];
  const F16 d1 = q1[1] - q1[0];
  const F16 d2 = q2[1] - q2[0];
  return {q0[0] + from[0] * d0, q1[0] + from[0] * d1 + direction[0] * d0,
          q2[0] + from[0] * d2 + direction[0] * d1, direction[0] * d2};
}

// Where the derivative is zero within (0, length), in order; `length` in place of those that are
// not.
struct Extrema {
  F16 first, second;
};

inline Extrema extrema(const Cubic& cubic, F16 length, I16 wanted) {
  // The derivative's Bernstein coefficients: while they have one sign, it has no zero.
  const F16 b1 = cubic.c1 + cubic.c2 * length;
  const F16 b2 = cubic.derivative(length);
  const F16 lowest = min(min(cubic.c1, b1), b2);
  const F16 highest = max(max(cubic.c1, b1), b2);
  const I16 bent = ~((lowest > 0.0F) | (highest < 0.0F));
  if (!any(wanted & bent)) return {length, length};
  const F16 a = 3.0F * cubic.c3;
  const F16 discriminant = cubic.c2 * cubic.c2 - a * cubic.c1;
  // Without cancellation: the larger zero first, the other from their product. If there is none,
  // the cubic is monotone and split for nothing.
  const F16 root = sqrt(max(discriminant, splat(0.0F)));
  const F16 q = -(cubic.c2 + select(cubic.c2 < 0.0F, -root, root));
  const F16 r1 = q / a;
  const F16 r2 = cubic.c1 / q;
  const F16 s1 = select(bent & (r1 > 0.0F) & (r1 < length), r1, length);
  const F16 s2 = select(bent & (r2 > 0.0F) & (r2 < length), r2, length);
  return {min(s1, s2), max(s1, s2)};
}

// Where a cubic that starts positive first becomes clearly negative in [0, length]: a bracket in
// which it is monotone.
struct Bracket {
  I16 found;
  I16 unsure;
  F16 lo, hi, at_lo, at_hi;
};

inline Bracket first_bracket(const Cubic& cubic, F16 length, float tolerance, I16 wanted) {
  const Extrema at = extrema(cubic, length, wanted);
  const F16 f0 = cubic.c0;
  const F16 f1 = cubic(at.first);
  const F16 f2 = cubic(at.second);
  const F16 f3 = cubic(length);
  const I16 negative1 = f1 < -tolerance;
  const I16 negative2 = f2 < -tolerance;
  const I16 negative3 = f3 < -tolerance;
  Bracket b;
  b.found = negative1 | negative2 | negative3;
  // Near zero, and not clearly beyond it at the next place; written so that a NaN is unsure.
  const I16 touch0 = ~(f0 > tolerance) & ~negative1;
  const I16 touch1 = ~(f1 > tolerance) & (at.first < length) & ~negative1 & ~negative2;
  const I16 touch2 =
      ~(f2 > tolerance) & (at.second < length) & ~negative1 & ~negative2 & ~negative3;
  b.unsure = (f0 < -tolerance) | touch0 | touch1 | touch2;
  b.lo = select(negative1, splat(0.0F), select(negative2, at.first, at.second));
  b.at_lo = select(negative1, f0, select(negative2, f1, f2));
  b.hi = select(negative1, at.first, select(negative2, at.second, length));
  b.at_hi = select(negative1, f1, select(negative2, f2, f3));
  return b;
}

// The root in the brackets of `wanted` lanes: Newton's method from the chord's, kept in the
// bracket. Lanes where it is slow or the field less than `steep` are unsure: there a small error of
// the value moves the root far.
inline F16 refine(const Cubic& cubic, Bracket& b, I16 wanted, float steep) {
  constexpr int kRounds = 24;
  constexpr float kClose = 1e-3F;  // the next step would be about the square of this
  F16 s = b.lo + (b.hi - b.lo) * (b.at_lo / (b.at_lo - b.at_hi));
  s = min(max(s, b.lo), b.hi);
  I16 open = wanted;
  for (int round = 0; round < kRounds && any(open); ++round) {
    const F16 value = cubic(s);
    const F16 slope = cubic.derivative(s);
    b.lo = select(value >= 0.0F, s, b.lo);
    b.hi = select(value >= 0.0F, b.hi, s);
    const F16 newton = s - value / slope;
    const I16 good = (newton >= b.lo) & (newton <= b.hi);
    const F16 next = select(good, newton, 0.5F * (b.lo + b.hi));
    b.unsure |= open & (abs(slope) < steep);
    const I16 done = abs(next - s) <= kClose;
    s = select(open, next, s);
    open &= ~done & ~b.unsure;
  }
  b.unsure |= open;
  return s;
}

}  // namespace sdfgrid::SDFGRID_ISA
