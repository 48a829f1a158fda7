// field/formula_squares.h: formulas as steps of postfix code while they are read, and what is found
// among them: sums of squares, and products that take the jump out of a sign (internal to field/).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sdfgrid/field/formula_code.h"

namespace sdfgrid {

struct FormulaStep {
  ops::FormulaOp op;
  double number;
  bool operator==(const FormulaStep&) const = default;
};
using FormulaSteps = std::vector<FormulaStep>;

// Where the code of the uppermost value begins.
[[nodiscard]] std::size_t start_of_last(std::span<const FormulaStep> code);

// The code of values, the sum of whose squares is the one value of `code`. False if it does not
// show that it is such a sum: of even powers and products of them, of what is multiplied with
// itself, of constants from 0 on.
[[nodiscard]] bool roots_of_squares(std::span<const FormulaStep> code,
                                    std::vector<FormulaSteps>& roots);

// The code of a product of two, one of them sign(u), the other a power of u or of |u| or a product
// with such, without the sign: u sign(u) is |u|, u^n sign(u) is u^(n-1) |u|, and |u|^n sign(u) is
// |u|^(n-1) u, none of which jump. Nothing if the two are something else.
[[nodiscard]] std::optional<FormulaSteps> without_sign(std::span<const FormulaStep> a,
                                                       std::span<const FormulaStep> b);

}  // namespace sdfgrid
