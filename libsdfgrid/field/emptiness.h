// field/emptiness.h: solids in which there is no point: told by intervals, and what to look at in
// them.
#pragma once

#include <string>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/field/field.h"

namespace sdfgrid {

// Whether intervals prove that the field is above 0 everywhere. Gives up (false) at the first point
// that is not above 0, and after what least_value() looks at. Throws Error{cancelled}.
[[nodiscard]] bool is_surely_empty(const Field& field, const Job& job);

// The ops of the field that can take all of a solid away, by name, each once.
[[nodiscard]] std::vector<std::string> ops_that_take_away(const Field& field);

}  // namespace sdfgrid
