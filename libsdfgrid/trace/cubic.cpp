#include "sdfgrid/trace/cubic.h"

#include <algorithm>
#include <cmath>

namespace sdfgrid {
namespace {

// The zeros of the derivative in ascending order, into roots; returns how many.
int extrema(const Cubic& cubic, double (&roots)[2]) {
  const double a = 3 * cubic.c3;
  const double b = cubic.c2;  // half of the middle coefficient
  const double c = cubic.c1;
  const double discriminant = b * b - a * c;
  if (!(discriminant > 0)) return 0;  // monotone: a double zero of the derivative changes nothing
  // Without cancellation: the larger root in magnitude first, the other from their product.
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  int count = 0;
  if (a != 0) roots[count++] = q / a;
  if (q != 0) roots[count++] = c / q;
  if (count == 2 && roots[0] > roots[1]) std::swap(roots[0], roots[1]);
  return count;
}

// The crossing in [lo, hi], where the cubic is monotone, on the side `inside` at lo and on the
// other at hi: Newton's method, with bisection wherever it would leave the bracket or shrink it too
// slowly.
double crossing_between(const Cubic& cubic, double lo, double hi, bool inside) {
  const double whole = hi - lo;
  double s = 0.5 * (lo + hi);
  double last = whole;
  for (int i = 0; i < 100; ++i) {
    const double value = cubic(s);
    ((value < 0) == inside ? lo : hi) = s;
    const double newton = s - value / cubic.derivative(s);
    const bool good = newton > lo && newton < hi && std::abs(newton - s) < 0.5 * last;
    const double next = good ? newton : 0.5 * (lo + hi);
    last = std::abs(next - s);
    if (next <= lo || next >= hi) break;
    s = next;
    if (last <= 1e-15 * whole) break;
  }
  return s;
}

}  // namespace

Cubic cell_cubic(const double (&v)[8], const glm::dvec3& from, const glm::dvec3& direction) {
  // One direction after the other: linear along z, then times y, then times x.
  double e0[4];
  double e1[4];
  for (int i = 0; i < 4; ++i) {
    const double difference = v[2 * i + 1] - v[2 * i];
    e0[i] = v[2 * i] + from.z * difference;
    e1[i] = direction.z * difference;
  }
  double q0[2];
  double q1[2];
  double q2[2];
  for (int i = 0; i < 2; ++i) {
    const double d0 = e0[2 * i + 1] - e0[2 * i];
    const double d1 = e1[2 * i + 1] - e1[2 * i];
    q0[i] = e0[2 * i] + from.y * d0;
    q1[i] = e1[2 * i] + from.y * d1 + direction.y * d0;
    q2[i] = direction.y * d1;
  }
  const double d0 = q0[1] - q0[0];
  const double d1 = q1[1] - q1[0];
  const double d2 = q2[1] - q2[0];
  return {q0[0] + from.x * d0, q1[0] + from.x * d1 + direction.x * d0,
          q2[0] + from.x * d2 + direction.x * d1, direction.x * d2};
}

std::optional<double> first_crossing(const Cubic& cubic, double length, bool inside) {
  const auto crossed = [&](double s) { return inside ? cubic(s) >= 0 : cubic(s) < 0; };
  if (crossed(0)) return 0.0;
  double roots[2];
  const int count = extrema(cubic, roots);
  double from = 0;
  for (int i = 0; i < count; ++i) {
    if (!(roots[i] > from && roots[i] < length)) continue;
    if (crossed(roots[i])) return crossing_between(cubic, from, roots[i], inside);
    from = roots[i];
  }
  if (crossed(length)) return crossing_between(cubic, from, length, inside);
  return std::nullopt;
}

}  // namespace sdfgrid
