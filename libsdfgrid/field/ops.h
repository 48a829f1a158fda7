// field/ops.h: lists of op types, and how readings ask an op what it has (internal to field/).
//
// An op is a struct of floats, its parameters in the order of `parameters`, then what prepare()
// derives from them. It says of itself `info` and `parameters`, and has one of
//   leaf         T distance(Point<T>)
//   combination  T combine(T a, T b, Point<T>)
//   range        T value(T d, Point<T>)
//   domain       Point<T> inside(Point<T>), and T value(T d, Point<T> outside) if the value changes
// each a template over the number type, with one more argument (data, count) if the op has a list.
// A leaf may say kConvexSolid: along any line its value is a convex function. What has a slope() in
// closed form may say kDerivatives: those of its formula over intervals hold, too.
// For ordinary code only, never for kernels: void prepare(Data), and Box bounds(children...): where
// the value is below a level, given where the children are below child_level(level). What of its
// nodes' values matters for its own to be right at some is looks_at(levels), or of those where
// surfaces may be as far from each other as `apart`, looks_at(levels, apart), and of the last node
// that negated if it has kTurnsLast. A domain op may say changes_nothing(), and similarity(): what
// it multiplies all lengths by, if they all are, else 0. What can leave nothing of its nodes says
// kTakesAway.
#pragma once

#include "sdfgrid/field/levels.h"
#include "sdfgrid/field/number.h"
#include "sdfgrid/field/op.h"

namespace sdfgrid::ops {

template <class... Op>
struct OpList {
  static constexpr int size = sizeof...(Op);
};

// The floats of an op's list.
struct Data {
  const float* values;
  int count;
};

template <class Op>
concept Lists = requires {
  Op::kList;
};
template <class Op>
concept Leaf = Op::info.role == OpRole::leaf;
template <class Op>
concept Combination = Op::info.role == OpRole::combination;
template <class Op>
concept Range = Op::info.role == OpRole::range;
template <class Op>
concept Domain = Op::info.role == OpRole::domain;
template <class Op>
concept Leaves = Domain<Op> && requires {
  Op::kLeaves;
};  // changes the value when left

template <class Op, class T>
inline T leaf_value(const Op& op, const Point<T>& p, Data data) {
  if constexpr (Lists<Op>) {
    return op.distance(p, data);
  } else {
    return op.distance(p);
  }
}

template <class Op, class T>
inline T changed_value(const Op& op, const T& d, const Point<T>& p, Data data) {
  if constexpr (Lists<Op>) {
    return op.value(d, p, data);
  } else {
    return op.value(d, p);
  }
}

}  // namespace sdfgrid::ops
