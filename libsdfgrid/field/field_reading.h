// field/field_reading.h: parts of the interval reading that others need too (internal to field/).
#pragma once

#include "sdfgrid/field/interpret.h"
#include "sdfgrid/field/interval.h"

namespace sdfgrid {

[[nodiscard]] ops::Point<ops::Interval> intervals(const Box& box);

// By op number.
[[nodiscard]] const std::vector<ops::OpFunctions<ops::Interval>>& interval_functions();

// The values of one leaf over a box of its own space.
[[nodiscard]] ops::Interval leaf_interval(const Program& program, const Instruction& at,
                                          const ops::Point<ops::Interval>& p);

}  // namespace sdfgrid
