// Makes fields by name.
#include <fmt/format.h>

#include "sdfgrid/field/build.h"
#include "sdfgrid/field/union_tree.h"

namespace sdfgrid {
namespace {

// An instruction for the op from its arguments.
Instruction add_op(Draft& draft, int number, const std::vector<Argument>& arguments) {
  const OpEntry& entry = registry()[number].entry;
  const CheckedArguments checked(entry, arguments);
  std::vector<float> parameters;
  std::vector<float> list;
  if (registry()[number].list_of != nullptr) list = registry()[number].list_of(arguments);
  for (const Parameter& parameter : entry.parameters) {
    if (parameter.kind == ParameterKind::text) continue;
    const std::vector<double> numbers = checked.numbers(parameter.name);
    auto& to = width_of(parameter.kind) > 0 ? parameters : list;
    for (const double v : numbers) to.push_back(static_cast<float>(v));
  }
  return add_op(draft, number, std::move(parameters), list);
}

// Joins fields two by two, halves first, so that the program's stack stays shallow however many
// there are.
void append_joined(Draft& draft, std::span<const Field> of, const Instruction& join) {
  if (of.size() == 1) {
    append(draft, of[0].program());
    return;
  }
  const std::size_t half = (of.size() + 1) / 2;
  append_joined(draft, of.first(half), join);
  append_joined(draft, of.subspan(half), join);
  draft.code.push_back(join);
}

void append_combination(Draft& draft, int number, const std::vector<Argument>& arguments,
                        std::span<const Field> of) {
  Instruction last = add_op(draft, number, arguments);
  last.step = Step::combine;
  const auto many = [](int op, std::size_t nodes) {
    return registry()[op].reach != nullptr && nodes >= kManyNodes;
  };
  if (many(number, of.size())) return append_union_tree(draft, of, last);
  const char* const rest_word = registry()[number].rest;
  const int rest = rest_word == nullptr ? number : op_number(rest_word);
  if (rest == number || of.size() < 3) return append_joined(draft, of, last);
  Instruction join = add_op(draft, rest, arguments);
  join.step = Step::combine;
  append(draft, of[0].program());
  if (many(rest, of.size() - 1)) {
    append_union_tree(draft, of.subspan(1), join);
  } else {
    append_joined(draft, of.subspan(1), join);
  }
  draft.code.push_back(last);
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
  const Instruction at = add_op(draft, number, arguments);
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
  if (op.changes_nothing != nullptr && op.changes_nothing(constants)) {
    return append(draft, node.program());
  }
  append_around(draft, at, node.program());
}

void check_nodes(int number, std::size_t nodes) {
  const OpEntry& op = registry()[number].entry;
  const bool leaf = op.info->role == OpRole::leaf;
  if (registry()[number].two && nodes > 2) {
    throw Error(ErrorKind::input,
                fmt::format("{}: it has {} nodes; give two, or nest it", op.info->name, nodes));
  }
  if (leaf == (nodes == 0)) return;
  throw Error(ErrorKind::input,
              fmt::format("{}: {}", op.info->name,
                          leaf ? "it takes no nodes" : "give it a node to work on"));
}

}  // namespace

Field make_field(std::string_view name, const std::vector<Argument>& arguments,
                 const std::vector<Field>& of) {
  const OpEntry* entry = find_op(name);
  if (entry == nullptr) throw Error(ErrorKind::input, fmt::format("there is no op `{}`", name));
  const int number = op_number(name);
  check_nodes(number, of.size());
  if (registry()[number].make != nullptr) return registry()[number].make(arguments);
  const auto one = [&] { return of.size() == 1 ? of[0] : make_field("union", {}, of); };
  if (registry()[number].make_around != nullptr) {
    return registry()[number].make_around(arguments, one());
  }
  Draft draft;
  switch (entry->info->role) {
    case OpRole::combination:
      append_combination(draft, number, arguments, of);
      break;
    case OpRole::leaf: {
      Instruction at = add_op(draft, number, arguments);
      at.step = Step::leaf;
      draft.code.push_back(at);
      break;
    }
    case OpRole::range:
    case OpRole::domain:
      append_unary(draft, number, arguments, one());
      break;
  }
  const Field made = make_field(std::move(draft));
  const bool alone = entry->info->role == OpRole::combination && of.size() == 1;
  const bool region = entry->info->guarantee == OpGuarantee::computed && !alone;
  return region ? bounded_by_region(*entry->info, made) : made;
}

Field make_field(std::shared_ptr<const Sampler> sampler) {
  Draft draft;
  Instruction at{};
  at.step = Step::sample;
  at.tag = -1;
  draft.code.push_back(at);
  draft.pool.samplers.push_back(std::move(sampler));
  return make_field(std::move(draft));
}

Field::Field() {
  static const Field nothing = make_leaf(op_number("nothing"), {}, {});
  program_ = nothing.program_;
}

}  // namespace sdfgrid
