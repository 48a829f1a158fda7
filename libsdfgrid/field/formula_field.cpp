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

namespace {

// An upper bound on a function of one variable over a range.
double largest_over(const std::vector<float>& code, double from, double to) {
  constexpr int kParts = 256;
  double largest = -kInfinity;
  for (int i = 0; i < kParts; ++i) {
    const double a = from + (to - from) * i / kParts;
    const double b = from + (to - from) * (i + 1) / kParts;
    const Interval v = run_formula(Data{code.data(), static_cast<int>(code.size())},
                                   Point<Interval>{Interval(a, b), Interval(0), Interval(0)});
    largest = std::fmax(largest, v.hi);
  }
  return largest;
}

}  // namespace

Field Function::make(const std::vector<Argument>& given) {
  const CheckedArguments arguments({&info, parameters}, given);
  const std::vector<float> code =
      parse_formula(arguments.text("f", nullptr), arguments.number("t"));
  const double from = arguments.number("from");
  const double to = arguments.number("to");
  if (!(from < to)) throw arguments.refused("`from` must be less than `to`");
  const std::string mode = arguments.text("mode", "revolve_z");
  const char* const kModes[] = {"revolve_z", "revolve_x", "extrude"};
  const auto* found = std::find(std::begin(kModes), std::end(kModes), mode);
  if (found == std::end(kModes)) {
    throw arguments.refused(
        fmt::format("`mode` is `{}`; give revolve_z, revolve_x or extrude", mode));
  }
  const double largest = largest_over(code, from, to);
  if (!(largest < kAny)) throw arguments.refused("the function has no bound on its range");
  std::vector<float> constants;
  for (const double v : {static_cast<double>(found - kModes), from, to, arguments.number("floor"),
                         arguments.number("depth"), largest}) {
    constants.push_back(static_cast<float>(v));
  }
  return bounded_by_region(info, make_leaf(op_number("function"), constants, code));
}

}  // namespace sdfgrid::ops
