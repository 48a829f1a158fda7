// field/blends.h: softer and rarer combinations: exponential and p-norm unions, intersections and
// differences, superelliptic blends, morphs, composition over a partition of space (internal to
// field/).
#pragma once

#include "sdfgrid/field/combinations.h"

namespace sdfgrid {
class Field;
}

namespace sdfgrid::ops {

// The exponential smooth minimum -k log(e^(-a/k) + e^(-b/k)), without overflow. Its derivatives by
// a and b are positive and sum to 1, so it is 1-Lipschitz. Where the distances differ by 20 k the
// blend is below half a unit in the last place of 1, and adds exactly 0.
template <class T>
inline T exponential_min(const T& a, const T& b, float k) {
  return min(a, b) - log(T(1.0F) + exp(abs(a - b) * (-1 / k))) * k;
}
inline constexpr double kExponentialReach = 20;  // times k
// Farther apart than four times as much as it moves the surface by at most, a sixteenth of that is
// left.
inline constexpr double kExponentialLook = 4 * 0.6931472;  // times k

struct ExponentialUnion {
  static constexpr OpInfo info = {
      "exponential_union",
      OpRole::combination,
      OpGuarantee::bound,
      "A union blended everywhere, the less the farther the distances are apart: -k log sum "
      "e^(-d/k). The order of the nodes does not matter.",
      "exponential_union: {k: 0.15, of: [{box: {size: [2, 2, 0.4]}}, {sphere: {radius: 0.7}}]}",
      "its derivatives by the nodes are positive and sum to 1"};
  static constexpr Parameter parameters[] = {size("k", 0.05, "width of the blend")};
  static constexpr bool kConvex = true;
  float k;

  template <class T>
  T combine(const T& a, const T& b, const Point<T>&) const {
    return exponential_min(a, b, k);
  }
  double reach() const { return kExponentialReach * k; }
  Keep keep(const Interval& a, const Interval& b) const {
    return (b - a).lo >= reach() ? Keep::first
                                 : ((a - b).lo >= reach() ? Keep::second : Keep::both);
  }
  bool surface_of_first(double a, double b) const { return a <= b; }
  Levels looks_at(const Levels& own) const { return own.wider(kExponentialLook * k); }
  double child_level(double level) const { return level + 0.6931472 * k; }
  Box bounds(const Box& a, const Box& b) const { return both_boxes(a, b); }
};

struct ExponentialIntersection {
  static constexpr OpInfo info = {
      "exponential_intersection",
      OpRole::combination,
      OpGuarantee::bound,
      "An intersection rounded everywhere, the less the farther the distances are apart: k log sum "
      "e^(d/k). The order of the nodes does not matter.",
      "exponential_intersection: {k: 0.1, of: [{box: {size: [1.7, 1.7, 1.7]}}, {sphere: {radius: "
      "1}}]}",
      "the complement of exponential_union of complements"};
  static constexpr bool kTakesAway = true;
  static constexpr Parameter parameters[] = {size("k", 0.05, "width of the rounding")};
  static constexpr bool kConvex = true;
  float k;

  template <class T>
  T combine(const T& a, const T& b, const Point<T>&) const {
    return -exponential_min(-a, -b, k);
  }
  Keep keep(const Interval& a, const Interval& b) const {
    const double reach = kExponentialReach * k;
    return (a - b).lo >= reach ? Keep::first : ((b - a).lo >= reach ? Keep::second : Keep::both);
  }
  bool surface_of_first(double a, double b) const { return a >= b; }
  Levels looks_at(const Levels& own) const { return own.wider(kExponentialLook * k); }
  Box bounds(const Box& a, const Box& b) const { return common_box(a, b); }
};

struct ExponentialDifference {
  static constexpr OpInfo info = {
      "exponential_difference",
      OpRole::combination,
      OpGuarantee::bound,
      "The first node without the others, rounded everywhere, the less the farther the distances "
      "are apart. The order of the others does not matter.",
      "exponential_difference: {k: 0.1, of: [{box: {size: [1.6, 1.6, 1.6]}}, {sphere: {radius: "
      "0.9}}]}",
      "exponential_intersection with the complement of the others"};
  static constexpr bool kTakesAway = true;
  static constexpr Parameter parameters[] = {size("k", 0.05, "width of the rounding")};
  static constexpr bool kConvex = true;
  static constexpr bool kTurnsLast = true;
  static constexpr const char* kRest = "exponential_union";
  float k;

  template <class T>
  T combine(const T& a, const T& b, const Point<T>&) const {
    return -exponential_min(-a, b, k);
  }
  Keep keep(const Interval& a, const Interval& b) const {
    return (a + b).lo >= kExponentialReach * k ? Keep::first : Keep::both;
  }
  bool surface_of_first(double a, double b) const { return a >= -b; }
  Levels looks_at(const Levels& own) const { return own.wider(kExponentialLook * k); }
  Box bounds(const Box& a, const Box&) const { return a; }
};

// (a^-p + b^-p)^(-1/p) of two positive numbers, else the lesser. With m its value, its derivatives
// (m/a)^(p+1) and (m/b)^(p+1) are positive and sum to at most (m/a)^p + (m/b)^p = 1.
template <class T>
inline T pnorm_min(const T& a, const T& b, float p) {
  const T least = min(a, b);
  const T most = max(max(a, b), T(1e-12F));
  const T ratio = positive(least) / most;
  return select(least > T(0.0F), least * pow(T(1.0F) + pow(ratio, p), -1 / p), least);
}

// How much farther than to a level it looks at its nodes there.
inline double pnorm_look(double level, double p) {
  return 4 * (std::exp2(1 / p) - 1) * std::fmax(level, 0);
}

struct PNormUnion {
  static constexpr OpInfo info = {
      "pnorm_union",
      OpRole::combination,
      OpGuarantee::bound,
      "A union whose offset surfaces are rounded: (a^-p + b^-p)^(-1/p) outside, the plain union "
      "inside any node. The surface itself is that of the union; offset it to see the blend.",
      "offset: {by: 0.25, of: {pnorm_union: {p: 3, of: [{box: {size: [2, 2, 0.2]}}, {sphere: "
      "{radius: 0.6}}]}}}",
      "Krayer (22), whose sign between the powers is missing; for positive distances only"};
  static constexpr Parameter parameters[] = {number("p", 4, 1, 64, "the larger the sharper")};
  static constexpr bool kConvex = true;
  float p;

  template <class T>
  T combine(const T& a, const T& b, const Point<T>&) const {
    return pnorm_min(a, b, p);
  }
  Keep keep(const Interval& a, const Interval& b) const {
    // Inside, the other node does not matter.
    return a.hi <= 0 && a.hi < b.lo ? Keep::first
                                    : (b.hi <= 0 && b.hi < a.lo ? Keep::second : Keep::both);
  }
  bool surface_of_first(double a, double b) const { return a <= b; }
  double child_level(double level) const {
    return level > 0 ? level * std::pow(2.0, 1.0 / static_cast<double>(p)) : level;
  }
  Levels looks_at(const Levels& own) const { return own.wider(pnorm_look(own.hi, p)); }
  Box bounds(const Box& a, const Box& b) const { return both_boxes(a, b); }
};

struct PNormIntersection {
  static constexpr OpInfo info = {
      "pnorm_intersection",
      OpRole::combination,
      OpGuarantee::bound,
      "An intersection whose inner offset surfaces are rounded: -(|a|^-p + |b|^-p)^(-1/p) inside, "
      "the plain intersection outside any node. The surface itself is that of the intersection; "
      "offset it inwards to see the blend.",
      "offset: {by: -0.2, of: {pnorm_intersection: {p: 3, of: [{box: {size: [2, 2, 2]}}, {sphere: "
      "{radius: 1.3}}]}}}",
      "the complement of pnorm_union of complements"};
  static constexpr bool kTakesAway = true;
  static constexpr Parameter parameters[] = {number("p", 4, 1, 64, "the larger the sharper")};
  static constexpr bool kConvex = true;
  float p;

  template <class T>
  T combine(const T& a, const T& b, const Point<T>&) const {
    return -pnorm_min(-a, -b, p);
  }
  Keep keep(const Interval& a, const Interval& b) const {
    return a.lo >= 0 && a.lo > b.hi ? Keep::first
                                    : (b.lo >= 0 && b.lo > a.hi ? Keep::second : Keep::both);
  }
  bool surface_of_first(double a, double b) const { return a >= b; }
  Levels looks_at(const Levels& own) const { return own.wider(pnorm_look(-own.lo, p)); }
  Box bounds(const Box& a, const Box& b) const { return common_box(a, b); }
};

struct PNormDifference {
  static constexpr OpInfo info = {
      "pnorm_difference",
      OpRole::combination,
      OpGuarantee::bound,
      "The first node without the others, its inner offset surfaces rounded. The surface itself is "
      "that of the difference; offset it inwards to see the blend.",
      "offset: {by: -0.12, of: {pnorm_difference: {p: 3, of: [{box: {size: [2, 2, 2]}}, "
      "{translate: {by: [0, 0, 1], of: {sphere: {radius: 0.7}}}}]}}}",
      "pnorm_intersection with the complement of the others"};
  static constexpr bool kTakesAway = true;
  static constexpr Parameter parameters[] = {number("p", 4, 1, 64, "the larger the sharper")};
  static constexpr bool kConvex = true;
  static constexpr bool kTurnsLast = true;
  static constexpr const char* kRest = "pnorm_union";
  float p;

  template <class T>
  T combine(const T& a, const T& b, const Point<T>&) const {
    return -pnorm_min(-a, b, p);
  }
  Keep keep(const Interval& a, const Interval& b) const {
    return a.lo >= 0 && a.lo > -b.lo ? Keep::first : Keep::both;
  }
  bool surface_of_first(double a, double b) const { return a >= -b; }
  Levels looks_at(const Levels& own) const { return own.wider(pnorm_look(-own.lo, p)); }
  Box bounds(const Box& a, const Box&) const { return a; }
};

// An op that has kTwo takes two nodes, no more: joined with a third in another order it would be
// another solid.
//
// N = (gA^p + gB^p)^(1/p) with gA = max(0, 1 - a / rA): the solid is where N >= 1. By Hoelder its
// slope is at most K = (rA^-p + rB^-p)^(1/p). A point of the solid has a <= rA (1 - 2^(-1/p)) or
// the same of b: the better bound far away.
struct Blend {
  static constexpr OpInfo info = {
      "blend",
      OpRole::combination,
      OpGuarantee::bound,
      "A superelliptic blend: near both nodes the surface bulges, within a radius of each.",
      "blend: {radii: [0.3, 0.7], power: 2, of: [{box: {size: [2, 2, 0.4]}}, {translate: {by: [0, "
      "0, 0.5], of: {sphere: {radius: 0.5}}}}]}",
      "A. Rockwood 1989; Hart (43) as printed is undefined inside"};
  static constexpr bool kTwo = true;
  static constexpr Parameter parameters[] = {
      {"radii",
       ParameterKind::pair,
       "length",
       {0.3, 0.3, 0},
       kSmall,
       kAny,
       "how far from the first and the second node the blend reaches"},
      number("power", 2, 1, 32, "2 is round, more is tighter")};
  static constexpr bool kConvex = true;
  float radii[2];
  float power;
  float scale;
  float near[2];

  void prepare(Data) {
    // The smaller radius in front of the sum, so that nothing overflows.
    const float smaller = std::fmin(radii[0], radii[1]);
    const float ratio = smaller / std::fmax(radii[0], radii[1]);
    scale = smaller * std::pow(1 + std::pow(ratio, power), -1 / power);
    for (int i = 0; i < 2; ++i) near[i] = radii[i] * (1 - std::pow(2.0F, -1 / power));
  }
  template <class T>
  T combine(const T& a, const T& b, const Point<T>&) const {
    const T g = positive(T(1.0F) - a * (1 / radii[0]));
    const T h = positive(T(1.0F) - b * (1 / radii[1]));
    const T larger = max(max(g, h), T(1e-12F));
    const T n = larger * pow(T(1.0F) + pow(min(g, h) / larger, power), 1 / power);
    return max((T(1.0F) - n) * scale, min(a - near[0], b - near[1]));
  }
  Keep keep(const Interval&, const Interval&) const { return Keep::both; }
  bool surface_of_first(double a, double b) const {
    return a * static_cast<double>(radii[1]) <= b * static_cast<double>(radii[0]);
  }
  double child_level(double level) const { return level + std::fmax(near[0], near[1]); }
  // A node matters up to its radius, and as far inside as g is where N alone makes the value.
  Levels looks_at(const Levels& own) const {
    const double most = std::fmax(radii[0], radii[1]);
    return {std::fmin(own.lo * most / scale, own.lo), std::fmax(most, child_level(own.hi))};
  }
  Box bounds(const Box& a, const Box& b) const { return both_boxes(a, b); }
};

struct Morph {
  static constexpr OpInfo info = {
      "morph",
      OpRole::combination,
      OpGuarantee::bound,
      "Between two nodes: (1 - weight) of the first distance and weight of the second.",
      "morph: {weight: 0.5, of: [{box: {size: [1.6, 1.6, 1.6]}}, {sphere: {radius: 1}}]}",
      "a convex combination of 1-Lipschitz functions"};
  static constexpr bool kTwo = true;
  static constexpr Parameter parameters[] = {number("weight", 0.5, 0, 1, "of the second node")};
  static constexpr bool kConvex = true;
  float weight;

  template <class T>
  T combine(const T& a, const T& b, const Point<T>&) const {
    return a * (1 - weight) + b * weight;
  }
  Keep keep(const Interval&, const Interval&) const { return Keep::both; }
  Levels looks_at(const Levels& own, double apart) const { return own.wider(apart); }
  bool surface_of_first(double, double) const { return weight < 0.5F; }
  // Below a level one of the two must be.
  Box bounds(const Box& a, const Box& b) const { return both_boxes(a, b); }
};

struct SpatialMorph {
  static constexpr OpInfo info = {
      "spatial_morph",
      OpRole::combination,
      OpGuarantee::computed,
      "Changes from the first node at the point `from` to the second at the point `to`.",
      "spatial_morph: {from: [-0.8, 0, 0], to: [0.8, 0, 0], of: [{box: {size: [2, 1, 1]}}, "
      "{capsule: "
      "{from: [-1, 0, 0], to: [1, 0, 0], radius: 0.3}}]}",
      "the weight's slope times the difference of the distances adds to the slope"};
  static constexpr bool kTwo = true;
  static constexpr Parameter parameters[] = {
      position("from", 0, 0, -1, "where the first node is whole"),
      position("to", 0, 0, 1, "where the second is")};
  float from[3], to[3];
  float axis[3];  // (to - from) / |to - from|^2

  void prepare(Data) {
    float squared = 0;
    for (int i = 0; i < 3; ++i) squared += (to[i] - from[i]) * (to[i] - from[i]);
    for (int i = 0; i < 3; ++i) axis[i] = (to[i] - from[i]) / squared;
  }
  template <class T>
  T combine(const T& a, const T& b, const Point<T>& p) const {
    return mix(a, b, clamp(dot(axis, minus(p, from)), 0.0F, 1.0F));
  }
  // The weight w in [0, 1] leaves |da| (1 - w) + |db| w <= 1; its own slope comes on top.
  double slope(const Interval& a, double slope_a, const Interval& b, double slope_b,
               const Point<Interval>& p) const {
    const double own = std::hypot(axis[0], axis[1], axis[2]);
    const Interval t = dot(axis, minus(p, from));
    const bool flat = t.lo >= 1 || t.hi <= 0;
    const double other = flat ? 0 : magnitude(b - a) * own;
    return std::fmax(slope_a, slope_b) + other;
  }
  Keep keep(const Interval&, const Interval&) const { return Keep::both; }
  Levels looks_at(const Levels& own, double apart) const { return own.wider(apart); }
  bool surface_of_first(double, double, const Point<double>& p) const {
    return dot(axis, minus(p, from)) < 0.5;
  }
  Box bounds(const Box& a, const Box& b) const { return both_boxes(a, b); }
};

// With h the signed distance to the plane: the first node where h <= 0, the second elsewhere, and
// what is in both nodes anyway, so that the plane itself is no surface within.
struct Partition {
  static constexpr OpInfo info = {"partition",
                                  OpRole::combination,
                                  OpGuarantee::bound,
                                  "Space cut by a plane: the first node behind it, the second in "
                                  "front of it. Nested, they make "
                                  "any partition into convex parts.",
                                  "partition: {normal: [1, 0.3, 0], distance: 0, of: [{sphere: "
                                  "{radius: 1}}, {box: {size: [1.6, "
                                  "1.2, 1.2]}}]}",
                                  ""};
  static constexpr bool kTwo = true;
  static constexpr Parameter parameters[] = {
      vector("normal", 0, 0, 1, -kAny, kAny, "of the plane; any length but 0", ""),
      length_of("distance", 0, "of the plane from the origin along the normal")};
  float normal[3];
  float offset;

  void prepare(Data) {
    const float l = std::hypot(normal[0], normal[1], normal[2]);
    for (float& n : normal) n /= l;
  }
  template <class T>
  T combine(const T& a, const T& b, const Point<T>& p) const {
    const T h = dot(normal, p) - offset;
    return min(min(max(a, h), max(b, -h)), max(a, b));
  }
  double slope(const Interval&, double slope_a, const Interval&, double slope_b,
               const Point<Interval>&) const {
    return std::fmax(1.0, std::fmax(slope_a, slope_b));
  }
  Keep keep(const Interval&, const Interval&) const { return Keep::both; }
  bool surface_of_first(double a, double b, const Point<double>& p) const {
    const double h = dot(normal, p) - offset;
    return max(a, h) <= max(b, -h);
  }
  Box bounds(const Box& a, const Box& b) const { return both_boxes(a, b); }
};

using Blends = OpList<ExponentialUnion, ExponentialIntersection, ExponentialDifference, PNormUnion,
                      PNormIntersection, PNormDifference, Blend, Morph, SpatialMorph, Partition>;

}  // namespace sdfgrid::ops
