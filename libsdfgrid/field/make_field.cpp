// Makes fields by name: arguments checked against the op's parameters, programs joined.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sdfgrid/core/error.h"
#include "sdfgrid/field/program_data.h"
#include "sdfgrid/field/registry.h"
#include "sdfgrid/field/slope.h"

namespace sdfgrid {
namespace {

Error refused(const OpInfo& op, const std::string& what) {
  return {ErrorKind::input, fmt::format("{}: {}", op.name, what)};
}

int width_of(ParameterKind kind) {
  switch (kind) {
    case ParameterKind::vector:
      return 3;
    case ParameterKind::matrix:
      return 9;
    case ParameterKind::number:
    case ParameterKind::whole:
      return 1;
    default:
      return 0;  // stands in the op's list, not in its struct
  }
}

void check_number(const OpInfo& op, const Parameter& parameter, double v) {
  if (!std::isfinite(v)) {
    throw refused(op, fmt::format("`{}` is not a finite number", parameter.name));
  }
  if (v < parameter.lo || v > parameter.hi) {
    throw refused(op, fmt::format("`{}` is {:g}; give a value from {:g} to {:g}", parameter.name, v,
                                  parameter.lo, parameter.hi));
  }
  if (parameter.kind == ParameterKind::whole && v != std::floor(v)) {
    throw refused(op, fmt::format("`{}` is {:g}; give a whole number", parameter.name, v));
  }
}

// The numbers of one parameter as the op's struct or list holds them.
std::vector<float> numbers_of(const OpInfo& op, const Parameter& parameter,
                              const Argument* argument) {
  const int width = width_of(parameter.kind);
  std::vector<double> v;
  if (argument != nullptr) {
    const auto* given = std::get_if<std::vector<double>>(&argument->value);
    if (given == nullptr) throw refused(op, fmt::format("`{}` must be a number", parameter.name));
    v = *given;
  } else if (std::isnan(parameter.fallback[0])) {
    throw refused(op, fmt::format("`{}` is missing ({})", parameter.name, parameter.text));
  } else if (width > 0) {
    v.assign(parameter.fallback, parameter.fallback + std::min(width, 3));
  }
  if (width == 3 && v.size() == 1 && parameter.lo > 0) v.assign(3, v[0]);
  if (width > 0 && static_cast<int>(v.size()) != width) {
    throw refused(op, fmt::format("`{}` has {} numbers; give {}", parameter.name, v.size(), width));
  }
  if (parameter.kind == ParameterKind::points && v.size() % 3 != 0) {
    throw refused(
        op, fmt::format("`{}` is a list of triples, but has {} numbers", parameter.name, v.size()));
  }
  for (const double number : v) check_number(op, parameter, number);
  return {v.begin(), v.end()};
}

void check_names(const OpEntry& entry, const std::vector<Argument>& arguments) {
  for (const Argument& argument : arguments) {
    const auto known = [&](const Parameter& p) { return argument.name == p.name; };
    if (std::any_of(entry.parameters.begin(), entry.parameters.end(), known)) continue;
    std::string names;
    for (const Parameter& p : entry.parameters) {
      names += fmt::format("{}`{}`", names.empty() ? "" : ", ", p.name);
    }
    throw refused(*entry.info, fmt::format("there is no parameter `{}`; it has {}", argument.name,
                                           names.empty() ? "none" : names));
  }
}

// An instruction for the op, its struct and list appended to the program's constants.
Instruction add_op(Draft& program, int number, const std::vector<Argument>& arguments) {
  const RegisteredOp& op = registry()[number];
  std::vector<float> fixed;
  std::vector<float> list;
  for (const Parameter& parameter : op.entry.parameters) {
    const auto named = [&](const Argument& a) { return a.name == parameter.name; };
    const auto found = std::find_if(arguments.begin(), arguments.end(), named);
    const auto numbers =
        numbers_of(*op.entry.info, parameter, found == arguments.end() ? nullptr : &*found);
    auto& to = width_of(parameter.kind) > 0 ? fixed : list;
    to.insert(to.end(), numbers.begin(), numbers.end());
  }
  fixed.resize(op.floats);
  if (op.prepare != nullptr) {
    op.prepare(fixed.data(), {list.data(), static_cast<int>(list.size())});
  }
  Instruction at{};
  at.op = static_cast<std::uint16_t>(number);
  at.constants = static_cast<std::uint32_t>(program.pool.constants.size());
  program.pool.constants.insert(program.pool.constants.end(), fixed.begin(), fixed.end());
  at.data = static_cast<std::uint32_t>(program.pool.constants.size());
  at.count = static_cast<std::uint32_t>(list.size());
  program.pool.constants.insert(program.pool.constants.end(), list.begin(), list.end());
  at.tag = -1;
  return at;
}

// Joins fields two by two, halves first, so that the program's stack stays shallow however many
// there are.
void append_joined(Draft& program, std::span<const Field> of, const Instruction& join) {
  if (of.size() == 1) {
    append(program, of[0].program());
    return;
  }
  const std::size_t half = (of.size() + 1) / 2;
  append_joined(program, of.first(half), join);
  append_joined(program, of.subspan(half), join);
  program.code.push_back(join);
}

// The op that joins the rest of a difference.
int rest_number(int number) {
  if (number == op_number("difference")) return op_number("union");
  if (number == op_number("smooth_difference")) return op_number("smooth_union");
  return number;
}

void append_combination(Draft& program, int number, const std::vector<Argument>& arguments,
                        std::span<const Field> of) {
  Instruction last = add_op(program, number, arguments);
  last.step = Step::combine;
  const int rest = rest_number(number);
  if (rest == number || of.size() < 3) return append_joined(program, of, last);
  Instruction join = add_op(program, rest, arguments);
  join.step = Step::combine;
  append(program, of[0].program());
  append_joined(program, of.subspan(1), join);
  program.code.push_back(last);
}

// Refuses a box without end: nothing bounds a slope over all of space.
void check_finite(const OpInfo& op, const Box& box) {
  for (int a = 0; a < 3; ++a) {
    if (std::isfinite(box.lo[a]) && std::isfinite(box.hi[a])) continue;
    throw refused(op,
                  fmt::format("its slope is bounded only over a bounded region, but the node has "
                              "no end along {}; intersect the node with a box",
                              "xyz"[a]));
  }
}

// A leaf is moved by its own offset, which costs next to nothing.
bool append_moved_leaf(Draft& draft, const Field& node, const float by[3]) {
  if (node.size() != 1 || node.program().code[0].step != Step::leaf) return false;
  append(draft, node.program());
  for (int a = 0; a < 3; ++a) draft.code.back().offset[a] += by[a];
  return true;
}

void append_unary(Draft& draft, int number, const std::vector<Argument>& arguments,
                  const Field& node) {
  const RegisteredOp& op = registry()[number];
  Instruction at = add_op(draft, number, arguments);
  float* constants = draft.pool.constants.data() + at.constants;
  if (op.fit != nullptr) {
    const Box content = node.bounds();
    check_finite(*op.entry.info, content);
    op.fit(constants, content);
  }
  if (number == op_number("translate")) {
    const float by[3] = {constants[0], constants[1], constants[2]};
    if (append_moved_leaf(draft, node, by)) return;
  }
  const bool domain = op.entry.info->role == OpRole::domain;
  at.step = Step::enter;
  if (domain) draft.code.push_back(at);
  append(draft, node.program());
  at.step = domain ? Step::leave : Step::range;
  draft.code.push_back(at);
}

// A program whose slope is bounded over a region only, as a distance bound everywhere.
Field bounded_by_region(const OpInfo& op, const Field& raw) {
  Box box = raw.bounds();
  if (box.empty()) box = {glm::dvec3(0), glm::dvec3(0)};
  check_finite(op, box);
  const glm::dvec3 half =
      0.5 * box.size() * 1.02 + 1e-4 * std::max({box.size().x, box.size().y, box.size().z, 1e-3});
  const glm::dvec3 c = box.center();
  const double slope = refined_slope(raw.program(), {c - half, c + half});
  if (!(slope < 1e6)) {
    throw refused(op,
                  fmt::format("its slope has no bound on the region around the node, from ({:g}, "
                              "{:g}, {:g}) to ({:g}, {:g}, {:g}); use smaller parameters, or keep "
                              "the node away from where the op degenerates",
                              box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z));
  }
  Draft program;
  Instruction at = add_op(program, op_number("region"),
                          {{"center", {c.x, c.y, c.z}},
                           {"half", {half.x, half.y, half.z}},
                           {"scale", 1 / std::max(slope * 1.000001, 1e-6)}});
  at.step = Step::enter;
  program.code.push_back(at);
  append(program, raw.program());
  at.step = Step::leave;
  program.code.push_back(at);
  return make_field(std::move(program));
}

}  // namespace

Field make_field(std::string_view name, const std::vector<Argument>& arguments,
                 const std::vector<Field>& of) {
  const OpEntry* entry = find_op(name);
  if (entry == nullptr) {
    throw Error(ErrorKind::input, fmt::format("there is no op `{}`", name));
  }
  const int number = op_number(name);
  const OpRole role = entry->info->role;
  check_names(*entry, arguments);
  if (role == OpRole::leaf && !of.empty()) throw refused(*entry->info, "it takes no nodes");
  if (role != OpRole::leaf && of.empty()) throw refused(*entry->info, "give it a node to work on");
  Draft draft;
  if (role == OpRole::combination) {
    append_combination(draft, number, arguments, of);
  } else if (role == OpRole::leaf) {
    Instruction at = add_op(draft, number, arguments);
    at.step = Step::leaf;
    draft.code.push_back(at);
  } else {
    append_unary(draft, number, arguments, of.size() == 1 ? of[0] : make_field("union", {}, of));
  }
  const Field made = make_field(std::move(draft));
  const bool region = entry->info->guarantee == OpGuarantee::computed && made.size() > of.size();
  return region ? bounded_by_region(*entry->info, made) : made;
}

Field make_field(std::shared_ptr<const Sampler> sampler) {
  Draft program;
  Instruction at{};
  at.step = Step::sample;
  at.tag = -1;
  program.code.push_back(at);
  program.pool.samplers.push_back(std::move(sampler));
  return make_field(std::move(program));
}

}  // namespace sdfgrid
