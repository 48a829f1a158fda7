// field/batch_family.h: makes the batch functions of a family of ops from their templates, for the
// *_kernel.cpp files of field/ only (not installed). Each op is a function of its own over memory,
// so that what it computes does not depend on the program around it: a pruned program gives the
// same bits.
#pragma once

#include "sdfgrid/field/lanes_functions.h"
#include "sdfgrid/field/ops.h"
#include "sdfgrid/field/program.h"

namespace sdfgrid::SDFGRID_ISA {

using LanePoint = ops::Point<Lanes>;

inline LanePoint load_point(const BatchStep& s, int i) {
  return {load(s.p[0] + i), load(s.p[1] + i), load(s.p[2] + i)};
}

// An op's parameters as it stores them; one without any has no bytes among the constants.
template <class Op>
Op op_of(const BatchStep& step) {
  Op op;
  if constexpr (!__is_empty(Op)) __builtin_memcpy(&op, step.constants, sizeof op);
  return op;
}

// Copies, which no store can change: what they hold is loaded and spread over the lanes once.
template <class Op>
void apply(const BatchStep& step) {
  const BatchStep s = step;
  const float offset[3] = {s.offset[0], s.offset[1], s.offset[2]};
  const Op op = op_of<Op>(s);
  // By four: of a loop with more turns than it remembers the machine guesses the end wrongly.
#pragma GCC unroll 4
  for (int i = 0; i < s.n; i += kLanes) {
    const LanePoint p = load_point(s, i);
    if constexpr (ops::Leaf<Op>) {
      store(s.out + i, ops::leaf_value(op, minus(p, offset), {s.data, s.count}).v);
    } else if constexpr (ops::Combination<Op>) {
      store(s.out + i, op.combine(Lanes(load(s.a + i)), Lanes(load(s.b + i)), p).v);
    } else if constexpr (ops::Range<Op>) {
      store(s.out + i, ops::changed_value(op, Lanes(load(s.a + i)), p, {s.data, s.count}).v);
    } else {
      const LanePoint q = op.inside(p);
      store(s.q[0] + i, q.x.v);
      store(s.q[1] + i, q.y.v);
      store(s.q[2] + i, q.z.v);
    }
  }
}

template <class Op>
void leave(const BatchStep& step) {
  const BatchStep s = step;
  const Op op = op_of<Op>(s);
  for (int i = 0; i < s.n; i += kLanes) {
    store(s.out + i, op.value(Lanes(load(s.a + i)), load_point(s, i)).v);
  }
}

template <class Op>
constexpr BatchFunction leave_of() {
  if constexpr (ops::Leaves<Op>) {
    return leave<Op>;
  } else {
    return nullptr;
  }
}

template <class List>
struct Functions;
template <class... Op>
struct Functions<ops::OpList<Op...>> {
  static constexpr BatchFunction apply[] = {SDFGRID_ISA::apply<Op>...};
  static constexpr BatchFunction leave[] = {leave_of<Op>()...};
  static constexpr BatchFamily family = {apply, leave};
};

}  // namespace sdfgrid::SDFGRID_ISA
