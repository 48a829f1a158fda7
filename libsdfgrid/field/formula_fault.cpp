#include "sdfgrid/field/formula_fault.h"

#include "sdfgrid/field/dual.h"
#include "sdfgrid/field/field_reading.h"
#include "sdfgrid/field/formula_code.h"

namespace sdfgrid {
namespace {

using ops::FormulaOp;

FormulaFault named(FormulaOp op) {
  switch (op) {
    case FormulaOp::floor_of:
      return {"floor", true};
    case FormulaOp::sign_of:
      return {"sign", true};
    case FormulaOp::modulo:
      return {"mod", true};
    case FormulaOp::arctangent2:
      return {"atan2", true};
    case FormulaOp::root:
      return {"sqrt", false};
    case FormulaOp::logarithm:
      return {"log", false};
    case FormulaOp::tangent:
      return {"tan", false};
    case FormulaOp::arcsine:
      return {"asin", false};
    case FormulaOp::arccosine:
      return {"acos", false};
    case FormulaOp::power:
    case FormulaOp::power_of:
    case FormulaOp::raise:
      return {"^", false};
    case FormulaOp::divide:
      return {"/", false};
    default:
      return {};
  }
}

}  // namespace

FormulaFault formula_fault(ops::Data code, const Box& box) {
  using D = ops::Dual<ops::Interval, 3>;
  const auto p = intervals(box);
  FormulaFault fault;
  bool found = false;
  ops::run_formula(code,
                   ops::Point<D>{D::variable(p.x, 0), D::variable(p.y, 1), D::variable(p.z, 2)},
                   [&](FormulaOp op, const D& value) {
                     if (!found && !(value.steepness.most < ops::kInfinity)) fault = named(op);
                     found = found || !(value.steepness.most < ops::kInfinity);
                   });
  return fault;
}

}  // namespace sdfgrid
