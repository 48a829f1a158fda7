// field/formula.h: formulas as users write them.
//
//   numbers    1, 2.5, 1e-3; pi, e
//   variables  x, y, z (position) and t (time: a number when the formula is read)
//   operators  + - * / ^ (or **), parentheses; ^ binds to the right and before a sign: -x^2 =
//   -(x^2) functions  sqrt abs exp log sin cos tan asin acos atan sinh cosh tanh floor sign (one
//   argument),
//              atan2(y, x), min, max, pow, mod (two or more for min and max)
#pragma once

#include <string_view>
#include <vector>

namespace sdfgrid {

// The formula as postfix code for the ops that run it (formula_code.h). Throws Error{input} with
// the formula and a caret under the fault.
[[nodiscard]] std::vector<float> parse_formula(std::string_view text, double t = 0);

// A formula without x, y and z: its value. Throws Error{input} likewise.
[[nodiscard]] double parse_number(std::string_view text, double t = 0);

}  // namespace sdfgrid
