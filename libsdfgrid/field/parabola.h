// field/parabola.h: the distance to an arc of a parabola, once for all number types (internal to
// field/).
#pragma once

#include "sdfgrid/field/number.h"

namespace sdfgrid::ops {

// The arc c(t) = from + 2 b t + d t^2, t in [0, 1]: every quadratic Bezier curve is one. A plain
// struct of floats, part of the ops that hold it.
struct ParabolaArc {
  float from[3], b[3], d[3];
  float curve;  // |d|^2; 0 for a segment

  void set(const double (&points)[3][3]) {
    curve = 0;
    for (int a = 0; a < 3; ++a) {
      from[a] = static_cast<float>(points[0][a]);
      b[a] = static_cast<float>(points[1][a] - points[0][a]);
      d[a] = static_cast<float>(points[0][a] - 2 * points[1][a] + points[2][a]);
      curve += d[a] * d[a];
    }
  }

  template <class T>
  T distance(const Point<T>& p) const {
    const Point<T> q = minus(p, from);
    const float along = b[0] * b[0] + b[1] * b[1] + b[2] * b[2];
    if (curve == 0) return at(q, dot(b, q) * (along > 0 ? 0.5F / along : 0.0F));
    // The nearest point is at a root of c' . (c - p), a cubic: t^3 + 3 k t^2 + l t + m = 0. With
    // x = t + k it is x^3 + u x + v = 0.
    const float inverse = 1 / curve;
    const float k = (b[0] * d[0] + b[1] * d[1] + b[2] * d[2]) * inverse;
    const T l = (2 * along - dot(d, q)) * inverse;
    const T m = -dot(b, q) * inverse;
    const T u = l - 3 * k * k;
    const T v = k * (2 * k * k - l) + m;
    const T discriminant = square(v) * 0.25F + square(u) * u * (1.0F / 27);
    // One root: Cardano, the larger cube root first. Three: by angles; the middle one is farthest.
    const T root = sqrt(positive(discriminant));
    const T larger = pow(abs(v) * 0.5F + root, 1.0F / 3);
    const T one = (larger - u / (max(larger, T(1e-20F)) * 3.0F)) * -sign(v);
    const T w = sqrt(positive(-u) * (1.0F / 3));
    const T ratio = clamp(-v * 0.5F / max(square(w) * w, T(1e-30F)), -1.0F, 1.0F);
    const T angle = acos(ratio) * (1.0F / 3);
    const T first = w * 2.0F * cos(angle);
    const T third = w * 2.0F * cos(angle + 2.0943951F);
    const T three = min(at(q, polished(q, first - k)), at(q, polished(q, third - k)));
    return select(discriminant > T(0.0F), at(q, polished(q, one - k)), three);
  }

 private:
  // c(t) - from.
  template <class T>
  Point<T> point(const T& t) const {
    return {t * (t * d[0] + 2 * b[0]), t * (t * d[1] + 2 * b[1]), t * (t * d[2] + 2 * b[2])};
  }
  template <class T>
  T at(const Point<T>& q, const T& t) const {
    const Point<T> c = point(clamp(t, 0.0F, 1.0F));
    return length(q.x - c.x, q.y - c.y, q.z - c.z);
  }
  // One step of Newton's method on c' . (c - p) itself mends what the closed form cancels.
  template <class T>
  T polished(const Point<T>& q, const T& t) const {
    const Point<T> c = point(t);
    const Point<T> r = {c.x - q.x, c.y - q.y, c.z - q.z};
    const Point<T> h = {t * d[0] + b[0], t * d[1] + b[1], t * d[2] + b[2]};
    const T slope = dot(h, h) * 2.0F + dot(d, r);
    const T least(1e-6F * curve);
    return t - clamp(dot(r, h) / select(abs(slope) > least, slope, T(curve)), -0.1F, 0.1F);
  }
};

}  // namespace sdfgrid::ops
