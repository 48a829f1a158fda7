// field/leaves_fractal.h: fractals by folds, and by escaping orbits (internal to field/).
#pragma once

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/field/ops.h"
#include "sdfgrid/field/parameters.h"

namespace sdfgrid::ops {

inline Box cube_around(double half, double level) {
  const glm::dvec3 r(half + std::fmax(level, 0.0));
  return {-r, r};
}

struct Menger {
  static constexpr OpInfo info = {
      "menger",
      OpRole::leaf,
      OpGuarantee::bound,
      "Menger's sponge: a cube with square tunnels.",
      "menger: {iterations: 4, size: 2}",
      "each generation cuts a cross, found by reflecting space into one of its cells"};
  static constexpr Parameter parameters[] = {
      whole("iterations", 4, 0, 12, "generations of tunnels"), size("size", 2, "edge of the cube")};
  float iterations, edge;

  template <class T>
  T distance(const Point<T>& p) const {
    float half = 0.5F * edge;
    T x = abs(p.x);
    T y = abs(p.y);
    T z = abs(p.z);
    T d = box_distance(x - half, y - half, z - half);
    for (int i = 0; i < static_cast<int>(iterations); ++i) {
      const float third = half * (1.0F / 3);
      // The cross: where two of the coordinates are within a third.
      const T median = max(min(x, y), min(max(x, y), z));
      d = max(d, third - median);
      x = abs(third - abs(x - third));
      y = abs(third - abs(y - third));
      z = abs(third - abs(z - third));
      half = third;
    }
    return d;
  }
  Box bounds(Data, double level) const { return cube_around(0.5 * edge, level); }
};

struct Sierpinski {
  static constexpr OpInfo info = {
      "sierpinski",
      OpRole::leaf,
      OpGuarantee::bound,
      "Sierpinski's tetrahedron: four corners of a cube, halved again and again.",
      "sierpinski: {iterations: 5, size: 2}",
      "reflections into one corner, then doubling"};
  static constexpr Parameter parameters[] = {whole("iterations", 5, 0, 16, "generations"),
                                             size("size", 2, "edge of the cube around it")};
  float iterations, edge;

  template <class T>
  T distance(const Point<T>& p) const {
    const float half = 0.5F * edge;
    float scale = 1;
    T x = p.x;
    T y = p.y;
    T z = p.z;
    const auto fold = [](T& a, T& b) {
      const T s = min(a + b, T(0.0F));
      a = a - s;
      b = b - s;
    };
    for (int i = 0; i < static_cast<int>(iterations); ++i) {
      fold(x, y);
      fold(x, z);
      fold(y, z);
      x = x * 2.0F - half;
      y = y * 2.0F - half;
      z = z * 2.0F - half;
      scale *= 0.5F;
    }
    // The tetrahedron with corners (1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1) times half.
    const T face = max(max(-x - y - z, y + z - x), max(x + z - y, x + y - z));
    return (face - half) * (0.577350269F * scale);
  }
  Box bounds(Data, double level) const { return cube_around(0.5 * edge, level * 1.7320508); }
};

// If z moves by e, z^2 + c moves by at most 2 |z| e + e^2: so while z_i moves by no more than
// sqrt(|z_i|^2 + d) - |z_i|, z_(i+1) moves by no more than d. Followed back from the last place,
// which may move by its distance from the sphere of radius `reach`, this bounds the distance of the
// point itself. An orbit beyond that sphere never returns, so every place there gives such a bound;
// each is 1-Lipschitz, and the largest counts.
struct Julia {
  static constexpr OpInfo info = {
      "julia",
      OpRole::leaf,
      OpGuarantee::bound,
      "The quaternion Julia set of z^2 + c: the points (x, y, z, 0) whose orbits stay, that is "
      "after "
      "so many iterations are within 2 of the origin (a little more where |c| is above 2).",
      "julia: {c: [-0.2, 0.6, 0.2], w: 0.2, iterations: 9}",
      "how far a point may move until its orbit comes to another end, turn by turn; the estimate "
      "of "
      "J. C. Hart, D. J. Sandin, L. H. Kauffman 1989, |z| ln |z| / (2 |z'|), is of the whole set "
      "and overshoots this solid, and sets of dust too"};
  static constexpr Parameter parameters[] = {
      vector("c", -0.2, 0.6, 0.2, -2, 2, "the first three parts of c", ""),
      number("w", 0, -2, 2, "the fourth part of c"),
      whole("iterations", 10, 1, 64, "of the orbit")};
  float c[3];
  float w;
  float iterations;
  float reach;

  void prepare(Data) {
    const float size = std::hypot(std::hypot(c[0], c[1], c[2]), w);
    reach = std::fmax(2.0F, 0.5F * (1 + std::sqrt(1 + 4 * size)));
  }
  // An orbit that is far out stays where it is, so that no iteration overflows: its earlier places
  // give the larger bounds.
  template <class T>
  T distance(const Point<T>& p) const {
    T z[4] = {p.x, p.y, p.z, T(0.0F)};
    T sizes[64];
    const int turns = static_cast<int>(iterations);
    for (int i = 0; i < turns; ++i) {
      const T r2 = square(z[0]) + square(z[1]) + square(z[2]) + square(z[3]);
      sizes[i] = sqrt(r2);
      const auto stays = r2 < T(256.0F);
      const T next = square(z[0]) - square(z[1]) - square(z[2]) - square(z[3]) + c[0];
      const T twice = z[0] * 2.0F;
      z[1] = select(stays, twice * z[1] + c[1], z[1]);
      z[2] = select(stays, twice * z[2] + c[2], z[2]);
      z[3] = select(stays, twice * z[3] + w, z[3]);
      z[0] = select(stays, next, z[0]);
    }
    T d = sqrt(square(z[0]) + square(z[1]) + square(z[2]) + square(z[3])) - reach;
    for (int i = turns; i-- > 0;) {
      const T back = d / max(sizes[i] + sqrt(square(sizes[i]) + abs(d)), T(1e-20F));
      d = max(back, sizes[i] - reach);
    }
    return d;
  }
  Box bounds(Data, double level) const { return cube_around(reach, level); }
};

// Where an orbit has left the ball of radius 2 half of its potential over the slope of that,
// |z| ln(|z| / 2) / (2 |z'|); inside (|z| - 2) / (2 |z'|), of which the sign counts.
template <class T>
T escaped_distance(const T& r, const T& slope) {
  const T half = T(0.5F) / max(slope, T(1e-20F));
  return select(r > T(2.0F), r * log(max(r, T(2.0F)) * 0.5F) * half,
                (r - 2.0F) * min(half, T(0.5F)));
}

// |z_n| <= 2 holds in a connected set, as every part of it has a zero of z_n, and those are in the
// Mandelbrot set, which is connected. So the outside has the potential G = ln(|z_n| / 2) / N,
// N = 2^n the degree of z_n, and by Koebe's theorem the distance is at least
// (1 - e^(-2 G)) / (4 |grad G|), where 1 - e^-t is at least t / (1 + t).
struct Mandelbrot {
  static constexpr OpInfo info = {
      "mandelbrot",
      OpRole::leaf,
      OpGuarantee::estimate,
      "The quaternion Mandelbrot set: the points c = (x, y, z, 0) for which the orbit of 0 stays, "
      "that is after so many iterations is within 2 of the origin. Outside never more than the "
      "distance, with a slope that may be above 1; inside it tells the side only.",
      "mandelbrot: {iterations: 12}",
      "P. Koebe's quarter theorem, as J. C. Hart, D. J. Sandin, L. H. Kauffman 1989 use it, with "
      "z' "
      "<- 2 z z' + 1, z'_0 = 0 (Krayer 3.3.6 lacks the 1)"};
  static constexpr Parameter parameters[] = {whole("iterations", 12, 1, 64, "of the orbit")};
  float iterations;

  // The set is that of the complex plane turned about x.
  template <class T>
  T distance(const Point<T>& p) const {
    const T cy = length(p.y, p.z);
    T x = p.x;
    T y = cy;
    T dx(1.0F);
    T dy(0.0F);
    T degree(1.0F);
    for (int i = 0; i < static_cast<int>(iterations); ++i) {
      const auto stays = square(x) + square(y) < T(65536.0F);
      const T u = (x * dx - y * dy) * 2.0F + 1.0F;
      const T v = (x * dy + y * dx) * 2.0F;
      const T next = square(x) - square(y) + p.x;
      y = select(stays, x * y * 2.0F + cy, y);
      x = select(stays, next, x);
      dx = select(stays, u, dx);
      dy = select(stays, v, dy);
      degree = select(stays, degree * 2.0F, degree);
    }
    const T r = length(x, y);
    const T t = log(max(r, T(2.0F)) * 0.5F) * 2.0F / degree;
    return max(escaped_distance(r, length(dx, dy)) / (t + 1.0F), length(p.x, cy) - 2.0F);
  }
  Box bounds(Data, double level) const { return cube_around(2, level); }
};

// |z'| grows as the map stretches along a meridian, n |z|^(n-1), or around the axis, where it is
// |sin(n theta) / sin(theta)| times as much.
struct Mandelbulb {
  static constexpr OpInfo info = {
      "mandelbulb",
      OpRole::leaf,
      OpGuarantee::estimate,
      "The Mandelbulb, powers in spherical coordinates: the points whose orbits are within 2 of "
      "the "
      "origin after so many iterations. Without proof: of whole powers tests find no place outside "
      "where it is more than the distance; others tear space at y = 0, x < 0. Inside it tells the "
      "side only.",
      "mandelbulb: {power: 8, iterations: 6}",
      "D. White and P. Nylander 2009; |z| ln(|z| / 2) / (2 |z'|), z' with the stretch around the "
      "axis, without which it overshoots up to 40 times"};
  static constexpr Parameter parameters[] = {number("power", 8, 2, 16, "of the map"),
                                             whole("iterations", 6, 1, 32, "of the orbit")};
  float power, iterations;
  float reach;  // no farther out is a point whose orbit stays

  // |z^n + p| >= |z|^n - |p|, so from |z| = |p| on it grows at each turn.
  void prepare(Data) {
    const auto leaves = [&](double r) {
      double z = r;
      for (int i = 0; i < static_cast<int>(iterations) && z <= 2; ++i) z = std::pow(z, power) - r;
      return z > 2;
    };
    double in = 1;
    double out = 2;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (in + out);
      (leaves(middle) ? out : in) = middle;
    }
    reach = static_cast<float>(out * 1.001);
  }
  template <class T>
  T distance(const Point<T>& p) const {
    Point<T> z = p;
    T slope(1.0F);
    for (int i = 0; i < static_cast<int>(iterations); ++i) {
      const T r = max(length(z), T(1e-6F));
      const auto stays = r < T(8.0F);
      const T raised = pow(r, power - 1);
      const T theta = acos(clamp(z.z / r, -1.0F, 1.0F)) * power;
      const T phi = atan2(z.y, z.x) * power;
      const T out = raised * r;
      const T across = sin(theta);
      const T around = clamp(abs(across) * r / max(length(z.x, z.y), T(1e-6F)), 1.0F, power);
      slope = select(stays, raised * slope * around * power + 1.0F, slope);
      z.x = select(stays, out * across * cos(phi) + p.x, z.x);
      z.y = select(stays, out * across * sin(phi) + p.y, z.y);
      z.z = select(stays, out * cos(theta) + p.z, z.z);
    }
    return max(escaped_distance(length(z), slope), length(p) - reach);
  }
  Box bounds(Data, double level) const { return cube_around(reach, level); }
};

using FractalLeaves = OpList<Menger, Sierpinski, Julia, Mandelbrot, Mandelbulb>;

}  // namespace sdfgrid::ops
