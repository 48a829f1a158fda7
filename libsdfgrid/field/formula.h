// field/formula.h: formulas as users write them.
//
//   numbers    1, 2.5, 1e-3; pi, e
//   variables  x, y, z (position) and t (time: a number when the formula is read)
//   operators  + - * / ^ (or **), parentheses; ^ binds to the right and before a sign:
//              -x^2 = -(x^2)
//   functions  those of formula_functions()
#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace sdfgrid {

// A function that formulas may call.
struct FormulaFunction {
  std::string_view name;
  int least, most;        // arguments
  const char* arguments;  // their names, as in name(arguments)
  const char* text;       // its value, in a line
};
// All of them: what the parser knows is what help and docs/shapes.md list.
[[nodiscard]] std::span<const FormulaFunction> formula_functions();

// The formula as postfix code for the ops that run it (formula_code.h). Throws Error{input} with
// the formula and a caret under the fault, also where it is of other variables than these.
[[nodiscard]] std::vector<float> parse_formula(std::string_view text, double t = 0,
                                               std::string_view variables = "xyz");

// A formula without x, y and z: its value. Throws Error{input} likewise.
[[nodiscard]] double parse_number(std::string_view text, double t = 0);

}  // namespace sdfgrid
