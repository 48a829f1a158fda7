// transform/meijster.h: exact distances between samples, after A. Meijster, J. Roerdink and W.
// Hesselink, *A general algorithm for computing distance transforms in linear time* (2000), in 3D
// (not installed).
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>

#include "sdfgrid/core/job.h"
#include "sdfgrid/transform/transform.h"

namespace sdfgrid {

// Writes the bytes (not zero: inside) of the row of samples (i, j, 0) to (i, j, nz - 1).
using InsideRow = std::function<void(int i, int j, std::uint8_t* inside)>;

struct MeijsterOptions {
  glm::ivec3 dims{0};
  glm::dvec3 spacing{1.0};
  TransformSide side = TransformSide::both;
  double window = 0;  // in voxels of the smallest spacing; 0: unbounded
  double shift = 0;   // world units, taken off every distance (of both sides)
};

// Distances in world units to the nearest sample on the other side, negative inside; +-infinity, or
// the window, where there is none. Squares are integers if the spacing is the same on all axes.
// Works in place: beside `distance` it needs a few hundred bytes a row of each thread.
void meijster(const InsideRow& inside, const MeijsterOptions& options, std::span<float> distance,
              const Job& job);

}  // namespace sdfgrid
