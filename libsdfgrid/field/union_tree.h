// field/union_tree.h: unions of many nodes as a tree of boxes, so that what is far away is never
// looked at (internal to field/).
//
// A union of kManyNodes or more is joined by place, halves of the nodes along the longest axis, as
// in a bounding volume hierarchy. Each of its instructions has a list of twelve floats, the boxes
// of its two operands, lo and hi. Outside of a box its operand's value is not less than the
// distance to the box. Nodes for which that is not known anyway (those that are only bounds on the
// distance) are wrapped into the op `region`, which makes it so; what has no end has an infinite
// box.
//
// Smooth unions have such boxes too, but are joined in the order that they are given in: in another
// order they would be another solid, and one that moves would jump. Their nodes stay as they are;
// those that are only bounds have infinite boxes.
#pragma once

#include "sdfgrid/field/interval.h"
#include "sdfgrid/field/program_data.h"

namespace sdfgrid {

inline constexpr std::size_t kManyNodes = 16;
inline constexpr std::uint32_t kUnionFloats = 12;   // Instruction::count of such a union, and
inline constexpr std::uint32_t kUnionSwapped = 13;  // of one whose operands changed places since

inline constexpr std::uint16_t kUnionOp = 0;  // the first op of the first family

inline bool is_plain_union(const Instruction& at) {
  return at.step == Step::combine && at.op == kUnionOp;
}

// Whether the instruction is a union, smooth ones among them, that knows the boxes of its operands.
inline bool has_boxes(const Instruction& at) {
  return at.step == Step::combine && at.count >= kUnionFloats && at.count <= kUnionSwapped;
}

// Whether it is one of the regions that a large union put around a node; or around a warp that is
// not steeper than 1.
[[nodiscard]] bool is_enclosure(const Program& program, const Instruction& at);

// The box of the first or the second operand of such a union.
[[nodiscard]] Box operand_box(const Program& program, const Instruction& at, int operand);

// That of all nodes of the last such union of a program, in its own space; infinite if it is not
// known or there is none.
[[nodiscard]] Box last_union_box(const Program& program);

// Appends the union of many fields, joined by copies of `join`, an op that says reach(). Of plain
// unions empty ones are left out.
void append_union_tree(Draft& draft, std::span<const Field> of, const Instruction& join);

// Lower bounds on the values of both operands over p, -inf where their boxes touch it, by the
// distance between boxes. `far` is size_of(p).
void least_of_operands(const Program& program, const Instruction& at,
                       const ops::Point<ops::Interval>& p, double far, double least[2]);

// The sum of the largest coordinates: what floats round is in proportion to it.
[[nodiscard]] inline double size_of(const ops::Point<ops::Interval>& p) {
  return ops::magnitude(p.x) + ops::magnitude(p.y) + ops::magnitude(p.z);
}

}  // namespace sdfgrid
