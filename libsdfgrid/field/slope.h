// field/slope.h: bounds on the gradient of a program over a box (internal to field/).
#pragma once

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/field/program_data.h"

namespace sdfgrid {

// A bound on |grad f| over the box, from one pass: infinite where none is known.
[[nodiscard]] double slope_over(const Program& program, const Box& box);

struct Steepest {
  double slope;
  Box cell;  // a part of the box in which no less is known
};
// The same refined: the cell with the largest bound is split, again and again, until splitting
// gains little or there are many cells. The box must be finite.
[[nodiscard]] Steepest refined_slope(const Program& program, const Box& box);

}  // namespace sdfgrid
