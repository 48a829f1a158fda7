// field/domains.h: ops that move or stretch the space of one node without need of a region
// (internal to field/). `bounds` maps the node's box forward; `stretch` bounds the length to which
// the map that `inside` is can stretch a unit vector over a box.
#pragma once

#include <algorithm>

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/field/interval.h"
#include "sdfgrid/field/ops.h"
#include "sdfgrid/field/parameters.h"
#include "sdfgrid/field/region.h"

namespace sdfgrid::ops {

struct Translate {
  static constexpr OpInfo info = {"translate",
                                  OpRole::domain,
                                  OpGuarantee::exact,
                                  "Moves a node.",
                                  "translate: {by: [0.5, 0, 0], of: {sphere: {radius: 0.5}}}",
                                  ""};
  static constexpr Parameter parameters[] = {position("by", 0, 0, 0, "how far")};
  float by[3];

  template <class T>
  Point<T> inside(const Point<T>& p) const {
    return minus(p, by);
  }
  double stretch(const Point<Interval>&) const { return 1; }
  double similarity() const { return 1; }
  bool changes_nothing() const { return by[0] == 0 && by[1] == 0 && by[2] == 0; }
  Box bounds(const Box& a) const {
    const glm::dvec3 t(by[0], by[1], by[2]);
    return a.empty() ? a : Box{a.lo + t, a.hi + t};
  }
};

// The image of a box under the linear map with the given rows; axes without end stay so wherever
// they have a part.
inline Box mapped_box(const Box& a, const double rows[9]) {
  if (a.empty()) return a;
  Box r{glm::dvec3(0), glm::dvec3(0)};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double u = product(rows[3 * i + j], a.lo[j]);
      const double v = product(rows[3 * i + j], a.hi[j]);
      r.lo[i] += std::fmin(u, v);
      r.hi[i] += std::fmax(u, v);
    }
  }
  return r;
}

struct Rotate {
  static constexpr OpInfo info = {"rotate",
                                  OpRole::domain,
                                  OpGuarantee::exact,
                                  "Turns a node about x, then y, then z, through the origin.",
                                  "rotate: {by: [0, 30, 45], of: {box: {size: [1.8, 1, 0.6]}}}",
                                  ""};
  static constexpr Parameter parameters[] = {
      vector("by", 0, 0, 0, -36000, 36000, "angles about x, y and z, in that order", "degrees")};
  float by[3];
  float m[9];  // R, by rows; inside() applies its transpose

  void prepare(Data) {
    double c[3];
    double s[3];
    for (int i = 0; i < 3; ++i) {
      // Quarter turns are exact.
      const double quarters = static_cast<double>(by[i]) / 90;
      const double a = quarters * 1.5707963267948966;
      const bool exact = quarters == std::floor(quarters);
      c[i] = exact ? std::round(std::cos(a)) : std::cos(a);
      s[i] = exact ? std::round(std::sin(a)) : std::sin(a);
    }
    const double rows[9] = {c[1] * c[2],
                            s[0] * s[1] * c[2] - c[0] * s[2],
                            c[0] * s[1] * c[2] + s[0] * s[2],
                            c[1] * s[2],
                            s[0] * s[1] * s[2] + c[0] * c[2],
                            c[0] * s[1] * s[2] - s[0] * c[2],
                            -s[1],
                            s[0] * c[1],
                            c[0] * c[1]};
    std::transform(rows, rows + 9, m, [](double v) { return static_cast<float>(v); });
  }
  template <class T>
  Point<T> inside(const Point<T>& p) const {
    return {p.x * m[0] + p.y * m[3] + p.z * m[6], p.x * m[1] + p.y * m[4] + p.z * m[7],
            p.x * m[2] + p.y * m[5] + p.z * m[8]};
  }
  double stretch(const Point<Interval>&) const { return 1; }
  double similarity() const { return 1; }
  bool changes_nothing() const { return by[0] == 0 && by[1] == 0 && by[2] == 0; }
  Box bounds(const Box& a) const {
    double rows[9];
    std::copy(m, m + 9, rows);
    return mapped_box(a, rows);
  }
};

struct Scale {
  static constexpr OpInfo info = {
      "scale",
      OpRole::domain,
      OpGuarantee::bound,
      "Scales a node about the origin; exact where all three factors are equal.",
      "scale: {by: [1, 0.5, 0.75], of: {sphere: {radius: 1}}}",
      "f(p / a) times the smallest a; Diener 2.6.6 as printed overshoots"};
  static constexpr Parameter parameters[] = {
      vector("by", 1, 1, 1, 1e-6, 1e6, "factor along x, y and z, or one for all", "")};
  static constexpr bool kLeaves = true;
  float by[3];
  float inverse[3];
  float smallest;

  void prepare(Data) {
    for (int i = 0; i < 3; ++i) inverse[i] = 1 / by[i];
    smallest = std::min({by[0], by[1], by[2]});
  }
  template <class T>
  Point<T> inside(const Point<T>& p) const {
    return {p.x * inverse[0], p.y * inverse[1], p.z * inverse[2]};
  }
  template <class T>
  T value(const T& d, const Point<T>&) const {
    return d * smallest;
  }
  double stretch(const Point<Interval>&) const {
    return std::max({inverse[0], inverse[1], inverse[2]});
  }
  double child_level(double level) const { return level / smallest; }
  Levels looks_at(const Levels& own) const { return own.scaled(1 / static_cast<double>(smallest)); }
  double similarity() const { return by[0] == by[1] && by[0] == by[2] ? by[0] : 0; }
  bool changes_nothing() const { return by[0] == 1 && by[1] == 1 && by[2] == 1; }
  Box bounds(const Box& a) const {
    const glm::dvec3 s(by[0], by[1], by[2]);
    return a.empty() ? a : Box{a.lo * s, a.hi * s};
  }
};

using Domains = OpList<Translate, Rotate, Scale, Region>;

}  // namespace sdfgrid::ops
