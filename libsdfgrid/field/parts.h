// field/parts.h: the nodes that a field is the union of, for those who look at one at a time.
#pragma once

#include <vector>

#include "sdfgrid/field/field.h"

namespace sdfgrid {

struct FieldPart {
  Field field;
  Box box;              // holds the solid; axes without end are infinite
  bool scaled = false;  // in places its slope is less than that of a distance: see local_bounds.h
  bool convex = false;  // outside of the solid the value along any line is a convex function
};

// Together the parts are the solid; each is a field by itself, whose values beyond its solid may
// differ from those that it had in the union. What is moved, turned or scaled as one is taken apart
// too. Parts that are nowhere are
// left out; a field that is no union is its only part.
[[nodiscard]] std::vector<FieldPart> parts_of(const Field& field);

}  // namespace sdfgrid
