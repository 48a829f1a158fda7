// transform/band_brick.h: the last step of every transform of a mesh: from distances that are known
// at some samples of a brick to its values in the band (not installed).
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/voxelize/band.h"
#include "sdfgrid/voxelize/brick_maker.h"

namespace sdfgrid {

// `values` holds 512 signed distances in voxels, not a number where none is known; they become
// world units, the background beyond the band, where samples of which nothing is known are on the
// side of those beside them. `active` gets 8 words. Returns false if the brick is of no use: no
// sample is in the band, and none can be beside the surface.
[[nodiscard]] bool finish_band_brick(const Band& band, double voxel, float values[512],
                                     std::uint64_t active[8]);

// Calls take(i, brick) for every brick of use of those at `coordinates` (in bricks), from several
// threads at once and in no order. `fill(i, values)` gives what finish_band_brick() takes.
void take_band_bricks(const std::vector<glm::ivec3>& coordinates, const Band& band, double voxel,
                      const std::function<void(std::size_t i, float values[512])>& fill,
                      const std::function<void(std::size_t i, const Brick&)>& take, const Job& job);

}  // namespace sdfgrid
