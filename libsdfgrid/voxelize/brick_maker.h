// voxelize/brick_maker.h: one brick of signed distances from the triangles that may be nearest to
// its samples (not installed).
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/voxelize/band.h"
#include "sdfgrid/voxelize/brick_kernel.h"
#include "sdfgrid/voxelize/mesh_sign.h"

namespace sdfgrid {

// One brick of 8^3 samples; z fastest. The pointers are good until the maker's next brick.
struct Brick {
  glm::ivec3 origin;            // index of its first sample, a multiple of 8
  const float* values;          // 512; world units, negative inside, the background beyond the band
  const std::uint64_t* active;  // 8 words: which samples are in the band
  // For each sample the triangle nearest to it is triangles[nearest >> 2]; none if nearest is
  // negative. Null where a transform made the brick.
  const std::int32_t* nearest = nullptr;
  const std::uint32_t* triangles = nullptr;
};

// The buffers of one thread, reused from brick to brick: begin(), add() each triangle, make().
class BrickMaker {
 public:
  // Keeps a reference to the mesh. Distances are exact up to `reach` voxels if all triangles within
  // that of a sample are added (to Culling::smooth where surfaces are).
  BrickMaker(const SignedMesh& mesh, const Lattice& lattice, const Band& band, double reach,
             Culling culling = Culling::exact);

  void begin(const glm::ivec3& origin);
  void add(const TriangleRecord& record, std::uint32_t triangle);
  [[nodiscard]] Brick make();

  // Whether the brick just made is needed: a sample is in the band, or so near to the surface that
  // its neighbour in the next brick, from which tiles take their sign, may be on the other side.
  [[nodiscard]] bool is_needed() const;
  // Whether the normals of its triangles disagreed (see NormalSigns).
  [[nodiscard]] bool contradicted() const { return contradicted_; }

 private:
  const SignedMesh& mesh_;
  Lattice lattice_;
  float reach_;
  Culling culling_;
  BandWidths widths_;
  glm::ivec3 origin_{0};
  std::vector<TriangleFrame> frames_;
  std::vector<std::uint32_t> triangles_;  // of the mesh, by frame
  std::vector<float> center_distance_;
  std::vector<std::int32_t> lists_;
  BrickDistances distances_;
  BrickLinks links_;
  alignas(64) float values_[512];
  std::uint64_t active_[8];
  bool contradicted_ = false;
};

}  // namespace sdfgrid
