// field/folds.h: mirrors, repetition, linear maps, hyperization (internal to field/).
#pragma once

#include <vector>

#include "sdfgrid/field/domains.h"

namespace sdfgrid {
class Field;
struct Argument;
}  // namespace sdfgrid

namespace sdfgrid::ops {

struct Mirror {
  static constexpr OpInfo info = {
      "mirror",
      OpRole::domain,
      OpGuarantee::bound,
      "What a node has at positive x, y or z, and its mirror image.",
      "mirror: {planes: [1, 0, 0], of: {translate: {by: [0.6, 0, 0], of: {capsule: {from: [0, 0, "
      "-0.5], to: [0.3, 0, 0.5], radius: 0.3}}}}}",
      "a fold, which lengthens nothing"};
  static constexpr Parameter parameters[] = {
      vector("planes", 1, 0, 0, 0, 1, "1 for each axis across which to mirror", "")};
  float planes[3];

  template <class T>
  Point<T> inside(const Point<T>& p) const {
    return {planes[0] > 0.5F ? abs(p.x) : p.x, planes[1] > 0.5F ? abs(p.y) : p.y,
            planes[2] > 0.5F ? abs(p.z) : p.z};
  }
  double stretch(const Point<Interval>&) const { return 1; }
  bool changes_nothing() const {
    return planes[0] <= 0.5F && planes[1] <= 0.5F && planes[2] <= 0.5F;
  }
  Box bounds(const Box& a) const {
    if (a.empty()) return a;
    Box r = a;
    for (int i = 0; i < 3; ++i) {
      if (planes[i] <= 0.5F) continue;
      if (a.hi[i] < 0) return {};
      r.hi[i] = a.hi[i];
      r.lo[i] = -a.hi[i];
    }
    return r;
  }
};

// Any linear map: f(M^-1 p) times the smallest singular value of M, 1 / |M^-1|, by the power
// method.
struct Linear {
  static constexpr OpInfo info = {
      "linear",
      OpRole::domain,
      OpGuarantee::bound,
      "Any linear map of a node: shears, stretches, turns. Nine numbers, row by row.",
      "linear: {matrix: [1, 0.5, 0, 0, 1, 0, 0, 0, 0.7], of: {box: {size: [1.2, 1.2, 1.2]}}}",
      "|M^-1| by the power method"};
  static constexpr Parameter parameters[] = {{"matrix",
                                              ParameterKind::matrix,
                                              "",
                                              {0, 0, 0},
                                              -1e6,
                                              1e6,
                                              "its rows; must not be singular"}};
  static constexpr bool kLeaves = true;
  float m[9];
  float inverse[9];
  float scale;

  void prepare(Data);
  template <class T>
  Point<T> inside(const Point<T>& p) const {
    return {dot(inverse, p), dot(inverse + 3, p), dot(inverse + 6, p)};
  }
  template <class T>
  T value(const T& d, const Point<T>&) const {
    return d * scale;
  }
  double stretch(const Point<Interval>&) const { return 1 / static_cast<double>(scale); }
  double child_level(double level) const { return level / scale; }
  Levels looks_at(const Levels& own) const { return own.scaled(1 / static_cast<double>(scale)); }
  bool changes_nothing() const {
    const float same[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    return std::equal(m, m + 9, same);
  }
  Box bounds(const Box& a) const {
    double rows[9];
    std::copy(m, m + 9, rows);
    return mapped_box(a, rows);
  }
};

// In its own cell the node's distance holds; across the wall there may be a copy that is nearer,
// but none nearer than the wall plus `gap`, the least that the node's value is anywhere on the
// walls. Where that is little the field is a union with the copies in the nearest cells as well,
// each of them a Repeat with another `shift`, and only what is beyond those is bounded so: a way
// there crosses one of the walls on the far side, and then one around its cell. To a cell next to
// this one it crosses all walls between, and then likewise.
struct Repeat {
  static constexpr OpInfo info = {
      "repeat",
      OpRole::domain,
      OpGuarantee::bound,
      "A node again and again in cells of the given size; 0: not along that axis. The node must "
      "fit "
      "in its cell.",
      "intersection: [{repeat: {cell: [1, 1, 0], of: {capsule: {from: [-0.2, 0, 0], to: [0.2, 0.1, "
      "0.3], radius: 0.15}}}}, {box: {size: [3, 3, 3]}}]",
      "right for any content, which Diener (2.16) and Krayer (40) are not: the nearest cells "
      "count, "
      "or the step ends at the wall"};
  static constexpr Parameter parameters[] = {vector("cell", 2, 2, 2, 0, kAny, "edges of a cell")};
  static constexpr bool kLeaves = true;
  static Field make_around(const std::vector<Argument>& arguments, const Field& node);
  float cell[3];
  float inverse[3];
  float gap;
  float near;      // 1 if the nearest cells are in the union
  float shift[3];  // 1 along axes along which this is the nearest cell's copy, not the own cell's

  void prepare(Data) {
    for (int i = 0; i < 3; ++i) inverse[i] = cell[i] > 0 ? 1 / cell[i] : 0;
  }
  template <class T>
  T in_own_cell(const T& x, int axis) const {
    return cell[axis] > 0 ? x - floor(x * inverse[axis] + 0.5F) * cell[axis] : x;
  }
  template <class T>
  T local(const T& x, int axis) const {
    const T own = in_own_cell(x, axis);
    if (shift[axis] == 0) return own;
    return select(own > T(0.0F), own - cell[axis], own + cell[axis]);
  }
  template <class T>
  Point<T> inside(const Point<T>& p) const {
    return {local(p.x, 0), local(p.y, 1), local(p.z, 2)};
  }
  template <class T>
  T value(const T& d, const Point<T>& p) const {
    const T x[3] = {p.x, p.y, p.z};
    T own = d;
    T wall(1e9F);
    for (int i = 0; i < 3; ++i) {
      if (!(cell[i] > 0)) continue;
      const T from_middle = abs(in_own_cell(x[i], i));
      const T to_wall = T(0.5F * cell[i]) - from_middle;
      // Across the wall no node is nearer than that, though its value may be less.
      if (shift[i] > 0) own = max(own, positive(to_wall) + gap);
      wall = min(wall, near > 0 ? from_middle + 0.5F * cell[i] : to_wall);
    }
    return min(own, positive(wall) + gap);
  }
  double stretch(const Point<Interval>&) const { return 1; }
  double slope(const Interval& d, double slope, const Point<Interval>&) const {
    const bool own = shift[0] + shift[1] + shift[2] == 0;
    return own && d.hi < gap ? slope : std::fmax(1.0, slope);
  }
  // Values below that are a node's, or larger than one's.
  double exact_below() const {
    double wall = kInfinity;
    for (const float edge : cell) {
      if (edge > 0) wall = std::fmin(wall, near > 0 ? 0.5 * edge : 0);
    }
    return wall + gap;
  }
  Box bounds(const Box& a, double level) const {
    if (a.empty() && level <= 0) return a;
    Box r = a;
    for (int i = 0; i < 3; ++i) {
      if (cell[i] > 0 || level >= exact_below()) {
        r.lo[i] = -kInfinity;
        r.hi[i] = kInfinity;
      }
    }
    return r;
  }
};

// Coordinates raised to a power that keeps their sign, in units of `unit`: the image of a node
// under it. Its slope is bounded wherever no exponent below 1 meets 0.
struct Hyperize {
  static constexpr OpInfo info = {
      "hyperize",
      OpRole::domain,
      OpGuarantee::computed,
      "Raises each coordinate to a power, keeping its sign: exponents above 1 flatten a node's "
      "sides "
      "towards a box. Exponents below 1 are refused where the node's region holds 0.",
      "hyperize: {exponents: [2, 2, 1], of: {sphere: {radius: 1}}}",
      "Diener (6.3), divided by the largest stretch over the region"};
  static constexpr Parameter parameters[] = {
      vector("exponents", 2, 2, 2, 0.1, 16, "of x, y and z", ""),
      size("unit", 1, "the length that stays what it is")};
  float exponents[3];
  float unit;

  template <class T>
  T raised(const T& x, float n) const {
    return n == 1 ? x : pow(abs(x) * (1 / unit), n) * sign(x) * unit;
  }
  template <class T>
  Point<T> inside(const Point<T>& p) const {
    return {raised(p.x, exponents[0]), raised(p.y, exponents[1]), raised(p.z, exponents[2])};
  }
  double stretch(const Point<Interval>& p) const {
    return std::fmax(steepest(p.x, exponents[0]),
                     std::fmax(steepest(p.y, exponents[1]), steepest(p.z, exponents[2])));
  }
  // n |x|^(n-1), largest at one end of the interval.
  double steepest(const Interval& x, double n) const {
    const Interval a = abs(x);
    const double at = (n >= 1 ? a.hi : a.lo) / unit;
    return n * std::pow(at, n - 1);
  }
  Box bounds(const Box& a) const {
    Box r = a;
    for (int i = 0; i < 3 && !a.empty(); ++i) {
      const double n = 1 / static_cast<double>(exponents[i]);
      r.lo[i] = std::copysign(std::pow(std::fabs(a.lo[i]) / unit, n) * unit, a.lo[i]);
      r.hi[i] = std::copysign(std::pow(std::fabs(a.hi[i]) / unit, n) * unit, a.hi[i]);
    }
    return r;
  }
};

using Folds = OpList<Mirror, Linear, Repeat>;
using MoreWarps = OpList<Hyperize>;

}  // namespace sdfgrid::ops
