// field/interpret.h: reading a program one point (or box) at a time with any number type but lanes
// (internal to field/).
#pragma once

#include <cstring>
#include <type_traits>
#include <vector>

#include "sdfgrid/field/op_list.h"
#include "sdfgrid/field/program_data.h"

namespace sdfgrid::ops {

// One op as functions of a number type; those that its role lacks are null.
template <class T>
struct OpFunctions {
  T (*leaf)(const float* constants, Data data, const Point<T>& p) = nullptr;
  T (*combine)(const float* constants, const T& a, const T& b, const Point<T>& p) = nullptr;
  T (*value)(const float* constants, Data data, const T& d, const Point<T>& p) = nullptr;
  Point<T> (*inside)(const float* constants, const Point<T>& p) = nullptr;
};

template <class Op>
Op load_op(const float* constants) {
  Op op;
  // One without parameters has no bytes among the constants.
  if constexpr (!std::is_empty_v<Op>) std::memcpy(static_cast<void*>(&op), constants, sizeof op);
  return op;
}

template <class Op, class T>
OpFunctions<T> functions_of() {
  OpFunctions<T> f;
  if constexpr (Leaf<Op>) {
    f.leaf = [](const float* c, Data data, const Point<T>& p) {
      return leaf_value(load_op<Op>(c), p, data);
    };
  } else if constexpr (Combination<Op>) {
    f.combine = [](const float* c, const T& a, const T& b, const Point<T>& p) {
      return load_op<Op>(c).combine(a, b, p);
    };
  } else if constexpr (Domain<Op>) {
    f.inside = [](const float* c, const Point<T>& p) { return load_op<Op>(c).inside(p); };
  }
  if constexpr (Range<Op> || Leaves<Op>) {
    f.value = [](const float* c, Data data, const T& d, const Point<T>& p) {
      return changed_value(load_op<Op>(c), d, p, data);
    };
  }
  return f;
}

// By op number.
template <class T>
std::vector<OpFunctions<T>> make_functions() {
  std::vector<OpFunctions<T>> all(std::tuple_size_v<Families> * kFamilySize);
  each_op([&]<class Op>(int number) { all[number] = functions_of<Op, T>(); });
  return all;
}

inline Data data_of(const Program& program, const Instruction& at) {
  return {program.pool->constants.data() + at.data, static_cast<int>(at.count)};
}

// The point in the space of a leaf; where it was not moved, without what rounding adds to
// intervals.
template <class T>
Point<T> leaf_point(const Instruction& at, const Point<T>& p) {
  const bool moved = at.offset[0] != 0 || at.offset[1] != 0 || at.offset[2] != 0;
  return moved ? minus(p, at.offset) : p;
}

// Runs a program at p. `leaf(instruction, point)` is asked for each leaf's value, samplers
// included.
template <class T, class LeafValue>
T interpret(const Program& program, const std::vector<OpFunctions<T>>& functions, const Point<T>& p,
            const LeafValue& leaf) {
  T values[kMaxValues];
  Point<T> points[kMaxPoints + 1];
  points[0] = p;
  int top = 0;
  int inner = 0;
  for (const Instruction& at : program.code) {
    const OpFunctions<T>& f = functions[at.op];
    const float* c = constants_of(program, at);
    switch (at.step) {
      case Step::leaf:
      case Step::sample:
        values[top++] = leaf(at, leaf_point(at, points[inner]));
        break;
      case Step::combine:
        --top;
        values[top - 1] = f.combine(c, values[top - 1], values[top], points[inner]);
        break;
      case Step::range:
        values[top - 1] = f.value(c, data_of(program, at), values[top - 1], points[inner]);
        break;
      case Step::enter:
        points[inner + 1] = f.inside(c, points[inner]);
        ++inner;
        break;
      case Step::leave:
        --inner;
        if (f.value != nullptr)
          values[top - 1] = f.value(c, data_of(program, at), values[top - 1], points[inner]);
        break;
    }
  }
  return values[0];
}

}  // namespace sdfgrid::ops
