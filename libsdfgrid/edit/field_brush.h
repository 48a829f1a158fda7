// edit/field_brush.h: an analytic field as a brush.
#pragma once

#include <memory>

#include "sdfgrid/edit/stroke.h"
#include "sdfgrid/field/field.h"

namespace sdfgrid {

// `exact` says whether the field's values are true distances wherever they matter, or only bounds.
// Throws Error{input} if the field's solid is empty or has no end.
[[nodiscard]] std::shared_ptr<const BrushShape> make_brush(const Field& field, bool exact);

}  // namespace sdfgrid
