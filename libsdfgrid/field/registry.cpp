#include "sdfgrid/field/registry.h"

#include <algorithm>

#include "sdfgrid/field/interpret.h"
#include "sdfgrid/field/leaf_bounds.h"
#include "sdfgrid/field/leaves_sampled.h"

namespace sdfgrid {
namespace {

using namespace ops;

template <class Op>
std::span<const Parameter> parameters_of() {
  if constexpr (requires { Op::parameters; }) {
    return Op::parameters;
  } else {
    return {};
  }
}

template <class Op>
void add_levels(RegisteredOp& r) {
  constexpr bool moves = requires(Op op) { op.child_level(0.0); };
  r.child_level = [](const float* c, double level) {
    if constexpr (moves) {
      return load_op<Op>(c).child_level(level);
    } else {
      return level;
    }
  };
  constexpr bool looks = requires(Op op) { op.looks_at(Levels()); };
  constexpr bool looks_apart = requires(Op op) { op.looks_at(Levels(), 0.0); };
  static_assert(!moves || looks || looks_apart, "an op that moves levels says which it looks at");
  r.looks_at = [](const float* c, const Levels& own, double apart) {
    if constexpr (looks) {
      return load_op<Op>(c).looks_at(own);
    } else if constexpr (looks_apart) {
      return load_op<Op>(c).looks_at(own, apart);
    } else {
      return own;
    }
  };
  r.turns_last = requires { Op::kTurnsLast; };
}

template <class Op>
RegisteredOp registered() {
  RegisteredOp r;
  r.entry = {&Op::info, parameters_of<Op>()};
  if constexpr (requires { &Op::make; }) r.make = Op::make;
  r.floats = std::is_empty_v<Op> ? 0 : sizeof(Op) / sizeof(float);
  r.list = Lists<Op>;
  r.two = requires { Op::kTwo; };
  r.convex = requires { Op::kConvex; };
  r.convex_solid = requires { Op::kConvexSolid; };
  r.takes_away = requires { Op::kTakesAway; };
  if constexpr (requires { Op::kRest; }) {
    static_assert(
        requires { Op::kTurnsLast; }, "what takes nodes away turns their sign");
    r.rest = Op::kRest;
  }
  if constexpr (requires { &Op::make_around; }) r.make_around = Op::make_around;
  if constexpr (requires { &Op::list_of; }) r.list_of = Op::list_of;
  if constexpr (requires(Op op, Data data) { op.prepare(data); }) {
    r.prepare = [](float* constants, Data data) {
      Op op = load_op<Op>(constants);
      op.prepare(data);
      std::memcpy(constants, &op, sizeof op);
    };
  }
  if constexpr (requires(Op op, Box box) { op.fit(box); }) {
    r.fit = [](float* constants, const Box& content) {
      Op op = load_op<Op>(constants);
      op.fit(content);
      std::memcpy(constants, &op, sizeof op);
    };
  }
  r.bounds = [](const float* c, Data data, const Box& a, const Box& b, double level) -> Box {
    const Op op = load_op<Op>(c);
    if constexpr (requires { op.bounds(data, level); }) {
      return op.bounds(data, level);
    } else if constexpr (Leaf<Op>) {
      return leaf_bounds(op, data, level);
    } else if constexpr (Combination<Op>) {
      return op.bounds(a, b);
    } else if constexpr (requires { op.bounds(a, level); }) {
      return op.bounds(a, level);
    } else {
      return op.bounds(a);
    }
  };
  add_levels<Op>(r);
  if constexpr (requires(Op op) { op.changes_nothing(); }) {
    r.changes_nothing = [](const float* c) { return load_op<Op>(c).changes_nothing(); };
  }
  if constexpr (requires(Op op) { op.similarity(); }) {
    r.similarity = [](const float* c) { return load_op<Op>(c).similarity(); };
  }
  if constexpr (requires(Op op) { op.reach(); }) {
    r.reach = [](const float* c) { return load_op<Op>(c).reach(); };
  }
  return r;
}

std::vector<RegisteredOp> make_registry() {
  constexpr int kFormulas = std::tuple_size_v<Families> * kFamilySize;
  std::vector<RegisteredOp> all(kFormulas + SampledLeaves::size);
  each_op([&]<class Op>(int number) { all[number] = registered<Op>(); });
  each_of(SampledLeaves{}, kFormulas, [&]<class Op>(int number) {
    all[number].entry = {&Op::info, parameters_of<Op>()};
    all[number].make = Op::make;
  });
  return all;
}

}  // namespace

std::span<const RegisteredOp> registry() {
  static const std::vector<RegisteredOp> all = make_registry();
  return all;
}

std::span<const OpEntry> op_list() {
  static const std::vector<OpEntry> listed = [] {
    std::vector<OpEntry> found;
    for (const RegisteredOp& op : registry()) {
      if (op.entry.info != nullptr && op.entry.info->listed) found.push_back(op.entry);
    }
    // Leaves first: that is how one reads a list of shapes.
    std::stable_partition(found.begin(), found.end(),
                          [](const OpEntry& e) { return e.info->role == OpRole::leaf; });
    return found;
  }();
  return listed;
}

const OpEntry* find_op(std::string_view name) {
  const auto all = op_list();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const OpEntry& e) { return name == e.info->name; });
  return found == all.end() ? nullptr : &*found;
}

int op_number(std::string_view name) {
  const auto all = registry();
  const auto found = std::find_if(all.begin(), all.end(), [&](const RegisteredOp& op) {
    return op.entry.info != nullptr && name == op.entry.info->name;
  });
  return found == all.end() ? -1 : static_cast<int>(found - all.begin());
}

}  // namespace sdfgrid
