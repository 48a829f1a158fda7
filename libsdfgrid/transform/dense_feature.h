// transform/dense_feature.h: for every sample of a dense volume the nearest of some points: the
// feature form of an exact distance transform, by lower envelopes of parabolas after P.
// Felzenszwalb and D. Huttenlocher, *Distance transforms of sampled functions* (2012) (not
// installed).
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "sdfgrid/core/job.h"

namespace sdfgrid {

inline constexpr std::uint32_t kNoFeature = 0xffffffffU;

// A point within half a sample of `at` along each axis, in index coordinates.
struct Site {
  glm::ivec3 at;
  glm::vec3 point;
};

// Writes to nearest[n] the number of the site whose point is nearest to sample n (as in
// transform.h), one of them if several are; kNoFeature everywhere if there are no sites. `sites`
// are at indices within `dims`, one at each. Exact where points are samples; else one that is
// nearly as near may win, since the sites of a row compete along the row alone. Any spacing; linear
// in the samples.
void find_nearest_sites(const glm::ivec3& dims, const glm::dvec3& spacing,
                        std::span<const Site> sites, std::span<std::uint32_t> nearest,
                        const Job& job);

}  // namespace sdfgrid
