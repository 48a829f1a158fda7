// voxelize/brick_sign.h: signs of the 512 samples of a brick, from few exact decisions: a decision
// holds for all samples that can be reached without crossing the surface (not installed).
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

#include "sdfgrid/voxelize/brick_kernel.h"
#include "sdfgrid/voxelize/mesh_sign.h"

namespace sdfgrid {

using BrickBits = std::array<std::uint64_t, 8>;  // as in brick_kernel.h

// Spreads `set` over the links between samples, within `allowed`, for at most `rounds` rounds: no
// sample is more than three times as many steps away from where it started.
void spread(const BrickLinks& links, const BrickBits& allowed, BrickBits& set,
            int rounds = std::numeric_limits<int>::max());

// Position of a sample relative to soup.origin: base + voxel * (sample's place in the brick).
struct BrickPosition {
  glm::dvec3 base;
  double voxel;

  [[nodiscard]] glm::dvec3 operator()(int sample) const {
    return base + voxel * glm::dvec3(sample >> 6, (sample >> 3) & 7, sample & 7);
  }
};

struct NormalSigns {
  BrickBits negative;
  // Normals disagree about samples that no triangle separates: the mesh crosses itself nearby, and
  // the nearest triangle knows nothing of the part that it lies in.
  bool contradicted;
};

// Samples inside by pseudonormals. `triangles[i]` is the triangle of frame i.
[[nodiscard]] NormalSigns negative_by_normal(const SignedMesh& mesh,
                                             const BrickDistances& distances,
                                             const BrickLinks& links, const BrickPosition& position,
                                             std::span<const std::uint32_t> triangles);

// Samples inside by winding number.
[[nodiscard]] BrickBits negative_by_winding(const WindingNumber& winding, const BrickLinks& links,
                                            const BrickPosition& position);

}  // namespace sdfgrid
