// trace/visibility.h: how much of the sun and of the sky points on a surface see, between the
// ordinary code and visibility_kernel.cpp, which is compiled once for each instruction set. Plain
// data only (not installed).
//
// Positions and lengths are in voxels from index 8 * atlas.lo.
#pragma once

#include <cstdint>

#include "sdfgrid/core/kernel.h"

namespace sdfgrid {

struct VisibilityScene {
  // The band: an Atlas.
  const std::int32_t* bricks;
  const float* samples;
  std::int32_t dims[3];
  float outside, inside;  // what the field is where there is no brick
  // Beyond it: a FarField.
  const float* far_values;
  std::int32_t far_dims[3];
  float far_origin[3];
  float far_spacing;

  float sun[3];       // unit vector towards it
  float sun_tan;      // tangent of its angular radius
  float sun_reach;    // no shadows from further away
  float axis[3];      // unit vector about which `cones` are laid out
  float cones[6][3];  // unit vectors that tile the hemisphere about `axis`: itself, then five at 60
                      // degrees
  float sky_reach;    // no occlusion from further away
};

// Points on surfaces, as columns whose length is a multiple of 16.
struct VisibilityBatch {
  const float *x, *y, *z;     // positions
  const float *nx, *ny, *nz;  // unit normals
  float *sun, *sky;           // results in [0, 1]
  std::int32_t count;
};

// Sun: a soft shadow from the narrowest passage of the ray between its origin and the sun, as the
// field tells it (Aaltonen 2018). Sky: cosine-weighted visibility of six cones with half-angles of
// 30 degrees, each as open as the field is large against the cone's radius; 1 on planes and convex
// bodies.
using VisibilityKernel = void (*)(const VisibilityScene& scene, const VisibilityBatch& batch);

// The kernel for this machine.
[[nodiscard]] VisibilityKernel visibility_kernel();

SDFGRID_DECLARE_ISAS(void visibility(const VisibilityScene& scene, const VisibilityBatch& batch))

}  // namespace sdfgrid
