// transform/nearest_sites.h: for every sample of a band the nearest of some sites: the feature form
// of the transform of Meijster, Roerdink and Hesselink (2000), windowed, over bricks with halos
// (not installed).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/transform/brick_table.h"

namespace sdfgrid {

using SiteBits = std::array<std::uint64_t, 8>;   // as in brick_kernel.h
using SiteKeys = std::array<std::int32_t, 512>;  // as in site_kernel.h

// The offset from a sample to its nearest site.
[[nodiscard]] inline glm::ivec3 site_offset(std::int32_t key) {
  return glm::ivec3((key >> 12 & 63) - 32, (key >> 6 & 63) - 32, (key & 63) - 32);
}

class NearestSites {
 public:
  // `sites[i]` are the sites of brick i of `table`. Keeps a reference to the table. Sites within
  // `reach` samples (1 to kLargestReach) along each axis and in space are found.
  NearestSites(const BrickTable& table, std::span<const SiteBits> sites, int reach, const Job& job);

  // The bricks that may have samples within reach of a site.
  [[nodiscard]] const BrickTable& bricks() const { return candidates_; }
  // The keys of brick i of bricks(); kNoSite where no site is in reach. False if there is none in
  // the brick. May be called from several threads.
  bool keys(std::size_t i, SiteKeys& keys) const;

 private:
  void along_z(std::span<const SiteBits> sites, const Job& job);
  void along_y(const Job& job);

  const BrickTable& table_;
  int reach_;
  std::int32_t limit_;     // the first key beyond reach
  BrickTable line_table_;  // bricks with sites along z
  std::vector<SiteKeys> line_keys_;
  BrickTable plane_table_;  // and along z and y
  std::vector<SiteKeys> plane_keys_;
  BrickTable candidates_;  // and along all three
};

}  // namespace sdfgrid
