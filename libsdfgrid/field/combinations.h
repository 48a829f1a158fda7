// field/combinations.h: ops that make one solid of several (internal to field/). keep() says which
// operand is the whole result over a box, so that pruning may drop the other; surface_of_first()
// whose surface a point belongs to, of which it may ask; bounds() where the result is below a
// level, from where the operands are below child_level(level). What joins many nodes says reach():
// an operand that is larger than the other by so much changes nothing. What takes nodes away from
// the first says kRest: the word of the op that joins those.
#pragma once

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/field/interval.h"
#include "sdfgrid/field/ops.h"
#include "sdfgrid/field/parameters.h"

namespace sdfgrid::ops {

enum class Keep { both, first, second };

// The boxes of two solids, as far as combinations need them; an axis without end is infinite.
inline Box both_boxes(const Box& a, const Box& b) {
  if (a.empty() || b.empty()) return a.empty() ? b : a;
  return {
      glm::dvec3(std::fmin(a.lo.x, b.lo.x), std::fmin(a.lo.y, b.lo.y), std::fmin(a.lo.z, b.lo.z)),
      glm::dvec3(std::fmax(a.hi.x, b.hi.x), std::fmax(a.hi.y, b.hi.y), std::fmax(a.hi.z, b.hi.z))};
}
inline Box common_box(const Box& a, const Box& b) {
  const Box r{
      glm::dvec3(std::fmax(a.lo.x, b.lo.x), std::fmax(a.lo.y, b.lo.y), std::fmax(a.lo.z, b.lo.z)),
      glm::dvec3(std::fmin(a.hi.x, b.hi.x), std::fmin(a.hi.y, b.hi.y), std::fmin(a.hi.z, b.hi.z))};
  return r.empty() ? Box{} : r;
}

struct Union {
  static constexpr OpInfo info = {"union",
                                  OpRole::combination,
                                  OpGuarantee::exact_outside,
                                  "All that is in any of the nodes.",
                                  "union: [{sphere: {radius: 1}}, {box: {size: [3, 1, 0.6]}}]",
                                  ""};
  static constexpr bool kConvex = true;

  template <class T>
  T combine(const T& a, const T& b, const Point<T>&) const {
    return min(a, b);
  }
  Keep keep(const Interval& a, const Interval& b) const {
    return a.hi < b.lo ? Keep::first : (b.hi < a.lo ? Keep::second : Keep::both);
  }
  double reach() const { return 0; }
  bool surface_of_first(double a, double b) const { return a <= b; }
  Box bounds(const Box& a, const Box& b) const { return both_boxes(a, b); }
};

struct Intersection {
  static constexpr OpInfo info = {
      "intersection",
      OpRole::combination,
      OpGuarantee::exact_inside,
      "What is in all of the nodes.",
      "intersection: [{sphere: {radius: 1}}, {box: {size: [1.7, 1.2, 3]}}]",
      ""};
  static constexpr bool kTakesAway = true;
  static constexpr bool kConvex = true;

  template <class T>
  T combine(const T& a, const T& b, const Point<T>&) const {
    return max(a, b);
  }
  Keep keep(const Interval& a, const Interval& b) const {
    return a.lo > b.hi ? Keep::first : (b.lo > a.hi ? Keep::second : Keep::both);
  }
  bool surface_of_first(double a, double b) const { return a >= b; }
  Box bounds(const Box& a, const Box& b) const { return common_box(a, b); }
};

struct Difference {
  static constexpr OpInfo info = {
      "difference",
      OpRole::combination,
      OpGuarantee::exact_inside,
      "The first node without all the others.",
      "difference: [{box: {size: [1.6, 1.6, 1.6]}}, {sphere: {radius: 1}}]",
      ""};
  static constexpr bool kTakesAway = true;
  static constexpr bool kConvex = true;
  static constexpr bool kTurnsLast = true;
  static constexpr const char* kRest = "union";

  template <class T>
  T combine(const T& a, const T& b, const Point<T>&) const {
    return max(a, -b);
  }
  Keep keep(const Interval& a, const Interval& b) const {
    return a.lo > -b.lo ? Keep::first : Keep::both;
  }
  bool surface_of_first(double a, double b) const { return a >= -b; }
  Box bounds(const Box& a, const Box&) const { return a; }
};

// The quadratic polynomial blend: with h = 1 - |a - b| / k where that is positive, min(a, b) less
// k h^2 / 4. Its derivatives by a and b are positive and sum to 1, so it is 1-Lipschitz.
template <class T>
inline T smooth_min(const T& a, const T& b, float k) {
  const T h = positive(k - abs(a - b));
  return min(a, b) - square(h) * (0.25F / k);
}

struct SmoothUnion {
  static constexpr OpInfo info = {
      "smooth_union",
      OpRole::combination,
      OpGuarantee::bound,
      "A union with a fillet wherever two nodes' distances differ by less than k. More than two "
      "nodes are joined in pairs, halves of the list first: where three fillets meet their order "
      "matters a little. Nest it to say which are joined first; exponential_union has no order.",
      "smooth_union: {k: 0.5, of: [{box: {size: [2, 2, 0.4]}}, {sphere: {radius: 0.7}}]}",
      "quadratic polynomial smooth minimum"};
  static constexpr Parameter parameters[] = {size("k", 0.1, "width of the blend")};
  static constexpr bool kConvex = true;
  float k;

  template <class T>
  T combine(const T& a, const T& b, const Point<T>&) const {
    return smooth_min(a, b, k);
  }
  // Where the distances differ by k or more the blend adds exactly 0.
  double reach() const { return k; }
  Keep keep(const Interval& a, const Interval& b) const {
    return (b - a).lo >= k ? Keep::first : ((a - b).lo >= k ? Keep::second : Keep::both);
  }
  bool surface_of_first(double a, double b) const { return a <= b; }
  Levels looks_at(const Levels& own) const { return own.wider(k); }
  double child_level(double level) const { return level + 0.25 * k; }
  Box bounds(const Box& a, const Box& b) const { return both_boxes(a, b); }
};

struct SmoothIntersection {
  static constexpr OpInfo info = {
      "smooth_intersection",
      OpRole::combination,
      OpGuarantee::bound,
      "An intersection with its edges rounded where the distances differ by less than k. Where "
      "more "
      "than two nodes meet their order matters a little, as in smooth_union; "
      "exponential_intersection has no order.",
      "smooth_intersection: {k: 0.3, of: [{box: {size: [1.7, 1.7, 1.7]}}, {sphere: {radius: 1}}]}",
      "quadratic polynomial smooth maximum"};
  static constexpr bool kTakesAway = true;
  static constexpr Parameter parameters[] = {size("k", 0.1, "width of the rounding")};
  static constexpr bool kConvex = true;
  float k;

  template <class T>
  T combine(const T& a, const T& b, const Point<T>&) const {
    return -smooth_min(-a, -b, k);
  }
  Keep keep(const Interval& a, const Interval& b) const {
    return (a - b).lo >= k ? Keep::first : ((b - a).lo >= k ? Keep::second : Keep::both);
  }
  bool surface_of_first(double a, double b) const { return a >= b; }
  Levels looks_at(const Levels& own) const { return own.wider(k); }
  Box bounds(const Box& a, const Box& b) const { return common_box(a, b); }
};

struct SmoothDifference {
  static constexpr OpInfo info = {
      "smooth_difference",
      OpRole::combination,
      OpGuarantee::bound,
      "The first node without the others, the new edges rounded. The others are joined by "
      "smooth_union; exponential_difference has no order.",
      "smooth_difference: {k: 0.3, of: [{box: {size: [1.6, 1.6, 1.6]}}, {sphere: {radius: 0.9}}]}",
      "quadratic polynomial smooth maximum"};
  static constexpr bool kTakesAway = true;
  static constexpr Parameter parameters[] = {size("k", 0.1, "width of the rounding")};
  static constexpr bool kConvex = true;
  static constexpr bool kTurnsLast = true;
  static constexpr const char* kRest = "smooth_union";
  float k;

  template <class T>
  T combine(const T& a, const T& b, const Point<T>&) const {
    return -smooth_min(-a, b, k);
  }
  Keep keep(const Interval& a, const Interval& b) const {
    return (a + b).lo >= k ? Keep::first : Keep::both;
  }
  bool surface_of_first(double a, double b) const { return a >= -b; }
  Levels looks_at(const Levels& own) const { return own.wider(k); }
  Box bounds(const Box& a, const Box&) const { return a; }
};

using Combinations =
    OpList<Union, Intersection, Difference, SmoothUnion, SmoothIntersection, SmoothDifference>;

}  // namespace sdfgrid::ops
