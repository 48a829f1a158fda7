// field/leaves_basic.h: the elementary solids (internal to field/). Centred at the origin, axes
// along z. The exact forms are elementary geometry; J. C. Hart, Sphere Tracing, The Visual Computer
// 12, 1996, collects most of them.
#pragma once

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/field/ops.h"
#include "sdfgrid/field/parameters.h"

namespace sdfgrid::ops {

// What an op is made of that turns out to be nowhere.
struct Nothing {
  static constexpr OpInfo info = {"nothing", OpRole::leaf, OpGuarantee::bound, "", "", "", false};

  template <class T>
  T distance(const Point<T>&) const {
    return T(1e9F);
  }
  Box bounds(Data, double) const { return {}; }
};

struct Sphere {
  static constexpr OpInfo info = {"sphere",  OpRole::leaf,          OpGuarantee::exact,
                                  "A ball.", "sphere: {radius: 1}", ""};
  static constexpr bool kConvexSolid = true;
  static constexpr Parameter parameters[] = {size("radius", 1, "radius")};
  float radius;

  template <class T>
  T distance(const Point<T>& p) const {
    return length(p) - radius;
  }
};

struct Box3 {
  static constexpr OpInfo info = {"box",
                                  OpRole::leaf,
                                  OpGuarantee::exact,
                                  "A box with its faces across the axes.",
                                  "box: {size: [2, 1.4, 1]}",
                                  ""};
  static constexpr bool kConvexSolid = true;
  static constexpr Parameter parameters[] = {sizes("size", 1, "edge along x, y and z")};
  float edge[3];

  template <class T>
  T distance(const Point<T>& p) const {
    return box_distance(abs(p.x) - 0.5F * edge[0], abs(p.y) - 0.5F * edge[1],
                        abs(p.z) - 0.5F * edge[2]);
  }
};

struct Plane {
  static constexpr OpInfo info = {
      "plane",
      OpRole::leaf,
      OpGuarantee::exact,
      "The half-space behind a plane: all points p with normal . p <= distance.",
      "plane: {normal: [0, 0, 1], distance: 0}",
      ""};
  static constexpr bool kConvexSolid = true;
  static constexpr Parameter parameters[] = {
      vector("normal", 0, 0, 1, -kAny, kAny, "points out of the solid; any length but 0", ""),
      length_of("distance", 0, "of the plane from the origin along the normal")};
  float normal[3];
  float offset;

  void prepare(Data) {
    const float l = std::hypot(normal[0], normal[1], normal[2]);
    for (float& n : normal) n /= l;
  }
  template <class T>
  T distance(const Point<T>& p) const {
    return dot(normal, p) - offset;
  }
};

struct Torus {
  static constexpr OpInfo info = {
      "torus",
      OpRole::leaf,
      OpGuarantee::exact,
      "A ring around the z axis. Where `minor` is larger than `major` a bound inside.",
      "torus: {major: 1, minor: 0.3}",
      ""};
  static constexpr Parameter parameters[] = {
      size("major", 1, "radius of the circle that is the ring's core"),
      size("minor", 0.25, "radius of the ring itself")};
  float major, minor;

  template <class T>
  T distance(const Point<T>& p) const {
    return length(inner_length(p.x, p.y) - major, p.z) - minor;
  }
};

struct Cylinder {
  static constexpr OpInfo info = {"cylinder",
                                  OpRole::leaf,
                                  OpGuarantee::exact,
                                  "A cylinder along z with flat ends.",
                                  "cylinder: {radius: 0.8, height: 1.6}",
                                  ""};
  static constexpr bool kConvexSolid = true;
  static constexpr Parameter parameters[] = {size("radius", 1, "radius"),
                                             size("height", 2, "from end to end")};
  float radius, height;

  template <class T>
  T distance(const Point<T>& p) const {
    return rectangle_distance(inner_length(p.x, p.y) - radius, abs(p.z) - 0.5F * height);
  }
};

struct InfiniteCylinder {
  static constexpr OpInfo info = {"infinite_cylinder",
                                  OpRole::leaf,
                                  OpGuarantee::exact,
                                  "A cylinder along z without ends.",
                                  "infinite_cylinder: {radius: 0.5}",
                                  ""};
  static constexpr bool kConvexSolid = true;
  static constexpr Parameter parameters[] = {size("radius", 1, "radius")};
  float radius;

  template <class T>
  T distance(const Point<T>& p) const {
    return length(p.x, p.y) - radius;
  }
};

// In the half-plane (r, z) the solid is the triangle below the line from (radius, -height / 2) to
// (0, height / 2): the nearest point is on the base or on that line's segment.
struct Cone {
  static constexpr OpInfo info = {
      "cone",
      OpRole::leaf,
      OpGuarantee::exact,
      "A cone along z: base of the given radius at -height / 2, apex at +height / 2.",
      "cone: {radius: 0.9, height: 1.8}",
      "exact, where Diener (4.4) has a bound and leaves open which nappe is kept"};
  static constexpr bool kConvexSolid = true;
  static constexpr Parameter parameters[] = {size("radius", 1, "radius of the base"),
                                             size("height", 2, "from base to apex")};
  float radius, height;

  template <class T>
  T distance(const Point<T>& p) const {
    const T r = inner_length(p.x, p.y);
    const T z = p.z - 0.5F * height;  // below the apex
    const float along = 1 / (radius * radius + height * height);
    const T t = clamp((r * radius - z * height) * along, 0.0F, 1.0F);
    const T side = length(r - t * radius, z + t * height);
    const T base = length(positive(r - radius), z + height);
    const T out = max(r * height + z * radius, -(z + height));  // > 0 outside
    const T d = min(side, base);
    return select(out > T(0.0F), d, -d);
  }
  // Over half of space the sign of `out` is not known to intervals.
  Box bounds(Data, double level) const {
    const glm::dvec3 reach = glm::dvec3(radius, radius, 0.5 * height) + (level + 1e-6 * radius);
    return {-reach, reach};
  }
};

struct InfiniteCone {
  static constexpr OpInfo info = {
      "infinite_cone",
      OpRole::leaf,
      OpGuarantee::exact,
      "A cone with its apex at the origin that opens downwards along z without end.",
      "infinite_cone: {angle: 30}",
      ""};
  static constexpr bool kConvexSolid = true;
  static constexpr Parameter parameters[] = {
      number("angle", 30, 0.1, 89.9, "between the axis and the side", "degrees")};
  float angle;
  float c, s;

  void prepare(Data) {
    const double a = static_cast<double>(angle) * 0.017453292519943295;
    c = static_cast<float>(std::cos(a));
    s = static_cast<float>(std::sin(a));
  }
  template <class T>
  T distance(const Point<T>& p) const {
    const T r = inner_length(p.x, p.y);
    return select(r * s - p.z * c > T(0.0F), r * c + p.z * s, length(r, p.z));  // side or apex
  }
};

struct Capsule {
  static constexpr OpInfo info = {"capsule",
                                  OpRole::leaf,
                                  OpGuarantee::exact,
                                  "All points near a segment: a cylinder with round ends.",
                                  "capsule: {from: [-0.7, 0, 0], to: [0.7, 0, 0.4], radius: 0.4}",
                                  ""};
  static constexpr bool kConvexSolid = true;
  static constexpr Parameter parameters[] = {position("from", 0, 0, -1, "one end of the segment"),
                                             position("to", 0, 0, 1, "the other end"),
                                             size("radius", 0.5, "radius")};
  float from[3], to[3];
  float radius;
  float axis[3];  // to - from
  float inverse;  // 1 / |axis|^2, or 0 for a ball

  void prepare(Data) {
    float squared = 0;
    for (int i = 0; i < 3; ++i) {
      axis[i] = to[i] - from[i];
      squared += axis[i] * axis[i];
    }
    inverse = squared > 0 ? 1 / squared : 0;
  }
  template <class T>
  T distance(const Point<T>& p) const {
    const Point<T> q = minus(p, from);
    const T t = clamp(dot(axis, q) * inverse, 0.0F, 1.0F);
    return length(q.x - t * axis[0], q.y - t * axis[1], q.z - t * axis[2]) - radius;
  }
};

struct Lozenge {
  static constexpr OpInfo info = {"lozenge",
                                  OpRole::leaf,
                                  OpGuarantee::exact,
                                  "All points near a rectangle that lies across z.",
                                  "lozenge: {width: 1.6, depth: 1, radius: 0.2}",
                                  ""};
  static constexpr bool kConvexSolid = true;
  static constexpr Parameter parameters[] = {
      size("width", 2, "of the rectangle along x"), size("depth", 1, "of the rectangle along y"),
      size("radius", 0.25, "distance of the surface from the rectangle")};
  float width, depth, radius;

  template <class T>
  T distance(const Point<T>& p) const {
    return length(positive(abs(p.x) - 0.5F * width), positive(abs(p.y) - 0.5F * depth), p.z) -
           radius;
  }
};

using BasicLeaves = OpList<Nothing, Sphere, Box3, Plane, Torus, Cylinder, InfiniteCylinder, Cone,
                           InfiniteCone, Capsule, Lozenge>;

}  // namespace sdfgrid::ops
