// field/formula_squares.h: formulas as steps of postfix code while they are read, and sums of
// squares among them (internal to field/).
#pragma once

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

}  // namespace sdfgrid
