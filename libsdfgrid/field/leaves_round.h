// field/leaves_round.h: quadrics and their kin, triangles, polyhedra, curves (internal to field/).
#pragma once

#include <algorithm>
#include <vector>

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/field/ops.h"
#include "sdfgrid/field/parabola.h"
#include "sdfgrid/field/parameters.h"

namespace sdfgrid {
class Field;
struct Argument;
}  // namespace sdfgrid

namespace sdfgrid::ops {

inline Box box_around(const float radii[3], double level) {
  const glm::dvec3 r(radii[0], radii[1], radii[2]);
  const glm::dvec3 grown = r + std::fmax(level, 0.0);
  return {-grown, grown};
}

// With e the smallest radius, c_i = r_i^2 - e^2 and the nearest point x_i = r_i^2 p_i / (s + c_i),
// s is the root of |v(s)| = 1, v_i = r_i p_i / (s + c_i). 1 / |v| is increasing and concave in s,
// nearly linear, so Newton's method on it from the left converges from below in a few steps (as for
// the secular equation of trust regions, J. J. More and D. C. Sorensen 1983). The signed distance
// is (s - e^2) |p_i / (s + c_i)|.
struct Ellipsoid {
  static constexpr OpInfo info = {"ellipsoid",
                                  OpRole::leaf,
                                  OpGuarantee::exact,
                                  "An ellipsoid with its axes along x, y and z.",
                                  "ellipsoid: {radii: [1.2, 0.8, 0.5]}",
                                  "Newton's method on the secular equation"};
  static constexpr bool kConvexSolid = true;
  static constexpr Parameter parameters[] = {sizes("radii", 1, "along x, y and z")};
  float radii[3];
  float c[3];
  float smallest;
  int least;  // which

  void prepare(Data) {
    least = static_cast<int>(std::min_element(radii, radii + 3) - radii);
    smallest = radii[least];
    for (int i = 0; i < 3; ++i) {
      c[i] = (radii[i] - smallest) * (radii[i] + smallest);
    }
  }
  template <class T>
  T distance(const Point<T>& p) const {
    // At the centre of the thinnest axis v would be 0 / 0.
    const T floor_value(1e-7F * smallest);
    const T x = least == 0 ? max(abs(p.x), floor_value) : abs(p.x);
    const T y = least == 1 ? max(abs(p.y), floor_value) : abs(p.y);
    const T z = least == 2 ? max(abs(p.z), floor_value) : abs(p.z);
    const T a = x * radii[0];
    const T b = y * radii[1];
    const T d = z * radii[2];
    T s = max(a - c[0], max(b - c[1], d - c[2]));
    for (int i = 0; i < 7; ++i) {
      const T u = T(1.0F) / (s + c[0]);
      const T v = T(1.0F) / (s + c[1]);
      const T w = T(1.0F) / (s + c[2]);
      const T au = square(a * u);
      const T bv = square(b * v);
      const T dw = square(d * w);
      const T n2 = au + bv + dw;
      // 1 / |v| has the derivative (sum v_i^2 / (s + c_i)) / |v|^3.
      s = s + n2 * (sqrt(n2) - 1.0F) / (au * u + bv * v + dw * w);
    }
    return (s - smallest * smallest) * length(x / (s + c[0]), y / (s + c[1]), z / (s + c[2]));
  }
  Box bounds(Data, double level) const { return box_around(radii, level); }
};

struct EllipsoidBound {
  static constexpr OpInfo info = {
      "ellipsoid_bound",
      OpRole::leaf,
      OpGuarantee::bound,
      "The same solid as ellipsoid with a cheaper distance: short by up to the ratio of the radii.",
      "ellipsoid_bound: {radii: [1.2, 0.8, 0.5]}",
      ""};
  static constexpr Parameter parameters[] = {sizes("radii", 1, "along x, y and z")};
  float radii[3];
  float inverse[3];
  float smallest;

  void prepare(Data) {
    for (int i = 0; i < 3; ++i) inverse[i] = 1 / radii[i];
    smallest = std::min({radii[0], radii[1], radii[2]});
  }
  template <class T>
  T distance(const Point<T>& p) const {
    return (length(p.x * inverse[0], p.y * inverse[1], p.z * inverse[2]) - 1.0F) * smallest;
  }
};

// (|x|^p + |y|^p)^(1/p), the larger part first so that nothing overflows.
template <class T>
T p_norm(const T& x, const T& y, float p) {
  const T larger = max(max(abs(x), abs(y)), T(1e-20F));
  const T ratio = min(abs(x), abs(y)) / larger;
  return larger * pow(T(1.0F) + pow(ratio, p), 1 / p);
}
// The steepest that a p-norm of two gets: 2^(1/p - 1/2) for p < 2 (Hart's (31) divides by less).
inline float p_norm_slope(float p) { return p < 2 ? std::pow(2.0F, 1 / p - 0.5F) : 1.0F; }

struct Superellipsoid {
  static constexpr OpInfo info = {
      "superellipsoid",
      OpRole::leaf,
      OpGuarantee::bound,
      "Boxes, balls, octahedra and all between: |x|^p + |y|^p in the plane, that and |z| to the q.",
      "superellipsoid: {radii: [1, 0.8, 0.7], p: 4, q: 3}",
      "A. H. Barr 1981; divided by the slope of the norms, max(1, 2^(1/p - 1/2)) each"};
  static constexpr Parameter parameters[] = {
      sizes("radii", 1, "along x, y and z"),
      number("p", 4, 1, 64, "exponent in the plane across z; 2 is round"),
      number("q", 4, 1, 64, "exponent along z")};
  float radii[3];
  float p, q;
  float inverse[3];
  float scale;

  void prepare(Data) {
    for (int i = 0; i < 3; ++i) inverse[i] = 1 / radii[i];
    scale = std::min({radii[0], radii[1], radii[2]}) / (p_norm_slope(p) * p_norm_slope(q));
  }
  template <class T>
  T distance(const Point<T>& at) const {
    return (p_norm(p_norm(at.x * inverse[0], at.y * inverse[1], p), at.z * inverse[2], q) - 1.0F) *
           scale;
  }
  Box bounds(Data, double level) const {
    return box_around(radii, level / scale * std::max({radii[0], radii[1], radii[2]}));
  }
};

struct Supertorus {
  static constexpr OpInfo info = {
      "supertorus",
      OpRole::leaf,
      OpGuarantee::bound,
      "A torus whose ring is round in the p-norm and whose section in the q-norm.",
      "supertorus: {major: 1, minor: 0.35, p: 6, q: 3}",
      "A. H. Barr 1981; divided by the slope of the norms"};
  static constexpr Parameter parameters[] = {
      size("major", 1, "radius of the ring's core"), size("minor", 0.25, "radius of the section"),
      number("p", 4, 1, 64, "exponent of the ring; 2 is round"),
      number("q", 4, 1, 64, "exponent of the section")};
  float major, minor, p, q;
  float scale;

  void prepare(Data) { scale = 1 / (p_norm_slope(p) * p_norm_slope(q)); }
  template <class T>
  T distance(const Point<T>& at) const {
    return (p_norm(p_norm(at.x, at.y, p) - major, at.z, q) - minor) * scale;
  }
  Box bounds(Data, double level) const {
    const double section = minor + std::fmax(level, 0.0) / scale;
    const double r = major + section;
    return {glm::dvec3(-r, -r, -section), glm::dvec3(r, r, section)};
  }
};

struct Triangle {
  static constexpr OpInfo info = {"triangle",
                                  OpRole::leaf,
                                  OpGuarantee::exact,
                                  "All points near a triangle.",
                                  "triangle: {a: [-1, -0.5, 0], b: [1, -0.5, 0.2], c: [0, 0.9, 0], "
                                  "radius: 0.1}",
                                  ""};
  static constexpr bool kConvexSolid = true;
  static constexpr Parameter parameters[] = {
      position("a", -1, 0, 0, "a corner"), position("b", 1, 0, 0, "a corner"),
      position("c", 0, 1, 0, "a corner"),
      size("radius", 0.1, "distance of the surface from the triangle")};
  float corner[3][3];
  float radius;
  float edge[3][3];
  float inverse[3];    // 1 / |edge|^2
  float across[3][3];  // normal x edge, points inwards
  float normal[3];     // of length 1

  void prepare(Data) {
    for (int i = 0; i < 3; ++i) {
      float squared = 0;
      for (int a = 0; a < 3; ++a) {
        edge[i][a] = corner[(i + 1) % 3][a] - corner[i][a];
        squared += edge[i][a] * edge[i][a];
      }
      inverse[i] = squared > 0 ? 1 / squared : 0;
    }
    const auto cross = [](const float* u, const float* v, float* r) {
      for (int a = 0; a < 3; ++a) {
        r[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
      }
    };
    cross(edge[0], edge[1], normal);
    const float l = std::hypot(normal[0], normal[1], normal[2]);
    for (float& n : normal) n = l > 0 ? n / l : 0;
    for (int i = 0; i < 3; ++i) cross(normal, edge[i], across[i]);
  }
  // The face where the point is above it, else the nearest edge. A flat triangle is its edges.
  template <class T>
  T distance(const Point<T>& p) const {
    T beside(1e30F);
    T inside(1.0F);
    for (int i = 0; i < 3; ++i) {
      const Point<T> q = minus(p, corner[i]);
      const T t = clamp(dot(edge[i], q) * inverse[i], 0.0F, 1.0F);
      beside =
          min(beside, length(q.x - t * edge[i][0], q.y - t * edge[i][1], q.z - t * edge[i][2]));
      inside = min(inside, dot(across[i], q));
    }
    const T height = abs(dot(normal, minus(p, corner[0])));
    return select(inside > T(0.0F), height, beside) - radius;
  }
  Box bounds(Data, double level) const {
    Box box;
    for (const auto& c : corner) box.add({c[0], c[1], c[2]});
    const glm::dvec3 grow(std::fmax(radius + level, 0.0));
    return {box.lo - grow, box.hi + grow};
  }
};

// The corners' box of an intersection of half-spaces, those with normals (x, y, z) and distances w;
// axes without end are infinite.
Box half_spaces_box(Data planes, double level);

struct Polyhedron {
  static constexpr OpInfo info = {
      "polyhedron",
      OpRole::leaf,
      OpGuarantee::exact_inside,
      "What is behind all of some planes: normals and distances in a row, [nx, ny, nz, d, ...], "
      "all "
      "points with n . p <= d. Outside it is the height above the highest plane: before an edge at "
      "least the sine of half the angle between its faces times the distance (0.7 at right "
      "angles), "
      "before a corner of a cube 0.57.",
      "polyhedron: {planes: [1, 1, 1, 0.6, -1, -1, 1, 0.6, -1, 1, -1, 0.6, 1, -1, -1, 0.6]}",
      ""};
  static constexpr bool kConvexSolid = true;
  static constexpr Parameter parameters[] = {{"planes",
                                              ParameterKind::numbers,
                                              "",
                                              {kRequired, 0, 0},
                                              -kAny,
                                              kAny,
                                              "four numbers a plane"}};
  static constexpr bool kList = true;
  static Field make(const std::vector<Argument>& arguments);

  template <class T>
  T distance(const Point<T>& p, Data planes) const {
    T d = dot(planes.values, p) - planes.values[3];
    for (int i = 4; i < planes.count; i += 4) {
      d = max(d, dot(planes.values + i, p) - planes.values[i + 3]);
    }
    return d;
  }
  Box bounds(Data planes, double level) const { return half_spaces_box(planes, level); }
};

// A Platonic or truncated solid as the v-norm of the distances to its faces' planes.
struct GeneralizedDistance {
  static constexpr OpInfo info = {
      "gdf",
      OpRole::leaf,
      OpGuarantee::bound,
      "A Platonic solid (tetrahedron, cube, octahedron, dodecahedron, icosahedron), or one with "
      "its "
      "corners cut so that all edges are equal (truncated_tetrahedron, truncated_cube, ...); the "
      "rounder the smaller the exponent. With flat faces exact inside, and outside at least 0.33 "
      "of "
      "the distance (tetrahedron), 0.57 (cube, octahedron, truncated_tetrahedron) or 0.79 "
      "(others).",
      "gdf: {solid: dodecahedron, exponent: 9, radius: 0.9}",
      "E. Akleman and J. Chen, Generalized distance functions, 1999; divided by the largest value "
      "on "
      "the unit sphere (Diener (6.1) takes it for 1), the largest term first"};
  static constexpr bool kConvexSolid = true;
  static constexpr Parameter parameters[] = {
      {"solid", ParameterKind::text, "", {0, 0, 0}, 0, 0, "which; icosahedron unless said"},
      number("exponent", 9, 1, kUnlimited,
             "of the norm, up to infinity (.inf); from 1000 on the faces are flat"),
      size("radius", 1, "from the centre to the nearest faces")};
  static constexpr bool kList = true;  // normals, shorter than 1 where the face is farther out
  static Field make(const std::vector<Argument>& arguments);
  float exponent, radius;
  float two_sided;  // 1: faces come in opposite pairs, the list has one of each
  float scale;

  template <class T>
  T distance(const Point<T>& p, Data normals) const {
    T largest(1e-20F);
    for (int i = 0; i < normals.count; i += 3) largest = max(largest, term(p, normals.values + i));
    T sum(0.0F);
    for (int i = 0; i < normals.count; i += 3) {
      sum = sum + pow(term(p, normals.values + i) / largest, exponent);
    }
    return (largest * pow(sum, 1 / exponent) - radius) * scale;
  }
  template <class T>
  T term(const Point<T>& p, const float* normal) const {
    const T d = dot(normal, p);
    return two_sided > 0 ? abs(d) : positive(d);
  }
  Box bounds(Data normals, double level) const;
};

struct Bezier {
  static constexpr OpInfo info = {
      "bezier",
      OpRole::leaf,
      OpGuarantee::exact_outside,
      "A tube around a Bezier curve: quadratic by three points, cubic by four. Exact inside too "
      "where the tube does not meet itself.",
      "bezier: {points: [[-1, -0.5, 0], [0, 1.5, 0.5], [1, -0.5, 0]], radius: 0.2}",
      "quadratic: roots of the cubic in closed form; cubic: roots of the quintic by subdivision in "
      "the Bernstein basis"};
  static constexpr Parameter parameters[] = {{"points",
                                              ParameterKind::points,
                                              "length",
                                              {kRequired, 0, 0},
                                              -kAny,
                                              kAny,
                                              "three or four control points"},
                                             size("radius", 0.1, "of the tube")};
  static Field make(const std::vector<Argument>& arguments);
  ParabolaArc arc;
  float radius;
  float control[3][3];

  template <class T>
  T distance(const Point<T>& p) const {
    return arc.distance(p) - radius;
  }
  Box bounds(Data, double level) const;
};

using RoundLeaves = OpList<Ellipsoid, EllipsoidBound, Superellipsoid, Supertorus, Triangle,
                           Polyhedron, GeneralizedDistance, Bezier>;

}  // namespace sdfgrid::ops
