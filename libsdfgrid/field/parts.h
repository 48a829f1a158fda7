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

// The least value of all parts is that of the field, wherever it is not negative; inside, where one
// of them is. What is moved, turned or scaled as one is taken apart too. Parts that are nowhere are
// left out; a field that is no union is its only part.
[[nodiscard]] std::vector<FieldPart> parts_of(const Field& field);

}  // namespace sdfgrid
