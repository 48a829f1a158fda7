// voxelize/node_bins.h: which triangles reach which part of the lattice, in two levels (nodes of
// 16^3 bricks, bricks of 8^3 samples), so that work and memory follow the surface and not its box
// (not installed).
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/core/lattice.h"
#include "sdfgrid/mesh/soup.h"
#include "sdfgrid/voxelize/brick_kernel.h"

namespace sdfgrid {

inline constexpr int kBrickEdge = 8;    // samples
inline constexpr int kNodeBricks = 16;  // bricks
inline constexpr int kNodeEdge = kBrickEdge * kNodeBricks;

// A triangle in index space, as seen by the kernels. Triangles flatter than 1e-6 voxel become their
// longest edge. `corners` are index coordinates.
[[nodiscard]] TriangleRecord make_record(const glm::dvec3 corners[3]);

// The corners of triangle t in index coordinates of the lattice.
void index_corners(const TriangleSoup& soup, const Lattice& lattice, std::uint32_t t,
                   glm::dvec3 corners[3]);

// Triangles by node. Nodes are sorted by x, then y, then z; triangles within a node by number.
class NodeBins {
 public:
  // Keeps those nodes with a sample within `reach` voxels of a triangle (a few more where a
  // triangle is near but not that near). Throws Error{usage} if an index would leave the range of
  // 32-bit integers.
  NodeBins(const TriangleSoup& soup, const Lattice& lattice, double reach, const Job& job);

  [[nodiscard]] std::size_t size() const { return origins_.size(); }
  // Index of the node's first sample, a multiple of 128.
  [[nodiscard]] glm::ivec3 origin(std::size_t node) const { return origins_[node]; }
  [[nodiscard]] std::span<const std::uint32_t> triangles(std::size_t node) const {
    return {triangles_.data() + first_[node], first_[node + 1] - first_[node]};
  }

 private:
  std::vector<glm::ivec3> origins_;
  std::vector<std::size_t> first_;
  std::vector<std::uint32_t> triangles_;
};

// The triangles of one node by brick.
class BrickBins {
 public:
  BrickBins(const TriangleSoup& soup, const Lattice& lattice, double reach,
            const glm::ivec3& origin, std::span<const std::uint32_t> triangles);

  // Slots (16 x + y) * 16 + z of the bricks that a triangle reaches, ascending.
  [[nodiscard]] const std::vector<std::uint16_t>& slots() const { return slots_; }
  // Local numbers of the triangles that reach slots()[i].
  [[nodiscard]] std::span<const std::uint32_t> locals(std::size_t i) const {
    return {locals_.data() + first_[i], first_[i + 1] - first_[i]};
  }
  [[nodiscard]] const TriangleRecord& record(std::uint32_t local) const { return records_[local]; }

 private:
  std::vector<TriangleRecord> records_;
  std::vector<std::uint16_t> slots_;
  std::vector<std::size_t> first_;
  std::vector<std::uint32_t> locals_;
};

}  // namespace sdfgrid
