// grid/paint_field.h: paint of a grid that was made of a field: what the field's surfaces are
// marked with (Field::tagged).
#pragma once

#include <set>
#include <span>

#include "sdfgrid/core/job.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/grid/grid.h"

namespace sdfgrid {

// Gives every active sample the material of the surface that decides the field's value there:
// materials[t] of mark t, 0 (no paint) of no mark. What was painted before is painted over. Where
// all samples have the same one, nothing is painted. Returns the materials that there are, 0 too.
std::set<int> paint_by_field(const Grid& grid, const Field& field, std::span<const int> materials,
                             const Job& job);

}  // namespace sdfgrid
