// mesh/topology.h: who is beside whom in a triangle soup, and the pseudonormals that follow from
// it.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sdfgrid/mesh/soup.h"

namespace sdfgrid {

class Topology {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffU;

  // O(triangles); points are taken as one where they share an index.
  explicit Topology(const TriangleSoup& soup);

  // Triangles that use point v.
  [[nodiscard]] std::span<const std::uint32_t> around(std::uint32_t v) const {
    return {faces_.data() + first_[v], first_[v + 1] - first_[v]};
  }
  // The triangle across edge k (from corner k to corner k + 1) of triangle t, or kNone unless
  // exactly one other triangle has that edge, in the opposite direction. Searched for at each call:
  // conversion asks for few of them.
  [[nodiscard]] std::uint32_t across(std::uint32_t t, int k) const;

 private:
  std::vector<std::uint32_t> first_, faces_;
  std::vector<glm::uvec3> triangles_;
};

// Whether `p` (relative to soup.origin) lies behind the pseudonormal of the feature of triangle t
// that is nearest to it: the face's normal, the sum of the two faces' at an edge, the sum weighted
// by angles at a vertex. If t is the triangle nearest to p and the soup is closed and consistently
// oriented, that is whether p is inside (J. A. Baerentzen, H. Aanaes, Signed distance computation
// using the angle weighted pseudonormal, IEEE TVCG 11(3), 2005, section 4).
[[nodiscard]] bool behind_pseudonormal(const TriangleSoup& soup, const Topology& topology,
                                       std::uint32_t t, const glm::dvec3& p);

}  // namespace sdfgrid
