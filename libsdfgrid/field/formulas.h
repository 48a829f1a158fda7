// field/formulas.h: implicit formulas as ops (internal to field/).
#pragma once

#include <vector>

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/field/dual.h"
#include "sdfgrid/field/formula_code.h"
#include "sdfgrid/field/parabola.h"
#include "sdfgrid/field/parameters.h"
#include "sdfgrid/field/profile.h"

namespace sdfgrid {
class Field;
struct Argument;
}  // namespace sdfgrid

namespace sdfgrid::ops {

struct Formula {
  static constexpr OpInfo info = {
      "formula",
      OpRole::leaf,
      OpGuarantee::computed,
      "Where f(x, y, z, t) is negative. `certified` divides f by a bound on its gradient over the "
      "region, so that no part of the surface is missed, and refuses what has none there, as where "
      "floor, sign, mod or atan2 jump; 1 and 2 estimate the distance from the first or second "
      "derivatives, which costs fewer steps and may miss thin parts.",
      "formula: {f: \"x^4 + y^4 + z^4 - x^2 - y^2 - z^2 + 0.4\", bounds: [[-1.3, -1.3, -1.3], "
      "[1.3, 1.3, 1.3]]}",
      "bound by intervals of the gradient; estimates: G. Taubin, Distance approximations for "
      "rasterizing implicit curves, ACM TOG 13, 1994 (the sign inside as Krayer's (106) lacks it)"};
  static constexpr Parameter parameters[] = {
      {"f",
       ParameterKind::text,
       "",
       {kRequired, 0, 0},
       0,
       0,
       "the formula, of x, y, z, t, pi and e, with + - * / ^ and the functions below"},
      {"bounds",
       ParameterKind::points,
       "length",
       {0, 0, 0},
       -kAny,
       kAny,
       "two corners of the region; the solid ends there. Not needed where the formula itself shows "
       "that it is bounded"},
      {"order", ParameterKind::text, "", {0, 0, 0}, 0, 0, "certified (the default), 1 or 2"},
      number("t", 0, -kAny, kAny, "time; in scenes that of the frame unless said")};
  static constexpr bool kList = true;
  static Field make(const std::vector<Argument>& arguments);

  template <class T>
  T distance(const Point<T>& p, Data code) const {
    return run_formula(code, p);
  }
};

template <class T>
Point<Dual<T, 3>> with_derivatives(const Point<T>& p) {
  using D = Dual<T, 3>;
  return {D::variable(p.x, 0), D::variable(p.y, 1), D::variable(p.z, 2)};
}

// f / |grad f|.
struct FirstOrder {
  static constexpr OpInfo info = {"formula_1", OpRole::leaf, OpGuarantee::estimate, "", "",
                                  "",          false};
  static constexpr bool kList = true;

  template <class T>
  T distance(const Point<T>& p, Data code) const {
    const Dual<T, 3> f = run_formula(code, with_derivatives(p));
    return f.v / max(length(f.d[0], f.d[1], f.d[2]), T(1e-12F));
  }
};

// The root d of |f| = |grad f| d + H d^2 / 2, H the Frobenius norm of the Hessian, signed by f, in
// the form that does not cancel.
struct SecondOrder {
  static constexpr OpInfo info = {"formula_2", OpRole::leaf, OpGuarantee::estimate, "", "",
                                  "",          false};
  static constexpr bool kList = true;

  template <class T>
  T distance(const Point<T>& p, Data code) const {
    const auto f = run_formula(code, with_derivatives(with_derivatives(p)));
    // By lengths, which have a slope where they are 0, as of formulas that are linear.
    constexpr float kRootTwo = 1.41421356F;
    const auto& d = f.d;
    const T h = length(length(d[0].d[0], d[1].d[1], d[2].d[2]),
                       length(d[0].d[1], d[0].d[2], d[1].d[2]) * kRootTwo);
    const T g = length(f.d[0].v, f.d[1].v, f.d[2].v);
    const T value = f.v.v;
    return value * 2.0F / max(g + sqrt(square(g) + h * abs(value) * 2.0F), T(1e-12F));
  }
};

// The box of the solid below a graph, grown by the level.
template <class Graph>
Box graph_box(const Graph& g, double level) {
  const double grow = std::fmax(level, 0.0);
  const double r = std::fmax(g.largest + grow, 0.0);
  const double lo = g.from - grow;
  const double hi = g.to + grow;
  if (g.mode == 0) return {glm::dvec3(-r, -r, lo), glm::dvec3(r, r, hi)};
  if (g.mode == 1) return {glm::dvec3(lo, -r, -r), glm::dvec3(hi, r, r)};
  const double z = 0.5 * g.depth + grow;
  return {glm::dvec3(lo, g.bottom - grow, -z), glm::dvec3(hi, g.largest + grow, z)};
}

// What is below the graph of a function of one variable: its border is a chain of circular arcs.
struct Function {
  static constexpr OpInfo info = {
      "function",
      OpRole::leaf,
      OpGuarantee::exact,
      "The graph of a function f(x), revolved about x (revolve_x) or z (revolve_z, f of the "
      "height) as the radius there, or what is below it in y, extruded along z (extrude). Kinks, "
      "jumps and infinite slopes are taken as they are. A function that takes more than 32,768 "
      "arcs has a bound only: divided by the largest sqrt(1 + f'^2). Poles are refused.",
      "function: {f: \"0.5 + 0.2*sin(4*x)\", mode: revolve_z, from: -1, to: 1}",
      "constant, linear and quadratic f by the nearest point of a parabola's arc; others by "
      "circular arcs (biarcs, K. M. Bolton 1975), proved by intervals to be within 1e-6 times the "
      "lesser of length and height of the graph, at kinks and jumps within 4e-6 f"};
  static constexpr Parameter parameters[] = {
      {"f", ParameterKind::text, "length", {kRequired, 0, 0}, 0, 0, "of x, in every mode, and t"},
      {"mode",
       ParameterKind::text,
       "",
       {0, 0, 0},
       0,
       0,
       "revolve_z (the default), revolve_x, extrude"},
      length_of("from", -1, "where the function begins"),
      length_of("to", 1, "where it ends"),
      length_of("floor", -1, "extrude: the bottom, in y"),
      size("depth", 1, "extrude: along z"),
      number("t", 0, -kAny, kAny, "time; in scenes that of the frame unless said")};
  static constexpr bool kList = true;  // Profile
  static Field make(const std::vector<Argument>& arguments);
  float mode;  // 0 revolve_z, 1 revolve_x, 2 extrude
  float from, to, bottom, depth;
  float largest;  // of f over its range
  float count, leaves;

  template <class T>
  T distance(const Point<T>& p, Data list) const {
    const auto nodes = 2 * static_cast<int>(leaves);
    const Profile profile = {list.values, list.values + kProfileBox * nodes,
                             static_cast<int>(count), static_cast<int>(leaves)};
    if (mode == 2) {
      return rectangle_distance(profile_distance(profile, p.x, p.y), abs(p.z) - 0.5F * depth);
    }
    return mode == 0 ? profile_distance(profile, p.z, length(p.x, p.y))
                     : profile_distance(profile, p.x, length(p.y, p.z));
  }
  Box bounds(Data, double level) const { return graph_box(*this, level); }
};

// The same by the formula itself, for functions that no chain of arcs comes near.
struct FunctionBound {
  static constexpr OpInfo info = {
      "function_bound", OpRole::leaf, OpGuarantee::computed, "", "", "", false};
  static constexpr bool kList = true;            // the formula's code
  float mode, from, to, bottom, depth, largest;  // as Function

  template <class T>
  T distance(const Point<T>& p, Data code) const {
    const T u = mode == 0 ? p.z : p.x;
    const T f = run_formula(code, Point<T>{clamp(u, from, to), T(0.0F), T(0.0F)});
    const T ends = max(T(from) - u, u - to);
    if (mode == 2) {
      return max(max(p.y - f, ends), max(T(bottom) - p.y, abs(p.z) - 0.5F * depth));
    }
    const T r = mode == 0 ? length(p.x, p.y) : length(p.y, p.z);
    return max(r - f, ends);
  }
  Box bounds(Data, double level) const { return graph_box(*this, level); }
};

// The same where f is constant, linear or quadratic: the distance itself, by the nearest points of
// the graph (an arc of a parabola) and of the straight ends. Where f falls below the axis or the
// floor the graph is no border, so there it is not used.
struct FunctionGraph {
  static constexpr OpInfo info = {
      "function_graph", OpRole::leaf, OpGuarantee::exact, "", "", "", false};
  float mode, from, to, bottom, depth, largest;  // as Function
  float coefficients[3];
  float ends[2];  // of f
  ParabolaArc graph;

  template <class T>
  T distance(const Point<T>& p) const {
    const T u = mode == 0 ? p.z : p.x;
    const T r = mode == 2 ? p.y : (mode == 0 ? length(p.x, p.y) : length(p.y, p.z));
    const float low = mode == 2 ? bottom : 0.0F;
    T d = min(graph.distance(Point<T>{u, r, T(0.0F)}),
              min(length(u - from, r - clamp(r, low, ends[0])),
                  length(u - to, r - clamp(r, low, ends[1]))));
    const T within = clamp(u, from, to);
    const T f = within * (within * coefficients[2] + coefficients[1]) + coefficients[0];
    T outside = max(max(T(from) - u, u - to), r - f);
    if (mode == 2) {
      d = min(d, length(u - within, r - bottom));
      outside = max(outside, T(bottom) - r);
    }
    d = select(outside < T(0.0F), -d, d);
    return mode == 2 ? rectangle_distance(d, abs(p.z) - 0.5F * depth) : d;
  }
  Box bounds(Data, double level) const { return graph_box(*this, level); }
};

using Formulas = OpList<Formula, FirstOrder, SecondOrder, Function, FunctionGraph, FunctionBound>;

}  // namespace sdfgrid::ops
