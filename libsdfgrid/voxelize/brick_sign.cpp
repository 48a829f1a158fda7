#include "sdfgrid/voxelize/brick_sign.h"

#include <bit>
#include <cmath>

#include "sdfgrid/mesh/winding.h"

namespace sdfgrid {
namespace {

constexpr std::uint64_t kAll = ~0ULL;

int lowest(const BrickBits& set) {
  for (int x = 0; x < 8; ++x) {
    if (set[x] != 0) return 64 * x + std::countr_zero(set[x]);
  }
  return -1;
}

bool empty(const BrickBits& set) { return lowest(set) < 0; }

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

void add(BrickBits& a, const BrickBits& b) {
  for (int x = 0; x < 8; ++x) a[x] |= b[x];
}

BrickBits everything() {
  BrickBits set;
  set.fill(kAll);
  return set;
}

}  // namespace

int spread(const BrickLinks& links, const BrickBits& allowed, BrickBits& set) {
  int rounds = 0;
  for (bool grew = true; grew; ++rounds) {
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
  return rounds;
}

BrickBits negative_by_normal(const SignedMesh& mesh, const BrickDistances& distances,
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
  return negative;
}

BrickBits negative_by_winding(const WindingNumber& winding, const BrickLinks& links,
                              const BrickPosition& position) {
  BrickBits negative{};
  BrickBits open = everything();
  const glm::dvec3 center = position.base + position.voxel * 3.5;
  const double radius = position.voxel * 3.5 * std::sqrt(3.0);
  const double slope = winding.gradient_bound(center, radius);
  for (int sample = lowest(open); sample >= 0; sample = lowest(open)) {
    BrickBits same = single(sample);
    const int rounds = spread(links, open, same);
    const double w = winding.at(position(sample));
    open = without(open, same);
    if (std::abs(w - 0.5) > slope * 3 * rounds * position.voxel + winding.tolerance()) {
      if (w > 0.5) add(negative, same);
      continue;
    }
    // A border of the mesh is near: the winding number varies within the set.
    while (!empty(same)) {
      const int s = lowest(same);
      if (winding.at(position(s)) > 0.5) add(negative, single(s));
      same = without(same, single(s));
    }
  }
  return negative;
}

}  // namespace sdfgrid
