// trace/band_distance.h: how far it is from anywhere in an atlas's tables to the slots that hold
// its band (internal to trace/): what a narrow band does not know, and rays that are far from it
// ask for.
#pragma once

#include <cstdint>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/atlas.h"

namespace sdfgrid {

// The distance to a set of slots in the largest-coordinate norm: never more than the Euclidean one,
// by no more than a factor of the root of 3 less, and with a slope of at most 1. From within a slot
// all that it depends on is how many rings of slots around that are empty, and which of the 26
// faces, edges and corners of the next ring are not, so that it is exact everywhere.
class BandDistance {
 public:
  // Those slots hold band in which the atlas has any sample that is neither as far outside nor as
  // far inside as where it has none.
  BandDistance(const Atlas& atlas, const Job& job);

  // In voxels; 0 in a slot with band. `at` is the place in the slot at a place of the tables, in
  // voxels. Far from the band no more than what the last ring that is told apart is away.
  [[nodiscard]] double operator()(std::size_t place, const glm::dvec3& at) const;
  [[nodiscard]] bool in_band(std::size_t place) const { return (slots_[place] & kRings) == 0; }

 private:
  static constexpr std::uint32_t kRings = 31;
  static constexpr int kRingBits = 5;

  // Of each slot: in the lower bits the number of the nearest ring that is not empty, 0 in the band
  // itself, kRings if it is that or a farther one; above a bit for each part of that ring, number
  // 9 (x + 1) + 3 (y + 1) + z + 1 for the part in direction (x, y, z).
  std::vector<std::uint32_t> slots_;
};

}  // namespace sdfgrid
