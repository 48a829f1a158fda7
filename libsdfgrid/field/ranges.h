// field/ranges.h: ops that change the value of one node (internal to field/).
#pragma once

#include <vector>

#include "sdfgrid/field/combinations.h"

namespace sdfgrid {
class Field;
struct Argument;
}  // namespace sdfgrid

namespace sdfgrid::ops {

struct Complement {
  static constexpr OpInfo info = {"complement",
                                  OpRole::range,
                                  OpGuarantee::exact,
                                  "Everything that is not in the node.",
                                  "intersection: [{box: {size: [2, 2, 1]}}, "
                                  "{complement: {of: {sphere: {radius: 0.8}}}}]",
                                  ""};
  static constexpr bool kTakesAway = true;
  static constexpr bool kConvex = true;
  static constexpr bool kTurnsLast = true;

  template <class T>
  T value(const T& d, const Point<T>&) const {
    return -d;
  }
  Box bounds(const Box&) const { return {glm::dvec3(-kInfinity), glm::dvec3(kInfinity)}; }
};

struct Offset {
  static constexpr OpInfo info = {
      "offset",
      OpRole::range,
      OpGuarantee::bound,
      "Grows a node by a length (shrinks it by a negative one): the solid within that distance of "
      "an exact node, a grid or a mesh. Of a node whose distance is a bound it reaches further. An "
      "exact node that grows is exact outside, a convex one inside too; one that shrinks is exact "
      "inside.",
      "offset: {by: 0.2, of: {box: {size: [1.4, 1, 0.6]}}}",
      "Hart 1996"};
  static constexpr bool kTakesAway = true;
  static constexpr Parameter parameters[] = {length_of("by", 0.1, "how far outwards")};
  static constexpr bool kConvex = true;
  // Of a grid or a mesh, exactly.
  static Field make_around(const std::vector<Argument>& arguments, const Field& node);
  float by;

  template <class T>
  T value(const T& d, const Point<T>&) const {
    return d - by;
  }
  double child_level(double level) const { return level + by; }
  Levels looks_at(const Levels& own) const { return {own.lo + by, own.hi + by}; }
  Box bounds(const Box& a) const { return a; }
};

struct Shell {
  static constexpr OpInfo info = {
      "shell",
      OpRole::range,
      OpGuarantee::exact_outside,
      "The skin of a node: all points within half the thickness of the surface of an exact node, a "
      "grid or a mesh. Of a node whose distance is a bound it is thicker.",
      "intersection: [{shell: {thickness: 0.15, of: {sphere: {radius: 1}}}}, {plane: {normal: [1, "
      "0.4, 1]}}]",
      ""};
  static constexpr bool kTakesAway = true;
  static constexpr Parameter parameters[] = {size("thickness", 0.1, "of the skin")};
  static constexpr bool kConvex = true;
  // Of a grid or a mesh, exactly.
  static Field make_around(const std::vector<Argument>& arguments, const Field& node);
  float thickness;

  template <class T>
  T value(const T& d, const Point<T>&) const {
    return abs(d) - 0.5F * thickness;
  }
  double child_level(double level) const { return level + 0.5 * thickness; }
  Levels looks_at(const Levels& own) const {
    return Levels{-own.hi, own.hi}.wider(0.5 * thickness);
  }
  Box bounds(const Box& a) const { return a; }
};

using Ranges = OpList<Complement, Offset, Shell>;

}  // namespace sdfgrid::ops
