// field/emptiness.h: solids in which there is no point: told by intervals, before space is searched
// for their surface.
#pragma once

#include <string>
#include <vector>

#include "sdfgrid/field/field.h"

namespace sdfgrid {

// Whether intervals prove that the field is above 0 all over the box. Looks where the field may be
// least first, and gives up (false) at the first point that is not above 0 or after `most` boxes.
[[nodiscard]] bool is_surely_empty(const Field& field, const Box& box, std::size_t most = 20000);

// The ops of the field that can take all of a solid away, by name, each once.
[[nodiscard]] std::vector<std::string> ops_that_take_away(const Field& field);

}  // namespace sdfgrid
