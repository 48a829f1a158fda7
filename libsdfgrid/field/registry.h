// field/registry.h: all ops at run time, by number: what make_field and bounds need of them
// (internal to field/).
#pragma once

#include "sdfgrid/field/field.h"
#include "sdfgrid/field/ops.h"

namespace sdfgrid {

struct RegisteredOp {
  OpEntry entry;
  std::uint32_t floats = 0;   // of the op's struct
  bool list = false;          // has a list of numbers beside it
  bool two = false;           // a combination of two nodes, no more
  bool convex = false;        // combination and range: no steeper than the steepest operand
  bool convex_solid = false;  // leaf: kConvexSolid
  // Makes the field where that takes more than numbers; null where it does not.
  Field (*make)(const std::vector<Argument>& arguments) = nullptr;
  // The same of an op of one node.
  Field (*make_around)(const std::vector<Argument>& arguments, const Field& node) = nullptr;
  // Its list where that is not numbers.
  std::vector<float> (*list_of)(const std::vector<Argument>& arguments) = nullptr;
  // Derives what the struct holds beside its parameters; throws Error{input}.
  void (*prepare)(float* constants, ops::Data data) = nullptr;
  // Tells a domain op where its node is; null if it need not know.
  void (*fit)(float* constants, const Box& content) = nullptr;
  // Where the result is below a level, see combinations.h. Of a leaf `a` and `b` are not used.
  Box (*bounds)(const float* constants, ops::Data data, const Box& a, const Box& b,
                double level) = nullptr;
  double (*child_level)(const float* constants, double level) = nullptr;
  // Which values of its nodes matter, see ops.h; without what `turns_last` says.
  Levels (*looks_at)(const float* constants, const Levels& own, double apart) = nullptr;
  bool turns_last = false;
  // Of domain ops: see ops.h; null where they do not say.
  bool (*changes_nothing)(const float* constants) = nullptr;
  double (*similarity)(const float* constants) = nullptr;
  // Of combinations: see combinations.h; null where nothing is too far away to matter.
  double (*reach)(const float* constants) = nullptr;
  bool takes_away = false;  // kTakesAway
  // The op that joins what is taken away from the first node; null if nothing is.
  const char* rest = nullptr;
};

// By op number; places that no op has are empty (entry.info is null).
std::span<const RegisteredOp> registry();

}  // namespace sdfgrid
