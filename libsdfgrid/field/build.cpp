#include "sdfgrid/field/build.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sdfgrid/field/field_reading.h"
#include "sdfgrid/field/formula_fault.h"
#include "sdfgrid/field/slope.h"

namespace sdfgrid {
namespace {

using ops::kInfinity;

Error refused_op(const OpInfo& op, const std::string& what) {
  return {ErrorKind::input, fmt::format("{}: {}", op.name, what)};
}

}  // namespace

CheckedArguments::CheckedArguments(const OpEntry& op, const std::vector<Argument>& arguments)
    : op_(op), arguments_(arguments) {
  for (const Argument& argument : arguments) {
    const auto known = [&](const Parameter& p) { return argument.name == p.name; };
    if (std::any_of(op.parameters.begin(), op.parameters.end(), known)) continue;
    std::string names;
    for (const Parameter& p : op.parameters) {
      names += fmt::format("{}`{}`", names.empty() ? "" : ", ", p.name);
    }
    throw refused(fmt::format("there is no parameter `{}`; it has {}", argument.name,
                              names.empty() ? "none" : names));
  }
}

Error CheckedArguments::refused(const std::string& what) const {
  return refused_op(*op_.info, what);
}

const Argument* CheckedArguments::find(std::string_view name) const {
  const auto found = std::find_if(arguments_.begin(), arguments_.end(),
                                  [&](const Argument& a) { return a.name == name; });
  return found == arguments_.end() ? nullptr : &*found;
}

const Parameter& CheckedArguments::parameter(std::string_view name) const {
  return *std::find_if(op_.parameters.begin(), op_.parameters.end(),
                       [&](const Parameter& p) { return p.name == name; });
}

std::string CheckedArguments::text(std::string_view name, const char* fallback) const {
  const Argument* argument = find(name);
  if (argument == nullptr) {
    if (fallback != nullptr) return fallback;
    throw refused(fmt::format("`{}` is missing ({})", name, parameter(name).text));
  }
  if (const auto* text = std::get_if<std::string>(&argument->value)) return *text;
  const auto& numbers = std::get<std::vector<double>>(argument->value);
  if (numbers.size() == 1) return fmt::format("{:g}", numbers[0]);
  throw refused(fmt::format("`{}` must be a text", name));
}

std::vector<double> CheckedArguments::numbers(std::string_view name) const {
  const Parameter& p = parameter(name);
  const Argument* argument = find(name);
  const int width = width_of(p.kind);
  std::vector<double> v;
  if (argument != nullptr) {
    const auto* given = std::get_if<std::vector<double>>(&argument->value);
    if (given == nullptr) throw refused(fmt::format("`{}` must be a number", name));
    v = *given;
  } else if (std::isnan(p.fallback[0])) {
    throw refused(fmt::format("`{}` is missing ({})", name, p.text));
  } else if (p.kind == ParameterKind::matrix) {
    v = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  } else if (width > 0) {
    v.assign(p.fallback, p.fallback + width);
  }
  const bool spreads = width == 2 || width == 3;
  if (spreads && v.size() == 1 && p.lo > 0) v.assign(static_cast<std::size_t>(width), v[0]);
  if (width > 0 && static_cast<int>(v.size()) != width) {
    throw refused(fmt::format("`{}` has {} numbers; give {}", name, v.size(), width));
  }
  if (p.kind == ParameterKind::points && v.size() % 3 != 0) {
    throw refused(fmt::format("`{}` is a list of triples, but has {} numbers", name, v.size()));
  }
  for (const double number : v) {
    const bool unlimited = std::isinf(number) && number == p.hi;
    if (!std::isfinite(number) && !unlimited) {
      throw refused(fmt::format("`{}` is not a finite number", name));
    }
    if (number < p.lo || number > p.hi) {
      throw refused(
          fmt::format("`{}` is {:g}; give a value from {:g} to {:g}", name, number, p.lo, p.hi));
    }
    if (p.kind == ParameterKind::whole && number != std::floor(number)) {
      throw refused(fmt::format("`{}` is {:g}; give a whole number", name, number));
    }
  }
  return v;
}

int width_of(ParameterKind kind) {
  switch (kind) {
    case ParameterKind::pair:
      return 2;
    case ParameterKind::vector:
      return 3;
    case ParameterKind::matrix:
      return 9;
    case ParameterKind::number:
    case ParameterKind::whole:
      return 1;
    case ParameterKind::numbers:
    case ParameterKind::points:
    case ParameterKind::text:
      break;
  }
  return 0;
}

Instruction add_op(Draft& draft, int number, std::vector<float> parameters,
                   const std::vector<float>& list) {
  const RegisteredOp& op = registry()[number];
  parameters.resize(op.floats);
  if (op.prepare != nullptr) {
    op.prepare(parameters.data(), {list.data(), static_cast<int>(list.size())});
  }
  const auto finite = [](float v) { return std::isfinite(v); };
  if (!std::all_of(parameters.begin(), parameters.end(), finite)) {
    throw refused_op(*op.entry.info,
                     "its parameters make no solid: a direction of length 0, or sizes "
                     "too far apart");
  }
  std::vector<float>& constants = draft.pool.constants;
  Instruction at{};
  at.op = static_cast<std::uint16_t>(number);
  at.constants = static_cast<std::uint32_t>(constants.size());
  constants.insert(constants.end(), parameters.begin(), parameters.end());
  at.data = static_cast<std::uint32_t>(constants.size());
  at.count = static_cast<std::uint32_t>(list.size());
  constants.insert(constants.end(), list.begin(), list.end());
  at.tag = -1;
  return at;
}

Field make_leaf(int number, const std::vector<float>& parameters, const std::vector<float>& list) {
  Draft draft;
  draft.code.push_back(add_op(draft, number, parameters, list));
  draft.code.back().step = Step::leaf;
  return make_field(std::move(draft));
}

void append_around(Draft& draft, Instruction at, const Program& node) {
  const bool domain = registry()[at.op].entry.info->role == OpRole::domain;
  at.step = Step::enter;
  if (domain) draft.code.push_back(at);
  append(draft, node);
  at.step = domain ? Step::leave : Step::range;
  draft.code.push_back(at);
}

Field make_unary(int number, const std::vector<float>& parameters, const Field& node) {
  Draft draft;
  const Instruction at = add_op(draft, number, parameters, {});
  append_around(draft, at, node.program());
  return make_field(std::move(draft));
}

void check_finite(const OpInfo& op, const Box& box) {
  for (int a = 0; a < 3; ++a) {
    if (std::isfinite(box.lo[a]) && std::isfinite(box.hi[a])) continue;
    throw refused_op(
        op, fmt::format(
                "its slope is bounded only over a bounded region, but the node "
                "has no end along {}; {}",
                "xyz"[a],
                op.role == OpRole::leaf ? "give it `bounds`" : "intersect the node with a box"));
  }
}

Field within_region(const Field& raw, const Box& box, double slope) {
  const glm::dvec3 half = 0.5 * box.size();
  const glm::dvec3 c = box.center();
  std::vector<float> parameters;
  for (const double v : {c.x, c.y, c.z, half.x, half.y, half.z, 1 / slope}) {
    parameters.push_back(static_cast<float>(v));
  }
  return make_unary(op_number("region"), parameters, raw);
}

namespace {

// The box as the region op holds it, its middle and half its edges as floats.
Box held_region(const Box& box) {
  Box held;
  for (int a = 0; a < 3; ++a) {
    const auto center = static_cast<float>(box.center()[a]);
    const auto half = static_cast<float>(0.5 * box.size()[a]);
    held.lo[a] = center - half;
    held.hi[a] = center + half;
  }
  return held;
}

std::string written(const glm::dvec3& p) {
  return fmt::format("({:g}, {:g}, {:g})", p.x, p.y, p.z);
}

// Why a slope has no bound: `raw` ends with the op.
FormulaFault fault_of(const OpInfo& op, const Field& raw, const Box& cell) {
  const std::string_view name = op.name;
  if (name != "formula" && name != "formula_displace") return {};
  return formula_fault(ops::data_of(raw.program(), raw.program().code.back()), cell);
}

const char* remedy_of(std::string_view op) {
  if (op == "formula") return "give other `bounds`, or order: 1, an estimate without a bound";
  if (op == "formula_displace") return "use another formula, or a node that is not near there";
  if (op == "function") return "give another range by `from` and `to`";
  return "use smaller parameters or another region";
}

constexpr double kSteepest = 1e6;

std::string too_steep(const OpInfo& op, const Field& raw, const Box& region,
                      const Steepest& steepest) {
  const char* const remedy = remedy_of(op.name);
  const std::string where =
      fmt::format("on the region from {} to {}", written(region.lo), written(region.hi));
  if (steepest.slope < kInfinity) {
    const bool formula = std::string_view(op.name) == "formula";
    return fmt::format(
        "its slope may be {:.3g} {}, and {:g} is the most; {}{}", steepest.slope, where, kSteepest,
        formula ? "divide the formula by a number, which moves no surface, or " : "", remedy);
  }
  const std::string near = written(steepest.cell.center());
  const FormulaFault fault = fault_of(op, raw, steepest.cell);
  if (fault.jumps) {
    return fmt::format(
        "`{}` jumps {}, near {}, where no step is safe; `repeat` makes copies of a solid, abs, min "
        "and max make kinks, `function` takes jumps of one variable; else {}",
        fault.name, where, near, remedy);
  }
  if (fault.name != nullptr) {
    return fmt::format("`{}` has a slope without bound {}, near {}; {}", fault.name, where, near,
                       remedy);
  }
  return fmt::format("its slope has no bound {}; keep away from where it degenerates: {}", where,
                     remedy);
}

}  // namespace

Field bounded_by_region(const OpInfo& op, const Field& raw, const std::optional<Box>& given) {
  Box box = given ? *given : raw.bounds();
  if (box.empty()) return {};
  check_finite(op, box);
  if (!given) {
    // A little more, so that the region's faces do not touch the surface.
    const glm::dvec3 size = box.size();
    const double margin = 1e-4 * std::max({size.x, size.y, size.z, 1e-3});
    const glm::dvec3 more = 0.01 * size + glm::dvec3(margin);
    box = {box.lo - more, box.hi + more};
  }
  const Steepest steepest = refined_slope(raw.program(), held_region(box));
  if (!(steepest.slope < kSteepest)) throw refused_op(op, too_steep(op, raw, box, steepest));
  return within_region(raw, box, std::max(steepest.slope * 1.000001, 1e-6));
}

}  // namespace sdfgrid
