// field/polynomial.h: polynomials up to the second degree as a number type: run over a formula it
// tells whether the formula is one, and which (internal to field/).
#pragma once

#include <array>
#include <cmath>

#include "sdfgrid/field/number.h"

namespace sdfgrid::ops {

// c[0] + c[1] x + c[2] x^2; NaN once it is no such polynomial.
struct Polynomial {
  std::array<double, 3> c = {0, 0, 0};

  Polynomial() = default;
  Polynomial(double v) : c{v, 0, 0} {}
  static Polynomial variable() {
    Polynomial p;
    p.c[1] = 1;
    return p;
  }
  static Polynomial none() { return {std::nan("")}; }
  [[nodiscard]] bool known() const {
    return std::isfinite(c[0]) && std::isfinite(c[1]) && std::isfinite(c[2]);
  }
  [[nodiscard]] int degree() const { return c[2] != 0 ? 2 : (c[1] != 0 ? 1 : 0); }
};

inline Polynomial operator+(const Polynomial& a, const Polynomial& b) {
  Polynomial r;
  for (int i = 0; i < 3; ++i) r.c[i] = a.c[i] + b.c[i];
  return r;
}
inline Polynomial operator-(const Polynomial& a) {
  Polynomial r;
  for (int i = 0; i < 3; ++i) r.c[i] = -a.c[i];
  return r;
}
inline Polynomial operator-(const Polynomial& a, const Polynomial& b) { return a + -b; }
inline Polynomial operator*(const Polynomial& a, const Polynomial& b) {
  if (!a.known() || !b.known() || a.degree() + b.degree() > 2) return Polynomial::none();
  Polynomial r;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; i + j < 3; ++j) r.c[i + j] += a.c[i] * b.c[j];
  }
  return r;
}
inline Polynomial square(const Polynomial& a) { return a * a; }
inline Polynomial operator/(const Polynomial& a, const Polynomial& b) {
  return b.known() && b.degree() == 0 ? a * Polynomial(1 / b.c[0]) : Polynomial::none();
}

// Parsed formulas have no other functions of constants left (formula.cpp folds them).
inline Polynomial sqrt(const Polynomial&) { return Polynomial::none(); }
inline Polynomial abs(const Polynomial&) { return Polynomial::none(); }
inline Polynomial exp(const Polynomial&) { return Polynomial::none(); }
inline Polynomial log(const Polynomial&) { return Polynomial::none(); }
inline Polynomial sin(const Polynomial&) { return Polynomial::none(); }
inline Polynomial cos(const Polynomial&) { return Polynomial::none(); }
inline Polynomial acos(const Polynomial&) { return Polynomial::none(); }
inline Polynomial floor(const Polynomial&) { return Polynomial::none(); }
inline Polynomial sign(const Polynomial&) { return Polynomial::none(); }
inline Polynomial min(const Polynomial&, const Polynomial&) { return Polynomial::none(); }
inline Polynomial max(const Polynomial&, const Polynomial&) { return Polynomial::none(); }
inline Polynomial pow(const Polynomial&, float) { return Polynomial::none(); }
inline Polynomial atan2(const Polynomial&, const Polynomial&) { return Polynomial::none(); }

}  // namespace sdfgrid::ops
