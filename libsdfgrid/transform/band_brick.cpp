#include "sdfgrid/transform/band_brick.h"

#include <algorithm>
#include <cmath>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/voxelize/brick_sign.h"
#include "sdfgrid/voxelize/node_bins.h"

namespace sdfgrid {
namespace {

// Voxels: the neighbour in the next brick may be on the other side, and tiles take their sign from
// there.
constexpr float kBesideSurface = 1.001F;

// Neighbours in the brick follow each other's side wherever neither is known: bits for spread().
BrickLinks all_links() {
  BrickLinks links{};
  for (int x = 0; x < 8; ++x) {
    links.link_x[x] = x == 7 ? 0 : ~0ULL;
    links.link_y[x] = 0x00ffffffffffffffULL;
    links.link_z[x] = 0x7f7f7f7f7f7f7f7fULL;
  }
  return links;
}

void spread_side(const BrickBits& known, BrickBits& negative) {
  static const BrickLinks links = all_links();
  BrickBits allowed;
  for (std::size_t x = 0; x < 8; ++x) allowed[x] = ~known[x] | negative[x];
  spread(links, allowed, negative);
}

}  // namespace

bool finish_band_brick(const Band& band, double voxel, float values[512], std::uint64_t active[8]) {
  BrickBits known{};
  BrickBits negative{};
  for (std::uint32_t s = 0; s < 512; ++s) {
    const std::uint64_t bit = 1ULL << (s & 63);
    if (std::isnan(values[s])) continue;
    known[s >> 6] |= bit;
    if (std::signbit(values[s])) negative[s >> 6] |= bit;
  }
  if (std::all_of(known.begin(), known.end(), [](std::uint64_t word) { return word == 0; })) {
    return false;
  }
  spread_side(known, negative);
  std::fill_n(active, 8, 0);
  bool needed = false;
  for (std::uint32_t s = 0; s < 512; ++s) {
    const std::uint64_t bit = 1ULL << (s & 63);
    const bool inside = (negative[s >> 6] & bit) != 0;
    const double width = inside ? band.inwidth : band.exwidth;
    const bool in_band =
        (known[s >> 6] & bit) != 0 && std::abs(static_cast<double>(values[s])) < width;
    if (in_band) active[s >> 6] |= bit;
    needed = needed || in_band || std::abs(values[s]) < kBesideSurface;
    const double v = in_band ? static_cast<double>(values[s]) : inside ? -width : width;
    values[s] = static_cast<float>(v * voxel);
  }
  return needed;
}

void take_band_bricks(const std::vector<glm::ivec3>& coordinates, const Band& band, double voxel,
                      const std::function<void(std::size_t i, float values[512])>& fill,
                      const std::function<void(std::size_t i, const Brick&)>& take,
                      const Job& job) {
  constexpr std::size_t kBricksPerTask = 32;
  parallel_for(coordinates.size(), kBricksPerTask, job, [&](std::size_t begin, std::size_t end) {
    alignas(64) float values[512];
    std::uint64_t active[8];
    for (std::size_t i = begin; i < end; ++i) {
      fill(i, values);
      if (!finish_band_brick(band, voxel, values, active)) continue;
      take(i, {coordinates[i] * kBrickEdge, values, active});
    }
  });
}

}  // namespace sdfgrid
