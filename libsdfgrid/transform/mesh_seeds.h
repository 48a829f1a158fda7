// transform/mesh_seeds.h: the samples beside a mesh with their exact distances and nearest
// triangles: what transforms of meshes start from (not installed).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/core/lattice.h"
#include "sdfgrid/transform/brick_table.h"
#include "sdfgrid/voxelize/mesh_sign.h"

namespace sdfgrid {

struct SeedBrick {
  std::array<float, 512> distance;          // voxels, signed; beyond the seeds no use
  std::array<std::uint32_t, 512> triangle;  // nearest, of the mesh
  std::array<std::uint64_t, 8> known;       // which samples are seeds, as in brick_kernel.h
};

struct MeshSeeds {
  // Seeds are the samples nearer than this to a triangle, in voxels, if no more is asked for. The
  // corners of every cell that the surface crosses are (they are within sqrt(3) of it), and
  // second-order stencils find two layers on each side.
  static constexpr double kWidth = 2;

  BrickTable table;
  std::vector<SeedBrick> bricks;  // as in the table
  bool contradicted = false;      // as in MeshVoxelizer
};

[[nodiscard]] MeshSeeds find_seeds(const SignedMesh& mesh, const Lattice& lattice, const Job& job,
                                   double width = MeshSeeds::kWidth);

}  // namespace sdfgrid
