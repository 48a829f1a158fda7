// trace/grid_sampler.h: a grid as a leaf of fields.
#pragma once

#include <map>
#include <memory>

#include "sdfgrid/core/job.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/grid/atlas.h"
#include "sdfgrid/grid/grid.h"

namespace sdfgrid {

// The grid's trilinear field made 1-Lipschitz: where it is steeper than 1 at a value, values around
// that are pressed together. Its zeros are those of the trilinear field, its other levels too, at
// value_at(). Beyond the band it is what that ends with and the distance to the bricks that hold it
// (in the largest-coordinate norm, so up to 1.7 times too small), and outside of the box of the
// active voxels the distance to that box if that is more. `paint_tags` are the marks of painted
// materials. Throws Error{input} for a grid without sign or without voxels.
[[nodiscard]] std::shared_ptr<const Sampler> make_sampler(
    const Grid& grid, const Job& job, const std::map<int, int>& paint_tags = {});

// Throws what make_sampler() throws.
void check_has_inside(const Grid& grid);

// The trilinear field itself, world units, which may be larger than the distance; `box` is that of
// the active voxels, beyond which it is the distance to that box if that is more.
[[nodiscard]] double trilinear_distance(const Atlas& atlas, const Box& box, const glm::dvec3& p);

}  // namespace sdfgrid
