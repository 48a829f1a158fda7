// Makes fields of formulas; declared in formulas.h.
#include <fmt/format.h>

#include <algorithm>

#include "sdfgrid/field/build.h"
#include "sdfgrid/field/formula.h"
#include "sdfgrid/field/formulas.h"

namespace sdfgrid::ops {
namespace {

std::optional<Box> region_of(const CheckedArguments& arguments) {
  if (!arguments.has("bounds")) return {};
  const std::vector<double> v = arguments.numbers("bounds");
  if (v.size() != 6) throw arguments.refused("`bounds` are two corners, [[x, y, z], [x, y, z]]");
  Box box;
  box.add({v[0], v[1], v[2]});
  box.add({v[3], v[4], v[5]});
  return box;
}

}  // namespace

Field Formula::make(const std::vector<Argument>& given) {
  const CheckedArguments arguments({&info, parameters}, given);
  const std::vector<float> code =
      parse_formula(arguments.text("f", nullptr), arguments.number("t"));
  const std::string order = arguments.text("order", "certified");
  const std::optional<Box> region = region_of(arguments);
  const Field raw = make_leaf(op_number("formula"), {}, code);
  if (order == "certified") return bounded_by_region(info, raw, region);
  if (order != "1" && order != "2") {
    throw arguments.refused(fmt::format("`order` is `{}`; give certified, 1 or 2", order));
  }
  const Box box = region ? *region : raw.bounds();
  check_finite(info, box);
  if (box.empty()) return {};
  return within_region(make_leaf(op_number(order == "1" ? "formula_1" : "formula_2"), {}, code),
                       box, 1);
}

}  // namespace sdfgrid::ops
