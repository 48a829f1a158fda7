// edit/brick_edit.h: the new values of bricks, before they are written into a grid. Internal to
// edit/.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "sdfgrid/core/job.h"
#include "sdfgrid/edit/combine_kernel.h"
#include "sdfgrid/edit/stroke_plan.h"
#include "sdfgrid/grid/bricks.h"

namespace sdfgrid {

struct BrickEdit {
  glm::ivec3 brick{0};
  GridBrick before;
  alignas(64) float after[kBrickSamples];
  CombineOutput made;  // made.after points to `after`
};

// What all edits of a stroke need to know of the grid.
struct EditContext {
  const GridBricks& bricks;
  Lattice lattice;
  BandLimits limits;
  IndexBox range;
};

// Distances of a brick's samples to the union of the placements that reach it, voxels, cut off at
// the grid's range.
void brush_distances(const Stroke& stroke, const StrokePlan& plan, const PlannedBrick& planned,
                     const EditContext& context, float* distances);

// Distances of a brick's samples, voxels, to the box in which a stroke may add or take away: so far
// within the grid's range that the band of what is cut off there ends in the range.
void range_distances(const EditContext& context, const glm::ivec3& brick, float* distances);

// Combines one brick with the union of its placements. edit.brick and edit.before are given.
void combine_brick(const Stroke& stroke, const StrokePlan& plan, const PlannedBrick& planned,
                   const EditContext& context, BrickEdit& edit);

// One dab of a clay tool, in index space and voxels.
struct ClayDab {
  glm::dvec3 middle{0.0};
  float radius = 0;
  float strength = 0;          // with the pressure
  glm::vec3 normal{0.0F};      // of the plane to flatten to, outwards
  glm::vec3 from_plane{0.0F};  // from a point of that plane to the middle
  bool clipped = false;        // whether it may reach beyond the range
};

// The same for clay tools, which move what is within the band and leave the rest alone: a sample at
// the band's limit says only that the surface is further away. All active samples become suspects.
void shape_brick(const Stroke& stroke, const ClayDab& dab, const EditContext& context,
                 BrickEdit& edit);

}  // namespace sdfgrid
