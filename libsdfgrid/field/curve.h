// field/curve.h: the distance to a cubic Bezier curve (internal to field/).
#pragma once

#include <memory>
#include <vector>

#include "sdfgrid/field/field.h"

namespace sdfgrid {

// A tube of a radius around the curve of four control points (x, y, z each). Exact to rounding: all
// roots of the quintic (c - p) . c' are isolated by subdivision in the Bernstein basis.
[[nodiscard]] std::shared_ptr<const Sampler> make_cubic_curve(const std::vector<double>& control,
                                                              double radius);

}  // namespace sdfgrid
