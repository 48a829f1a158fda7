// trace/cubic.h: the trilinear field of one cell along a ray, which is a cubic, and its first
// change of sign, in double. Hansson-Soderlund, Evans and Akenine-Moller, "Ray Tracing of Signed
// Distance Function Grids", JCGT 11(3), 2022, compare ways to do this; here the cubic is split
// where its derivative is zero, so that in each piece it is monotone and a bracket holds one root.
#pragma once

#include <glm/vec3.hpp>
#include <optional>

namespace sdfgrid {

struct Cubic {
  double c0 = 0;
  double c1 = 0;
  double c2 = 0;
  double c3 = 0;

  [[nodiscard]] double operator()(double s) const { return ((c3 * s + c2) * s + c1) * s + c0; }
  [[nodiscard]] double derivative(double s) const { return (3 * c3 * s + 2 * c2) * s + c1; }
};

// The trilinear field of a cell at from + s * direction, where `from` is relative to the cell's
// lowest corner in cell lengths; corners in the order x, y, z with z fastest.
[[nodiscard]] Cubic cell_cubic(const double (&corners)[8], const glm::dvec3& from,
                               const glm::dvec3& direction);

// The first s in [0, length] from which on the cubic is negative, if `inside` is false, or not
// negative, if it is true; nothing if it keeps its side. `inside` is the side on which the ray
// comes: 0 is the answer if the cubic starts on the other one. Exact to rounding.
[[nodiscard]] std::optional<double> first_crossing(const Cubic& cubic, double length, bool inside);

}  // namespace sdfgrid
