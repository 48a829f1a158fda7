#include "sdfgrid/voxelize/brick_sign.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "sdfgrid/mesh/winding.h"

namespace sdfgrid {
namespace {

constexpr std::uint64_t kAll = ~0ULL;
constexpr double kStepsPerRound = 3;  // of spread(): one along each axis

int lowest(const BrickBits& set) {
  for (int x = 0; x < 8; ++x) {
    if (set[x] != 0) return 64 * x + std::countr_zero(set[x]);
  }
  return -1;
}

BrickBits single(int sample) {
  BrickBits set{};
  set[sample >> 6] = 1ULL << (sample & 63);
  return set;
}

BrickBits without(const BrickBits& a, const BrickBits& b) {
  BrickBits r;
  for (int x = 0; x < 8; ++x) r[x] = a[x] & ~b[x];
  return r;
}

BrickBits both(const BrickBits& a, const BrickBits& b) {
  BrickBits r;
  for (int x = 0; x < 8; ++x) r[x] = a[x] & b[x];
  return r;
}

void add(BrickBits& a, const BrickBits& b) {
  for (int x = 0; x < 8; ++x) a[x] |= b[x];
}

BrickBits everything() {
  BrickBits set;
  set.fill(kAll);
  return set;
}

// Asks for every sample of `open` by itself.
BrickBits each_by_winding(const WindingNumber& winding, const BrickBits& open,
                          const BrickPosition& position) {
  std::array<double, WindingNumber::kCubePoints> w;
  winding.at_cube(position.base, position.voxel, w);
  BrickBits inside{};
  for (std::size_t s = 0; s < w.size(); ++s) {
    if (w[s] > 0.5) inside[s >> 6] |= 1ULL << (s & 63);
  }
  return both(inside, open);
}

}  // namespace

void spread(const BrickLinks& links, const BrickBits& allowed, BrickBits& set, int rounds) {
  bool grew = true;
  for (int round = 0; grew && round < rounds; ++round) {
    grew = false;
    for (int x = 0; x < 8; ++x) {
      std::uint64_t s = set[x];
      s |= (s & links.link_z[x]) << 1 | (s >> 1 & links.link_z[x]);
      s |= (s & links.link_y[x]) << 8 | (s >> 8 & links.link_y[x]);
      if (x > 0) s |= set[x - 1] & links.link_x[x - 1];
      if (x < 7) s |= set[x + 1] & links.link_x[x];
      s &= allowed[x];
      grew = grew || s != set[x];
      set[x] = s;
    }
  }
}

NormalSigns negative_by_normal(const SignedMesh& mesh, const BrickDistances& distances,
                               const BrickLinks& links, const BrickPosition& position,
                               std::span<const std::uint32_t> triangles) {
  // Above and below faces the kernel has seen the sign; most other samples are linked to those.
  BrickBits negative;
  BrickBits positive;
  for (int x = 0; x < 8; ++x) {
    negative[x] = links.negative[x];
    positive[x] = links.known[x] & ~links.negative[x];
  }
  spread(links, without(everything(), positive), negative);
  spread(links, without(everything(), negative), positive);
  for (;;) {
    BrickBits open = without(without(everything(), negative), positive);
    int sample = -1;
    // Samples out of reach of all triangles are linked to all their neighbours: they wait.
    while ((sample = lowest(open)) >= 0 && distances.nearest[sample] < 0) {
      open[sample >> 6] &= ~(1ULL << (sample & 63));
    }
    if (sample < 0) break;
    const std::uint32_t t = triangles[static_cast<std::size_t>(distances.nearest[sample] >> 2)];
    BrickBits same = single(sample);
    const BrickBits undecided = without(without(everything(), negative), positive);
    spread(links, undecided, same);
    add(behind_pseudonormal(mesh.soup, *mesh.topology, t, position(sample)) ? negative : positive,
        same);
  }
  BrickBits reached = negative;
  spread(links, everything(), reached, 1);
  return {negative, reached != negative};
}

BrickBits negative_by_winding(const WindingNumber& winding, const BrickLinks& links,
                              const BrickPosition& position) {
  BrickBits negative{};
  BrickBits open = everything();
  const glm::dvec3 center = position.base + position.voxel * 3.5;
  const double radius = position.voxel * 3.5 * std::sqrt(3.0);
  const double slope = winding.gradient_bound(center, radius);
  for (int sample = lowest(open); sample >= 0; sample = lowest(open)) {
    const double w = winding.at(position(sample));
    // As far as the winding number cannot reach one half without crossing a triangle.
    const double margin = std::abs(w - 0.5) - winding.tolerance();
    const double rounds = margin / (slope * kStepsPerRound * position.voxel);  // inf if closed
    if (!(rounds >= 1)) {
      // Near a border of the mesh one answer is good for one sample.
      add(negative, each_by_winding(winding, open, position));
      break;
    }
    BrickBits same = single(sample);
    spread(links, open, same, static_cast<int>(std::min(rounds, 512.0)));
    if (w > 0.5) add(negative, same);
    open = without(open, same);
  }
  return negative;
}

}  // namespace sdfgrid
