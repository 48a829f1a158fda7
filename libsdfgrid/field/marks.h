// field/marks.h: which marks (Field::tagged) the surfaces of a field carry.
#pragma once

#include <optional>

#include "sdfgrid/field/field.h"

namespace sdfgrid {

// The mark that tag_at() gives everywhere, -1 for none; nothing if there may be several: two leaves
// differ, or a Sampler takes part, which may have marks of its own.
[[nodiscard]] std::optional<int> only_mark(const Field& field);

}  // namespace sdfgrid
