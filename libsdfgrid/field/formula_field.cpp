// Makes fields of formulas; declared in formulas.h.
#include <fmt/format.h>

#include <algorithm>

#include "sdfgrid/field/build.h"
#include "sdfgrid/field/formula.h"
#include "sdfgrid/field/formulas.h"
#include "sdfgrid/field/graph_profile.h"
#include "sdfgrid/field/polynomial.h"
#include "sdfgrid/field/smooth_interval.h"

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

// An upper bound on a function of one variable over a range, and whether it is continuous there.
struct Extent {
  double largest = -kInfinity;
  bool continuous = true;
};
Extent extent_over(const std::vector<float>& code, double from, double to) {
  constexpr int kParts = 256;
  Extent all;
  for (int i = 0; i < kParts; ++i) {
    const double a = from + (to - from) * i / kParts;
    const double b = from + (to - from) * (i + 1) / kParts;
    using I = SmoothInterval;
    const I f = run_formula(Data{code.data(), static_cast<int>(code.size())},
                            Point<I>{I(Interval(a, b)), I(0), I(0)});
    all.largest = std::fmax(all.largest, f.v.hi);
    all.continuous = all.continuous && f.is.continuous;
  }
  return all;
}

// The exact form of a function's solid, if it has one.
std::optional<Field> closed_form(const std::vector<float>& code, const FunctionGraph& shape) {
  const Data data = {code.data(), static_cast<int>(code.size())};
  const Polynomial f =
      run_formula(data, Point<Polynomial>{Polynomial::variable(), Polynomial(0), Polynomial(0)});
  if (!f.known()) return {};
  FunctionGraph op = shape;
  const double from = shape.from;
  const double width = static_cast<double>(shape.to) - from;
  const double start = f.c[0] + from * (f.c[1] + from * f.c[2]);
  const double slope = f.c[1] + 2 * from * f.c[2];  // at the start
  const double bend = f.c[2] * width * width;
  const double end = start + slope * width + bend;
  op.graph.set(
      {{from, start, 0}, {from + 0.5 * width, start + 0.5 * slope * width, 0}, {shape.to, end, 0}});
  const double low = shape.mode == 2 ? static_cast<double>(shape.bottom) : 0;
  const double vertex = bend > 0 ? -f.c[1] / (2 * f.c[2]) : from;
  double least = std::fmin(start, end);
  if (vertex > from && vertex < shape.to) least = f.c[0] - f.c[1] * f.c[1] / (4 * f.c[2]);
  // So nearly straight that the arc's closed form would cancel.
  const bool slight = bend != 0 && std::fabs(slope * width) > 50 * std::fabs(bend);
  if (least < low || slight) return {};
  for (int i = 0; i < 3; ++i) op.coefficients[i] = static_cast<float>(f.c[i]);
  op.ends[0] = static_cast<float>(start);
  op.ends[1] = static_cast<float>(end);
  const auto* first = reinterpret_cast<const float*>(&op);
  return make_leaf(op_number("function_graph"), {first, first + sizeof op / sizeof(float)}, {});
}

}  // namespace

Field Function::make(const std::vector<Argument>& given) {
  const CheckedArguments arguments({&info, parameters}, given);
  const std::vector<float> code =
      parse_formula(arguments.text("f", nullptr), arguments.number("t"), "x");
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
  const auto [largest, continuous] = extent_over(code, from, to);
  if (!(largest < kAny)) throw arguments.refused("the function has no bound on its range");
  FunctionGraph shape{};
  shape.mode = static_cast<float>(found - kModes);
  shape.from = static_cast<float>(from);
  shape.to = static_cast<float>(to);
  shape.bottom = static_cast<float>(arguments.number("floor"));
  shape.depth = static_cast<float>(arguments.number("depth"));
  shape.largest = static_cast<float>(largest);
  if (const std::optional<Field> closed = closed_form(code, shape)) return *closed;
  const Data data = {code.data(), static_cast<int>(code.size())};
  const double low = shape.mode == 2 ? static_cast<double>(shape.bottom) : 0;
  const std::optional<GraphProfile> profile =
      make_graph_profile(data, {from, to, low, largest, shape.mode != 2});
  if (!profile) {
    if (!continuous) {
      throw arguments.refused(
          "`f` jumps where it oscillates or rises without end; give a range without that");
    }
    const std::vector<float> constants = {shape.mode,   shape.from,  shape.to,
                                          shape.bottom, shape.depth, shape.largest};
    const Field bound = make_leaf(op_number("function_bound"), constants, code);
    return bounded_by_region(info, bound);
  }
  if (profile->count == 0) return {};
  const std::vector<double> constants = {
      shape.mode,  profile->from,    profile->to,          shape.bottom,
      shape.depth, profile->largest, 1.0 * profile->count, 1.0 * profile->leaves};
  return make_leaf(op_number("function"), {constants.begin(), constants.end()}, profile->list);
}

}  // namespace sdfgrid::ops
