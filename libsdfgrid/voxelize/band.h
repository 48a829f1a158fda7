// voxelize/band.h: how far from the surface exact distances are wanted.
#pragma once

namespace sdfgrid {

struct Band {
  double exwidth = 3.0;  // voxels outside the surface, >= 1
  double inwidth = 3.0;  // voxels inside, >= 1
};

}  // namespace sdfgrid
