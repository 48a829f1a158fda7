#include "sdfgrid/mesh/winding_moments.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

namespace sdfgrid::winding {
namespace {

constexpr int kPair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};

// Adds what a triangle gives to the integrals about sum.center. With corners p and their sum s, the
// mean of p_j p_k over the triangle is (sum of p_j p_k over the corners + s_j s_k) / 12.
void add_triangle(Moments& sum, const Triangle& triangle) {
  const glm::dvec3 a = triangle[0] - sum.center;
  const glm::dvec3 b = triangle[1] - sum.center;
  const glm::dvec3 c = triangle[2] - sum.center;
  const glm::dvec3 s = a + b + c;
  const glm::dvec3 normal = 0.5 * glm::cross(b - a, c - a);
  std::array<double, 6> mean;
  for (int jk = 0; jk < 6; ++jk) {
    const auto [j, k] = kPair[jk];
    mean[jk] = (a[j] * a[k] + b[j] * b[k] + c[j] * c[k] + s[j] * s[k]) / 12.0;
    sum.second[jk] += normal * mean[jk];
  }
  sum.normal += normal;
  sum.first += glm::outerProduct(normal, s / 3.0);
  sum.spread += glm::length(normal) * (mean[0] + mean[1] + mean[2]);
  const double r2 = std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)});
  sum.radius = std::max(sum.radius, std::sqrt(r2));
}

// Adds a patch's integrals, moved from its own centre to sum.center.
void add_part(Moments& sum, const Moments& part) {
  const glm::dvec3 shift = part.center - sum.center;
  sum.spread += part.spread + part.area * glm::dot(shift, shift);
  sum.radius = std::max(sum.radius, glm::length(shift) + part.radius);
  sum.normal += part.normal;
  sum.first += part.first + glm::outerProduct(part.normal, shift);
  for (int jk = 0; jk < 6; ++jk) {
    const auto [j, k] = kPair[jk];
    sum.second[jk] += part.second[jk] + part.first[j] * shift[k] + part.first[k] * shift[j] +
                      part.normal * (shift[j] * shift[k]);
  }
}

double distance_to_farthest_corner(const Box& box, const glm::dvec3& p) {
  return glm::length(glm::max(glm::abs(box.lo - p), glm::abs(box.hi - p)));
}

}  // namespace

Moments moments_of(std::span<const Triangle> triangles) {
  Moments sum;
  for (const Triangle& t : triangles) {
    const double area = 0.5 * glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
    sum.area += area;
    sum.center += area / 3.0 * (t[0] + t[1] + t[2]);
    for (const glm::dvec3& corner : t) sum.box.add(corner);
  }
  sum.center /= sum.area;
  for (const Triangle& t : triangles) add_triangle(sum, t);
  return sum;
}

Moments merged(std::span<const Moments> parts) {
  Moments sum;
  for (const Moments& part : parts) {
    sum.area += part.area;
    sum.center += part.area * part.center;
    sum.box.add(part.box.lo);
    sum.box.add(part.box.hi);
  }
  sum.center /= sum.area;
  for (const Moments& part : parts) add_part(sum, part);
  sum.radius = std::min(sum.radius, distance_to_farthest_corner(sum.box, sum.center));
  return sum;
}

// With d from the point to the centre, r = |d|, and p from the centre to the surface,
// n.(p + d) / |p + d|^3 is -n.grad_p of 1/|p + d| = sum over l of |p|^l P_l(-p.d/(|p| r)) /
// r^(l+1). Degree 1: n.d / r^3. Degree 2: (n.p r^2 - 3 (p.d)(n.d)) / r^5. Degree 3: (15 (p.d)^2
// (n.d) - 3 r^2 (2 (n.p)(p.d) + |p|^2 (n.d))) / (2 r^7). Both are harmonic polynomials of d, so the
// symmetric traceless part of each moment is all of it.
std::array<double, kCoefficients> coefficients(const Moments& m) {
  const double k = 0.25 * std::numbers::inv_pi;
  const glm::dmat3 s = 0.5 * (m.first + glm::transpose(m.first));
  const double third = (s[0][0] + s[1][1] + s[2][2]) / 3.0;
  const auto c = [&](int i, int j, int l) {  // of n_i p_j p_l
    constexpr int kIndex[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    return m.second[kIndex[j][l]][i];
  };
  const auto t = [&](int i, int j, int l) { return (c(i, j, l) + c(j, i, l) + c(l, i, j)) / 3.0; };
  // Traceless part of t: t_ijj less its share of the trace; only i, j, j and x, y, z are needed.
  const auto h = [&](int i, int j) {
    return t(i, j, j) - (t(i, 0, 0) + t(i, 1, 1) + t(i, 2, 2)) / 5.0;
  };
  const double k2 = -3.0 * k;
  const double k3 = 7.5 * k;
  return {k * m.normal.x,         k * m.normal.y,     k * m.normal.z,       k2 * (s[0][0] - third),
          k2 * (s[1][1] - third), 2.0 * k2 * s[0][1], 2.0 * k2 * s[0][2],   2.0 * k2 * s[1][2],
          k3 * h(0, 1),           k3 * h(0, 2),       k3 * h(1, 0),         k3 * h(1, 2),
          k3 * h(2, 0),           k3 * h(2, 1),       6.0 * k3 * t(0, 1, 2)};
}

// The gradient of |p|^l P_l is at most l |p|^(l-1) long, and |p|^(l-1) at most radius^(l-3) |p|^2:
// so the terms from degree four on sum to no more than spread / (4 pi d^4) * sum of l rho^(l-3),
// where rho = radius / d.
double expansion_error(const Moments& m, double distance) {
  const double rho = m.radius / distance;
  const double series = rho * (4.0 / (1.0 - rho) + rho / ((1.0 - rho) * (1.0 - rho)));
  const double d2 = distance * distance;
  return 0.25 * std::numbers::inv_pi * m.spread / (d2 * d2) * series;
}

// Without the relative part, many small patches of great radius (a leaf on two parallel sheets,
// say) would each stay below the absolute error, close by, and add up.
double reach(const Moments& m, const Accuracy& accuracy) {
  const auto too_near = [&](double distance) {
    const double flat = 0.25 * std::numbers::inv_pi * m.area / (distance * distance);
    return expansion_error(m, distance) > std::min(accuracy.absolute, accuracy.relative * flat);
  };
  double lo = m.radius;
  double hi = 2.0 * m.radius;
  while (too_near(hi)) hi *= 2.0;
  for (int i = 0; i < 12; ++i) {
    const double middle = 0.5 * (lo + hi);
    (too_near(middle) ? lo : hi) = middle;
  }
  return hi;
}

}  // namespace sdfgrid::winding
