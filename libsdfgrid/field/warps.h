// field/warps.h: deformations, whose slope grows with the distance from their axis: bounded over
// the node's region (internal to field/). Every one says how far it can stretch a vector over a
// box, in closed form; tests hold that against finite differences.
#pragma once

#include <array>

#include "sdfgrid/field/domains.h"
#include "sdfgrid/field/steepness.h"

namespace sdfgrid::ops {

// The box of all rotations of a box about z.
inline Box turned_about_z(const Box& a) {
  if (a.empty()) return a;
  const double x = std::fmax(std::fabs(a.lo.x), std::fabs(a.hi.x));
  const double y = std::fmax(std::fabs(a.lo.y), std::fabs(a.hi.y));
  const double r = std::sqrt(x * x + y * y);
  return {glm::dvec3(-r, -r, a.lo.z), glm::dvec3(r, r, a.hi.z)};
}

// What a function of gradient n rises at q for a turn of the space around it at `rate`.
inline Interval rise_of_turning(const std::array<Interval, 3>& n, const Point<Interval>& q,
                                float rate) {
  return (n[0] * q.y - n[1] * q.x) * rate;
}

struct Twist {
  static constexpr OpInfo info = {
      "twist",
      OpRole::domain,
      OpGuarantee::computed,
      "Turns a node about z the more the higher it is.",
      "twist: {turns: 0.25, of: {box: {size: [1, 0.5, 2]}}}",
      "A. H. Barr 1984; the map is a rotation times a shear by k = r |da/dz|, so its stretch is "
      "(k + sqrt(k^2 + 4)) / 2 (Hart's (51) is too small for k > 2.1)"};
  static constexpr Parameter parameters[] = {
      number("turns", 0.1, -1000, 1000, "whole turns per unit of height", "1/length")};
  float turns;
  float rate;  // radians a unit of height

  void prepare(Data) { rate = static_cast<float>(turns * 6.283185307179586); }
  template <class T>
  Point<T> inside(const Point<T>& p) const {
    const T c = cos(p.z * rate);
    const T s = sin(p.z * rate);
    return {c * p.x + s * p.y, c * p.y - s * p.x, p.z};
  }
  double stretch(const Point<Interval>& p) const {
    const double k = length(p.x, p.y).hi * std::fabs(rate);
    return 0.5 * (k + std::sqrt(k * k + 4));
  }
  // The norm of a gradient n of the node at q, seen from outside: along x and y it is turned, along
  // z the turning adds what n rises along the circle through q.
  double pulled_back(const std::array<Interval, 3>& n, double most, const Point<Interval>& q,
                     const Point<Interval>&) const {
    const double across = std::fmin(norm(n.data(), 2), most);
    return std::hypot(across, magnitude(n[2] + rise_of_turning(n, q, rate)));
  }
  Box bounds(const Box& a) const { return turned_about_z(a); }
};

struct Bend {
  static constexpr OpInfo info = {
      "bend",
      OpRole::domain,
      OpGuarantee::computed,
      "Turns a node about z the more the farther along x it is: a bar along x becomes an arc.",
      "bend: {angle: 40, of: {box: {size: [2, 0.3, 0.6]}}}",
      "the derivative is a rotation times I + u e_x^T, u = da/dx (y, -x)"};
  static constexpr Parameter parameters[] = {
      number("angle", 30, -36000, 36000, "turn per unit of length along x", "degrees/length")};
  float angle;
  float rate;

  void prepare(Data) { rate = static_cast<float>(angle * 0.017453292519943295); }
  template <class T>
  Point<T> inside(const Point<T>& p) const {
    const T c = cos(p.x * rate);
    const T s = sin(p.x * rate);
    return {c * p.x + s * p.y, c * p.y - s * p.x, p.z};
  }
  // The derivative is a rotation of I + u e_x^T with u = rate (y, -x). Its largest singular value
  // is convex in u, so largest at a corner of the box of all u.
  double stretch(const Point<Interval>& p) const {
    const double along = magnitude(p.y) * std::fabs(rate);
    const double across = magnitude(p.x) * std::fabs(rate);
    double largest = 1;
    for (const double u : {1 + along, 1 - along}) {
      const double trace = u * u + across * across + 1;
      const double discriminant = std::fmax(0.0, trace * trace - 4 * u * u);
      largest = std::fmax(largest, std::sqrt(0.5 * (trace + std::sqrt(discriminant))));
    }
    return largest;
  }
  // As of Twist, but what the turning adds is along x.
  double pulled_back(const std::array<Interval, 3>& n, double most, const Point<Interval>& q,
                     const Point<Interval>& p) const {
    const Interval rise = rise_of_turning(n, q, rate);
    const double whole = std::fmin(norm(n.data(), 3), most);
    const Interval along =
        meet(n[0] * cos(p.x * rate) - n[1] * sin(p.x * rate), Interval(-whole, whole));
    const double square_norm = whole * whole + (rise * (along * 2.0F + rise)).hi;
    return std::isnan(square_norm) ? kInfinity : std::sqrt(std::fmax(square_norm, 0));
  }
  Box bounds(const Box& a) const { return turned_about_z(a); }
};

struct Taper {
  static constexpr OpInfo info = {
      "taper",
      OpRole::domain,
      OpGuarantee::computed,
      "Scales x and y of a node by a factor that runs from `from` at its bottom to `to` at its "
      "top.",
      "taper: {from: 1, to: 0.4, of: {box: {size: [1.4, 1.4, 2]}}}",
      "A. H. Barr 1984; with s = 1 / scale and the shear m = rho |scale'| s^2 the stretch is "
      "sqrt((S + sqrt(S^2 - 4 s^2)) / 2), S = s^2 + m^2 + 1 (Hart's (49) leaves out the shear)"};
  static constexpr Parameter parameters[] = {
      number("from", 1, 0.001, 1000, "scale of x and y at the bottom of the node"),
      number("to", 0.5, 0.001, 1000, "scale of x and y at its top")};
  float from, to;
  float bottom, slope;  // scale = from + slope * clamp(z - bottom, 0, extent)
  float extent;

  void fit(const Box& content) {
    bottom = static_cast<float>(content.lo.z);
    extent = std::max(static_cast<float>(content.hi.z - content.lo.z), 1e-6F);
    slope = (to - from) / extent;
  }
  template <class T>
  T scale(const T& z) const {
    return clamp(z - bottom, 0.0F, extent) * slope + from;
  }
  template <class T>
  Point<T> inside(const Point<T>& p) const {
    const T s = T(1.0F) / scale(p.z);
    return {p.x * s, p.y * s, p.z};
  }
  double stretch(const Point<Interval>& p) const {
    const double s = (Interval(1) / scale(p.z)).hi;
    const double m = length(p.x, p.y).hi * std::fabs(slope) * s * s;
    const double sum = s * s + m * m + 1;
    return std::sqrt(0.5 * (sum + std::sqrt(std::fmax(0.0, sum * sum - 4 * s * s))));
  }
  Box bounds(const Box& a) const {
    if (a.empty()) return a;
    const double f = std::max(from, to);
    const double least = std::min(from, to);
    Box r = a;
    for (int i = 0; i < 2; ++i) {
      r.lo[i] = std::fmin(a.lo[i] * f, a.lo[i] * least);
      r.hi[i] = std::fmax(a.hi[i] * f, a.hi[i] * least);
    }
    return r;
  }
};

using Warps = OpList<Twist, Bend, Taper>;

}  // namespace sdfgrid::ops
