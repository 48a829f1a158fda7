// field/region.h: the op that the library wraps around what is only bounded over a region (internal
// to field/).
#pragma once

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/field/interval.h"
#include "sdfgrid/field/ops.h"
#include "sdfgrid/field/parameters.h"

namespace sdfgrid::ops {

// A node whose gradient is at most 1 / scale over a box becomes a distance bound everywhere. Inside
// the box its value is scaled, and the solid ends at the box. A point outside is clamped to the
// box: a solid in a convex box is at least sqrt(a^2 + g^2) away, a the distance to the box, g that
// from the clamped point; and as the two have orthogonal gradients, the slope of that is at most 1.
struct Region {
  static constexpr OpInfo info = {"region", OpRole::domain, OpGuarantee::bound, "", "", "", false};
  static constexpr Parameter parameters[] = {position("center", 0, 0, 0, ""),
                                             sizes("half", 1, "half its edges"),
                                             number("scale", 1, 0, kAny, "1 / gradient")};
  static constexpr bool kLeaves = true;
  static constexpr bool kDerivatives = true;
  float center[3], half[3];
  float scale;

  template <class T>
  Point<T> inside(const Point<T>& p) const {
    return {clamp(p.x, center[0] - half[0], center[0] + half[0]),
            clamp(p.y, center[1] - half[1], center[1] + half[1]),
            clamp(p.z, center[2] - half[2], center[2] + half[2])};
  }
  template <class T>
  T value(const T& d, const Point<T>& p) const {
    const T x = abs(p.x - center[0]) - half[0];
    const T y = abs(p.y - center[1]) - half[1];
    const T z = abs(p.z - center[2]) - half[2];
    const T g = d * scale;
    const T depth = max(x, max(y, z));
    return select(depth > T(0.0F),
                  length(length(positive(x), positive(y), positive(z)), positive(g)),
                  max(g, depth));
  }
  // Deep inside, where the node's own values are larger than the depth: then pruning drops it.
  bool idle(const Interval& d, const Point<Interval>& p) const {
    return scale == 1 && depth_in(p).hi < std::fmin(d.lo, 0.0);
  }
  double stretch(const Point<Interval>&) const { return 1; }
  // The slope of value() over the box p, where that of d is `slope`. The distance to the region has
  // slope 1, and the node times `scale` nowhere more.
  double slope(const Interval& d, double slope, const Point<Interval>& p) const {
    const Interval depth = depth_in(p);
    const bool deep = depth.hi < 0 && (d * Interval(scale)).lo > depth.hi;
    return deep ? std::fmin(slope * scale, 1.0) : 1;
  }
  // What value() calls depth, over a box.
  Interval depth_in(const Point<Interval>& p) const {
    return max(
        abs(p.x - center[0]) - Interval(half[0]),
        max(abs(p.y - center[1]) - Interval(half[1]), abs(p.z - center[2]) - Interval(half[2])));
  }
  double child_level(double level) const { return level / scale; }
  Levels looks_at(const Levels& own) const { return own.scaled(1 / static_cast<double>(scale)); }
  Box bounds(const Box& a, double level) const {
    const glm::dvec3 c(center[0], center[1], center[2]);
    const glm::dvec3 h(half[0], half[1], half[2]);
    const double grow = std::fmax(level, 0.0);
    Box r{c - h - grow, c + h + grow};
    if (level > 0) return r;
    for (int i = 0; i < 3; ++i) {
      r.lo[i] = std::fmax(r.lo[i], a.lo[i]);
      r.hi[i] = std::fmin(r.hi[i], a.hi[i]);
    }
    return r.empty() ? Box{} : r;
  }
};

}  // namespace sdfgrid::ops
