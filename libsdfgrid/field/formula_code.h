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
  raise,  // to the whole number that stands beside it
  root,
  absolute,
  exponential,
  logarithm,
  sine,
  cosine,
  arccosine,
  floor_of,
  sign_of,
  negative,
};

inline constexpr int kFormulaStack = 24;

constexpr bool takes_two(FormulaOp op) { return op >= FormulaOp::add && op <= FormulaOp::power; }
constexpr bool takes_one(FormulaOp op) { return op >= FormulaOp::raise; }

// a^n by squaring; of a negative n the inverse.
template <class T>
T raised(const T& a, int n) {
  T r(1.0F);
  T base = a;
  for (int m = n < 0 ? -n : n; m > 0; m /= 2) {
    if (m % 2 != 0) r = r * base;
    if (m > 1) base = square(base);
  }
  return n < 0 ? T(1.0F) / r : r;
}

template <class T>
T apply_one(FormulaOp op, const T& a, float number) {
  switch (op) {
    case FormulaOp::raise:
      return raised(a, static_cast<int>(number));
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
    default:
      return exp(log(a) * b);  // of a > 0
  }
}

template <class T>
T run_formula(Data code, const Point<T>& p) {
  T stack[kFormulaStack];
  int top = 0;
  for (int i = 0; i + 1 < code.count; i += 2) {
    const auto op = static_cast<FormulaOp>(static_cast<int>(code.values[i]));
    const float number = code.values[i + 1];
    if (op == FormulaOp::constant) {
      stack[top++] = T(number);
    } else if (op <= FormulaOp::z) {
      stack[top++] = op == FormulaOp::x ? p.x : (op == FormulaOp::y ? p.y : p.z);
    } else if (takes_two(op)) {
      --top;
      stack[top - 1] = apply_two(op, stack[top - 1], stack[top]);
    } else {
      stack[top - 1] = apply_one(op, stack[top - 1], number);
    }
  }
  return stack[0];
}

}  // namespace sdfgrid::ops
