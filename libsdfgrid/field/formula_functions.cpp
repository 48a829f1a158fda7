// The functions that formulas may call.
#include <array>

#include "sdfgrid/field/formula.h"

namespace sdfgrid {
namespace {

constexpr const char* kOne = "x";
constexpr std::array kFunctions = {
    FormulaFunction{"sqrt", 1, 1, kOne, "square root; 0 below 0"},
    FormulaFunction{"abs", 1, 1, kOne, "absolute value"},
    FormulaFunction{"exp", 1, 1, kOne, "e^x; x counts as at most 88"},
    FormulaFunction{"log", 1, 1, kOne, "natural logarithm, of x > 0"},
    FormulaFunction{"sin", 1, 1, kOne, "sine of an angle in radians"},
    FormulaFunction{"cos", 1, 1, kOne, "cosine of an angle in radians"},
    FormulaFunction{"tan", 1, 1, kOne, "tangent of an angle in radians"},
    FormulaFunction{"asin", 1, 1, kOne, "angle from -pi/2 to pi/2; beyond -1 and 1 as there"},
    FormulaFunction{"acos", 1, 1, kOne, "angle from 0 to pi; beyond -1 and 1 as there"},
    FormulaFunction{"atan", 1, 1, kOne, "angle from -pi/2 to pi/2"},
    FormulaFunction{"sinh", 1, 1, kOne, "(e^x - e^-x) / 2"},
    FormulaFunction{"cosh", 1, 1, kOne, "(e^x + e^-x) / 2"},
    FormulaFunction{"tanh", 1, 1, kOne, "sinh(x) / cosh(x)"},
    FormulaFunction{"floor", 1, 1, kOne, "the largest whole number that is not above x"},
    FormulaFunction{"sign", 1, 1, kOne, "-1 below 0, else 1"},
    FormulaFunction{"atan2", 2, 2, "y, x", "angle of the point (x, y), from -pi to pi"},
    FormulaFunction{"pow", 2, 2, "x, y", "x^y; x > 0 unless y is a whole constant"},
    FormulaFunction{"mod", 2, 2, "x, y", "x - y * floor(x / y)"},
    FormulaFunction{"min", 2, 64, "x, y, ...", "the least"},
    FormulaFunction{"max", 2, 64, "x, y, ...", "the largest"},
};

}  // namespace

std::span<const FormulaFunction> formula_functions() { return kFunctions; }

}  // namespace sdfgrid
