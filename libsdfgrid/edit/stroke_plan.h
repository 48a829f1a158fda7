// edit/stroke_plan.h: where a stroke goes on a lattice: its brush's places, and the bricks that
// each of them may change. Internal to edit/.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/edit/stroke.h"
#include "sdfgrid/grid/bricks.h"

namespace sdfgrid {

// One place of the brush, in index space: a ball swept from `from` to `to`, or a shape at `from`.
struct Placement {
  glm::dvec3 from{0.0};
  glm::dvec3 to{0.0};
  double radius_from = 0;  // voxels, with the pressure; of a shape half its box's diagonal
  double radius_to = 0;
  double pressure = 1;      // by which a shape is scaled about its origin
  glm::dvec3 flip{1.0};     // -1 along the axes in which a shape is mirrored
  std::uint32_t image = 0;  // of StrokePlan::starts
};

struct PlannedBrick {
  glm::ivec3 brick{0};
  std::uint32_t begin = 0;  // of its places in StrokePlan::reaching
  std::uint32_t end = 0;
  // Whether those places overlap so that the least of their distances is only a bound inside.
  bool overlapping = false;
};

struct StrokePlan {
  std::vector<Placement> placements;
  std::vector<PlannedBrick> bricks;     // in the order of their coordinates, x first
  std::vector<std::uint32_t> reaching;  // for each brick, the placements that reach it
  std::vector<glm::dvec3> starts;       // where the path and each mirror image of it begin
  std::size_t dabs = 0;                 // places of the brush along its path, mirrored ones too
  bool clipped = false;                 // it reaches beyond the range
  std::vector<std::string> warnings;
};

struct PlanLimits {
  IndexBox range;     // samples that may change
  double margin = 3;  // voxels beyond the brush that it may change
  double max_bricks = 1e6;
};

[[nodiscard]] double distance_to_segment(const glm::dvec3& p, const glm::dvec3& a,
                                         const glm::dvec3& b);

// Places that a mirror maps onto one that is there already are put down once. Throws Error{usage}
// for a stroke without a path, with numbers out of range, with a brush of more than 1e5 voxels, or
// with more bricks of the range in its reach than allowed (with the estimate).
[[nodiscard]] StrokePlan plan_stroke(const Stroke& stroke, const Lattice& lattice,
                                     const PlanLimits& limits);

}  // namespace sdfgrid
