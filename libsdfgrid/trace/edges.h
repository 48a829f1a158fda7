// trace/edges.h: which pixels one ray does not do justice to; internal to trace/.
#pragma once

#include <cstdint>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/trace/shade.h"

namespace sdfgrid {

// 1 for pixels that have a silhouette or a crease between them and one of their four neighbours:
// one is hit and the other not, the surfaces they see do not continue each other, or they are of
// different materials.
[[nodiscard]] std::vector<std::uint8_t> edge_pixels(const HitBuffer& hits, const Picture& picture,
                                                    const Camera& camera, const Job& job);

}  // namespace sdfgrid
