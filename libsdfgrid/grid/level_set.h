// grid/level_set.h: how conversions put OpenVDB level sets together (internal to grid/).
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/grid/vdb.h"
#include "sdfgrid/voxelize/band.h"

namespace sdfgrid {

using LeafPointer = std::unique_ptr<openvdb::FloatTree::LeafNodeType>;

inline openvdb::Coord to_coord(const glm::ivec3& v) { return {v.x, v.y, v.z}; }

// A leaf of 512 samples, z fastest, from `origin` on, a multiple of 8; of `active` 8 words.
[[nodiscard]] LeafPointer make_leaf(const glm::ivec3& origin, const float* values,
                                    const std::uint64_t* active);

// An empty level set called `surface` whose background is the band's outer width.
[[nodiscard]] openvdb::FloatGrid::Ptr make_level_set(const Lattice& lattice, const Band& band);

// Gives what the leaves enclose the value -in_background: beyond the band every sample is on the
// side of its neighbours. The leaves must be closed around it.
void flood_interior(openvdb::FloatGrid& grid, float in_background);

}  // namespace sdfgrid
