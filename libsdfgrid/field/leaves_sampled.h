// field/leaves_sampled.h: leaves whose distance a Sampler computes, so that they have no formula
// (internal to field/).
#pragma once

#include <memory>
#include <vector>

#include "sdfgrid/field/field.h"
#include "sdfgrid/field/ops.h"
#include "sdfgrid/field/parameters.h"

namespace sdfgrid::ops {

struct Points {
  static constexpr OpInfo info = {"points",
                                  OpRole::leaf,
                                  OpGuarantee::exact_outside,
                                  "All that is within a radius of some points.",
                                  "points: {points: [[-0.5, 0, 0], [0.5, 0.2, 0], [0, 0.6, 0.4], "
                                  "[0, -0.5, -0.3]], radius: 0.4}",
                                  "J. L. Bentley 1975: nearest point by a kd-tree"};
  static constexpr Parameter parameters[] = {
      {"file",
       ParameterKind::text,
       "",
       {0, 0, 0},
       0,
       0,
       "the points, beside the scene: rows of x, y and z, as text or .npy"},
      {"points",
       ParameterKind::points,
       "length",
       {0, 0, 0},
       -kAny,
       kAny,
       "instead of a file; any number"},
      size("radius", 0.1, "around each")};
  static Field make(const std::vector<Argument>& arguments);
};

using SampledLeaves = OpList<Points>;

}  // namespace sdfgrid::ops
