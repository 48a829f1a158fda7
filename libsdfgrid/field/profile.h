// field/profile.h: the signed distance to a plane figure whose border is a chain of circular arcs,
// once for all number types (internal to field/). Solids of revolution and extruded ones come from
// it.
#pragma once

#include <algorithm>

#include "sdfgrid/field/dual.h"
#include "sdfgrid/field/interval.h"

namespace sdfgrid::ops {

// One arc of at most half a circle, or a segment, in the plane of u and r; the figure lies to its
// right. C is the type of its coefficients: text has names for them.
template <class C>
struct ProfileArc {
  static constexpr int kFloats = 11;
  C a[2], along[2];    // where it begins, and its direction there
  C bend;              // 1 / radius, positive to the left; 0: a segment
  C b[2], leaving[2];  // where it ends, and its direction there
  C outward[2];        // of the corner at b: between the normals on both sides of it

  // Whether the nearest point of the whole circle is on the arc.
  template <class T>
  auto faces(const T& u, const T& r) const {
    return ((u - a[0]) * along[0] + (r - a[1]) * along[1] >= T(0.0F)) &
           ((u - b[0]) * leaving[0] + (r - b[1]) * leaving[1] <= T(0.0F));
  }
  // The distance to the whole circle, negative to the right, in the form that becomes a line's
  // where the radius is infinite.
  template <class T>
  T to_circle(const T& u, const T& r) const {
    const T x = u - a[0];
    const T y = r - a[1];
    const T s = (y * along[0] - x * along[1]) * 2.0F - (square(x) + square(y)) * bend;
    return s / (sqrt(positive(T(1.0F) - s * bend)) + 1.0F);
  }
  // To the end; the beginning is the end of another arc.
  template <class T>
  T end_square(const T& u, const T& r) const {
    return square(u - b[0]) + square(r - b[1]);
  }
  // Negative where a point whose nearest is the end is in the figure.
  template <class T>
  T end_side(const T& u, const T& r) const {
    return (u - b[0]) * outward[0] + (r - b[1]) * outward[1];
  }

  // Whether it is straight above the point. Only graphs, from left to right, and floors, from right
  // to left, are above something.
  template <class T>
  auto above(const T& u, const T& r) const {
    const T x = u - a[0];
    const T w = square(x) * bend + x * along[1] * 2.0F;
    const T root = sqrt(positive(T(along[0]) * along[0] - w * bend));
    const T height = w / select(T(along[0]) < T(0.0F), T(along[0]) - root, root + along[0]);
    const auto here = ((u >= a[0]) & (u < b[0])) | ((u >= b[0]) & (u < a[0]));
    return here & (r - a[1] < height);
  }
};

// The arcs in their order, and a complete binary tree of boxes over them, `root` being node 1:
// leaf i holds the kProfileLeaf arcs from kProfileLeaf * i.
struct Profile {
  const float* boxes;  // lo u, lo r, hi u, hi r of each node
  const float* arcs;
  int count;   // of arcs
  int leaves;  // a power of two
};
inline constexpr int kProfileLeaf = 4;
inline constexpr int kProfileBox = 4;        // floats
inline constexpr float kProfileTie = 4e-6F;  // squares that differ by less are as good as equal
inline constexpr float kProfileFar = 1e36F;  // the square of more than any distance

inline bool any(bool mask) { return mask; }
inline double first_of(double v) { return v; }

template <class T>
T box_square(const Profile& profile, int node, const T& u, const T& r) {
  const float* box = profile.boxes + kProfileBox * node;
  const T x = positive(max(T(box[0]) - u, u - box[2]));
  const T y = positive(max(T(box[1]) - r, r - box[3]));
  return square(x) + square(y);
}

// Calls take(i) for all arcs whose squared distance may be as little as `best`, which take() makes
// less. Of lanes all arcs that one of them needs: boxes are larger by more than what is rounded, so
// that this changes no other.
template <class T, class Take>
void take_near_arcs(const Profile& profile, const T& u, const T& r, const T& best,
                    const Take& take) {
  struct Waiting {
    int node;
    T square;
  };
  constexpr float kSlack = 1 + 2 * kProfileTie;
  Waiting waiting[32];
  int count = 0;
  waiting[count++] = {1, box_square(profile, 1, u, r)};
  while (count > 0) {
    const Waiting at = waiting[--count];
    if (!any(at.square <= best * kSlack)) continue;
    if (at.node < profile.leaves) {
      const int left = 2 * at.node;
      const Waiting halves[2] = {{left, box_square(profile, left, u, r)},
                                 {left + 1, box_square(profile, left + 1, u, r)}};
      const int near = first_of(halves[1].square) < first_of(halves[0].square) ? 1 : 0;
      waiting[count++] = halves[1 - near];
      waiting[count++] = halves[near];
      continue;
    }
    const int begin = (at.node - profile.leaves) * kProfileLeaf;
    for (int i = begin; i < begin + kProfileLeaf && i < profile.count; ++i) take(i);
  }
}

template <class T>
ProfileArc<float> profile_arc(const Profile& profile, int i) {
  ProfileArc<float> arc;
  __builtin_memcpy(&arc, profile.arcs + ProfileArc<float>::kFloats * i, sizeof arc);
  return arc;
}
// With directions that are of length 1 in double, too.
inline ProfileArc<double> exact_arc(const Profile& profile, int i) {
  const float* from = profile.arcs + ProfileArc<float>::kFloats * i;
  ProfileArc<double> arc;
  std::copy(from, from + ProfileArc<float>::kFloats, reinterpret_cast<double*>(&arc));
  for (double* direction : {arc.along, arc.leaving}) {
    const double l = std::hypot(direction[0], direction[1]);
    direction[0] /= l;
    direction[1] /= l;
  }
  return arc;
}

// Which of the points that are asked for are in the figure: those below an odd number of arcs; of
// the rest some.
template <class T, class M>
M in_profile(const Profile& profile, const M& asked, const T& u, const T& r) {
  int waiting[32];
  int count = 0;
  waiting[count++] = 1;
  M inside = u < u;  // none
  while (count > 0) {
    const int node = waiting[--count];
    const float* box = profile.boxes + kProfileBox * node;
    const M in_column = asked & (u >= T(box[0])) & (u <= T(box[2])) & (r <= T(box[3]));
    if (!any(in_column)) continue;
    if (node < profile.leaves) {
      waiting[count++] = 2 * node;
      waiting[count++] = 2 * node + 1;
      continue;
    }
    const int begin = (node - profile.leaves) * kProfileLeaf;
    for (int i = begin; i < begin + kProfileLeaf && i < profile.count; ++i) {
      const M above = profile_arc<T>(profile, i).above(u, r);
      inside = (inside & !above) | (above & !inside);
    }
  }
  return inside;
}

// Of doubles and lanes. The nearest arc knows the side, but where thin parts of the figure or gaps
// have two as near, and the point is between the one and beyond the other.
template <class T>
T searched_distance(const Profile& profile, const T& u, const T& r) {
  T outside(kProfileFar);
  T inside(kProfileFar);
  T best(kProfileFar);
  take_near_arcs(profile, u, r, best, [&](int i) {
    const auto arc = profile_arc<T>(profile, i);
    T nearest = arc.end_square(u, r);
    T side = arc.end_side(u, r);
    const auto faces = arc.faces(u, r);
    if (any(faces)) {
      const T d = arc.to_circle(u, r);
      nearest = select(faces, square(d), nearest);
      side = select(faces, d, side);
    }
    outside = min(outside, select(side < T(0.0F), T(kProfileFar), nearest));
    inside = min(inside, select(side < T(0.0F), nearest, T(kProfileFar)));
    best = min(outside, inside);
  });
  const auto tied = abs(outside - inside) <= best * kProfileTie;
  auto within = inside < outside;
  if (any(tied)) within = (within & !tied) | (tied & in_profile(profile, tied, u, r));
  const T d = sqrt(best);
  return select(within, -d, d);
}

// Lanes and text have their own.
inline double profile_distance(const Profile& profile, double u, double r) {
  return searched_distance(profile, u, r);
}

// By the nearest arc's own formula.
template <class T, int N>
Dual<T, N> profile_distance(const Profile& profile, const Dual<T, N>& u, const Dual<T, N>& r) {
  const double value = profile_distance(profile, u.v, r.v);
  double best = square(value) * (1 + static_cast<double>(kProfileTie)) + 1e-30;
  int nearest = 0;
  take_near_arcs(profile, u.v, r.v, best, [&](int i) {
    const auto arc = profile_arc<double>(profile, i);
    const double square_d =
        arc.faces(u.v, r.v) ? square(arc.to_circle(u.v, r.v)) : arc.end_square(u.v, r.v);
    if (square_d >= best) return;
    best = square_d;
    nearest = i;
  });
  const ProfileArc<double> arc = exact_arc(profile, nearest);
  const Dual<T, N> d =
      arc.faces(u.v, r.v) ? arc.to_circle(u, r) : length(u - arc.b[0], r - arc.b[1]);
  return (d.v < 0) == (value < 0) ? d : -d;
}

// As a distance from the middle.
inline Interval profile_distance(const Profile& profile, const Interval& u, const Interval& r) {
  const double half = std::hypot(0.5 * (u.hi - u.lo), 0.5 * (r.hi - r.lo));
  if (!(half < kInfinity)) return everything();
  const double d = profile_distance(profile, 0.5 * (u.lo + u.hi), 0.5 * (r.lo + r.hi));
  const double slack = (magnitude(u) + magnitude(r) + std::fabs(d)) * 4 * kFloatSlack;
  return {d - half - slack, d + half + slack};
}

}  // namespace sdfgrid::ops
