// field/formula_code.h: a formula f(x, y, z) as postfix code that any number type can run (internal
// to field/). The code is a list of pairs of floats, an operation and a number, so that it lies
// among the constants of a program.
#pragma once

#include "sdfgrid/field/ops.h"

namespace sdfgrid::ops {

enum class FormulaOp {
  constant,  // its number
  x,
  y,
  z,
  add,
  subtract,
  multiply,
  divide,
  minimum,
  maximum,
  arctangent2,
  power,  // of two
  modulo,
  length_of_two,
  length_of_three,
  raise,     // to the whole number that stands beside it
  power_of,  // to the number above 0 that stands beside it
  root,
  absolute,
  exponential,
  logarithm,
  sine,
  cosine,
  tangent,
  arcsine,
  arccosine,
  floor_of,
  sign_of,
  negative,
};

inline constexpr int kFormulaStack = 24;

// How many values an operation takes.
constexpr int operands(FormulaOp op) {
  if (op <= FormulaOp::z) return 0;
  if (op <= FormulaOp::length_of_two) return 2;
  return op == FormulaOp::length_of_three ? 3 : 1;
}

// a^n by squaring; of a negative n the inverse.
template <class T>
T raised(const T& a, int n) {
  int m = n < 0 ? -n : n;
  if (m == 0) return T(1.0F);
  T base = a;
  for (; m % 2 == 0; m /= 2) base = square(base);
  T r = base;
  for (m /= 2; m > 0; m /= 2) {
    base = square(base);
    if (m % 2 != 0) r = r * base;
  }
  return n < 0 ? T(1.0F) / r : r;
}

template <class T>
T apply_one(FormulaOp op, const T& a, float number) {
  switch (op) {
    case FormulaOp::raise:
      return raised(a, static_cast<int>(number));
    case FormulaOp::power_of:
      return pow(a, number);
    case FormulaOp::root:
      return sqrt(a);
    case FormulaOp::absolute:
      return abs(a);
    case FormulaOp::exponential:
      return exp(a);
    case FormulaOp::logarithm:
      return log(a);
    case FormulaOp::sine:
      return sin(a);
    case FormulaOp::cosine:
      return cos(a);
    case FormulaOp::tangent:
      return sin(a) / cos(a);
    case FormulaOp::arcsine:
      return T(1.57079633F) - acos(a);
    case FormulaOp::arccosine:
      return acos(a);
    case FormulaOp::floor_of:
      return floor(a);
    case FormulaOp::sign_of:
      return sign(a);
    default:
      return -a;
  }
}

template <class T>
T apply_two(FormulaOp op, const T& a, const T& b) {
  switch (op) {
    case FormulaOp::add:
      return a + b;
    case FormulaOp::subtract:
      return a - b;
    case FormulaOp::multiply:
      return a * b;
    case FormulaOp::divide:
      return a / b;
    case FormulaOp::minimum:
      return min(a, b);
    case FormulaOp::maximum:
      return max(a, b);
    case FormulaOp::arctangent2:
      return atan2(a, b);
    case FormulaOp::modulo:
      return a - b * floor(a / b);
    case FormulaOp::length_of_two:
      return length(a, b);
    default:
      return exp(log(a) * b);  // of a > 0
  }
}

struct Unwatched {
  template <class T>
  void operator()(FormulaOp, const T&) const {}
};

// The formula at p. watch(operation, value) is told every step.
template <class T, class Watch = Unwatched>
T run_formula(Data code, const Point<T>& p, const Watch& watch = {}) {
  T stack[kFormulaStack];
  int top = 0;
  for (int i = 0; i + 1 < code.count; i += 2) {
    const auto op = static_cast<FormulaOp>(static_cast<int>(code.values[i]));
    const float number = code.values[i + 1];
    top += 1 - operands(op);
    T& out = stack[top - 1];
    if (op == FormulaOp::constant) {
      out = T(number);
    } else if (op <= FormulaOp::z) {
      out = op == FormulaOp::x ? p.x : (op == FormulaOp::y ? p.y : p.z);
    } else if (op == FormulaOp::length_of_three) {
      out = length(out, stack[top], stack[top + 1]);
    } else if (operands(op) == 2) {
      out = apply_two(op, out, stack[top]);
    } else {
      out = apply_one(op, out, number);
    }
    watch(op, out);
  }
  return stack[0];
}

}  // namespace sdfgrid::ops
