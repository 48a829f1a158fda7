// field/formula_fault.h: why the slope of a formula has no bound, for messages (internal to
// field/).
#pragma once

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/field/ops.h"

namespace sdfgrid {

struct FormulaFault {
  const char* name = nullptr;  // of the function, as users write it; null if it is none of theirs
  bool jumps = false;
};

// The first operation of a formula whose value over the box has a slope without bound.
[[nodiscard]] FormulaFault formula_fault(ops::Data code, const Box& box);

}  // namespace sdfgrid
