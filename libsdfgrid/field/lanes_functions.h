// field/lanes_functions.h: exp, log, sin, cos, atan2, acos and pow of sixteen floats, for the
// *_kernel.cpp files of field/ only (not installed). Range reduction and a truncated Taylor series;
// within 4 units in the last place for arguments up to 1e4 (tests hold them to the slack that
// interval.h allows).
#pragma once

#include "sdfgrid/field/lanes.h"

namespace sdfgrid::SDFGRID_ISA {

// c[0] + c[1] x + ... by Horner's rule.
template <int N>
inline F16 polynomial(const float (&c)[N], F16 x) {
  F16 r = splat(c[N - 1]);
  for (int i = N - 2; i >= 0; --i) r = fused(r, x, splat(c[i]));
  return r;
}

inline Lanes exp(Lanes a) {
  // e^a = 2^n e^r with |r| <= ln(2) / 2; ln(2) in two parts.
  const F16 x = min(max(a.v, splat(-87.0F)), splat(88.0F));
  const F16 n = whole(fused(x, splat(1.44269504F), splat(0.5F)));
  const F16 r = fused(n, splat(-1.42860677e-6F), fused(n, splat(-0.693145752F), x));
  static constexpr float kSeries[] = {1, 1, 1.0F / 2, 1.0F / 6, 1.0F / 24, 1.0F / 120, 1.0F / 720};
  return polynomial(kSeries, r) * bits_float((to_int(n) + 127) << 23);
}

inline Lanes log(Lanes a) {
  // a = 2^e m, m in [sqrt(1/2), sqrt(2)); log m = 2 atanh((m - 1) / (m + 1)). 0 gives about -87.
  const F16 x = max(a.v, splat(1.17549435e-38F));
  const I16 shifted = float_bits(x) - 0x3f3504f3;
  const F16 e = to_float(shifted >> 23);
  const F16 m = bits_float((shifted & 0x007fffff) + 0x3f3504f3);
  const F16 s = (m - 1.0F) / (m + 1.0F);
  static constexpr float kSeries[] = {2, 2.0F / 3, 2.0F / 5, 2.0F / 7, 2.0F / 9};
  const F16 r = s * polynomial(kSeries, s * s);
  return fused(e, splat(0.693147182F), fused(e, splat(-1.90465433e-9F), r));
}

// sin of a + quarters * pi / 2.
inline Lanes sin_shifted(Lanes a, int quarters) {
  const F16 n = whole(fused(a.v, splat(0.636619772F), splat(0.5F)));
  // pi / 2 in three parts.
  const F16 r = fused(n, splat(-7.54978995e-8F),
                      fused(n, splat(-4.83751297e-4F), fused(n, splat(-1.5703125F), a.v)));
  const F16 q = r * r;
  static constexpr float kSine[] = {1, -1.0F / 6, 1.0F / 120, -1.0F / 5040, 1.0F / 362880};
  static constexpr float kCosine[] = {1,           -1.0F / 2,    1.0F / 24,
                                      -1.0F / 720, 1.0F / 40320, -1.0F / 3628800};
  const I16 k = to_int(n) + quarters;
  const F16 value = select((k & 1) != 0, polynomial(kCosine, q), r * polynomial(kSine, q));
  return select((k & 2) != 0, -value, value);
}
inline Lanes sin(Lanes a) { return sin_shifted(a, 0); }
inline Lanes cos(Lanes a) { return sin_shifted(a, 1); }

inline Lanes atan2(Lanes y, Lanes x) {
  const F16 u = abs(x.v);
  const F16 v = abs(y.v);
  const F16 larger = max(max(u, v), splat(1.17549435e-38F));
  const F16 t = min(u, v) / larger;  // in [0, 1]
  // tan(pi / 8): beyond it about pi / 4.
  const I16 upper = t > 0.414213562F;
  const F16 s = select(upper, (t - 1.0F) / (t + 1.0F), t);
  static constexpr float kSeries[] = {1,          -1.0F / 3, 1.0F / 5,   -1.0F / 7, 1.0F / 9,
                                      -1.0F / 11, 1.0F / 13, -1.0F / 15, 1.0F / 17};
  F16 r = s * polynomial(kSeries, s * s) + select(upper, splat(0.785398163F), splat(0.0F));
  r = select(v > u, 1.57079633F - r, r);
  r = select(x.v < 0.0F, 3.14159265F - r, r);
  return select(y.v < 0.0F, -r, r);
}
inline Lanes acos(Lanes a) {
  const F16 x = min(max(a.v, splat(-1.0F)), splat(1.0F));
  return atan2(Lanes(sqrt((1.0F - x) * (1.0F + x))), Lanes(x));
}
// Of a >= 0; 0 where a = 0.
inline Lanes pow(Lanes a, Lanes b) {
  const Lanes r = exp(log(a) * b);
  return select(a.v > 0.0F, r.v, splat(0.0F));
}

// Of a picture of samples, see texture.h.
template <class Texture>
inline Lanes texel(const Texture& t, Lanes column, Lanes row) {
  // As index_in(): max() gives its second operand where the first is NaN.
  const auto within = [](F16 place, int size) {
    return to_int(min(max(place, splat(0.0F)), splat(static_cast<float>(size - 1))));
  };
  const I16 place = within(row.v, t.height) * t.width + within(column.v, t.width);
  F16 r;
  for (int i = 0; i < kLanes; ++i) r[i] = t.values[place[i]];
  return r;
}

// Of a profile, see profile.h: together where the points are near each other or the arcs few, else
// one by one, for each would make all others look at what is near it alone.
template <class Profile>
inline Lanes profile_distance(const Profile& profile, Lanes u, Lanes r) {
  float lo[2] = {u.v[0], r.v[0]};
  float hi[2] = {u.v[0], r.v[0]};
  for (int i = 1; i < kLanes; ++i) {
    for (int a = 0; a < 2; ++a) {
      const float c = a == 0 ? u.v[i] : r.v[i];
      lo[a] = c < lo[a] ? c : lo[a];
      hi[a] = c > hi[a] ? c : hi[a];
    }
  }
  const float* box = profile.boxes + 4;  // of all
  const float size = box[2] - box[0] + box[3] - box[1];
  constexpr int kFew = 400;
  if (profile.count < kFew || hi[0] - lo[0] + hi[1] - lo[1] < 0.1F * size) {
    return searched_distance(profile, u, r);
  }
  F16 out;
  for (int i = 0; i < kLanes; ++i) {
    out[i] = searched_distance(profile, Lanes(u.v[i]), Lanes(r.v[i])).v[0];
  }
  return out;
}

}  // namespace sdfgrid::SDFGRID_ISA
