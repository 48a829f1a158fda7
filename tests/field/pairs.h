// tests/field/pairs.h: whether a function of points is as gentle as it claims to be, by pairs of
// points near and far.
#pragma once

#include <functional>
#include <random>
#include <vector>

#include "sdfgrid/field/field.h"

struct Points {
  std::vector<float> x, y, z, value;
  explicit Points(std::size_t n) : x(n), y(n), z(n), value(n) {}
  void evaluate(const sdfgrid::Field& f) {
    f.evaluate(x.size(), x.data(), y.data(), z.data(), value.data());
  }
  [[nodiscard]] glm::dvec3 at(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

Points random_points(std::size_t n, const sdfgrid::Box& box, std::mt19937& random);

// What single precision may add to a difference of two values: the ops' intermediate results are
// no larger than a few times the coordinates.
constexpr double kRounding = 4e-6;

// By how much |f(p) - f(q)| exceeds constant * |p - q| at worst, of seeded pairs in the box; `f`
// sets the values of points. Infinite if a value is not a number.
double pair_excess(const std::function<void(Points&)>& f, const sdfgrid::Box& box,
                   double constant = 1, std::size_t pairs = 100000);
double pair_excess(const sdfgrid::Field& f, const sdfgrid::Box& box);
