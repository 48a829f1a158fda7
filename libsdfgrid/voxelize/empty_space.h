// voxelize/empty_space.h: signs where no triangle is near, for meshes with holes. There the border
// between inside and outside runs through empty space, so no neighbour's sign can be copied: the
// winding number decides, box by box, each box as large as one decision holds for
// (not installed).
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/core/lattice.h"
#include "sdfgrid/mesh/winding.h"
#include "sdfgrid/voxelize/brick_sign.h"

namespace sdfgrid {

struct InsideBox {
  glm::ivec3 lo;  // index of its first sample, a multiple of `edge`
  int edge;       // samples a side: 8 times a power of two
};

// A brick without triangles in which the sign changes: part of the cap that closes a hole.
struct CapBrick {
  glm::ivec3 origin;
  BrickBits negative;
};

struct EmptySpace {
  std::vector<InsideBox> inside;
  std::vector<CapBrick> caps;
};

// The signs of all bricks but those in `bricks` (origins, multiples of 8), within their bounds and
// a quarter more on every side; what is further out is outside. `shift` is lattice.origin relative
// to the soup's origin. A box gets one sign only if the bound on the winding number's gradient
// proves it.
[[nodiscard]] EmptySpace sign_empty_space(const WindingNumber& winding, const Lattice& lattice,
                                          const glm::dvec3& shift,
                                          const std::vector<glm::ivec3>& bricks, const Job& job);

}  // namespace sdfgrid
