// transform/mesh_seeds.h: the samples beside a mesh with their exact distances and nearest
// triangles: what transforms of meshes start from (not installed).
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/core/lattice.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/transform/brick_table.h"
#include "sdfgrid/voxelize/mesh_sign.h"
#include "sdfgrid/voxelize/mesh_voxelizer.h"

namespace sdfgrid {

// Seeds are the samples nearer than some width to a triangle, in voxels. For marching: the corners
// of every cell that the surface crosses are (they are within sqrt(3) of it), and second-order
// stencils find two layers on each side. At least: beside every point of the surface there is one
// (within sqrt(3) / 2).
inline constexpr double kMarchSeedWidth = 2;
inline constexpr double kLeastSeedWidth = 1;

// What is kept of each brick with seeds.
template <class Kept>
struct MeshSeeds {
  BrickTable table;
  std::vector<std::unique_ptr<Kept>> bricks;  // as in the table
  bool contradicted = false;                  // as in MeshVoxelizer
};

// keep(brick) is called from several threads; the brick's active samples are the seeds.
template <class Kept, class Keep>
MeshSeeds<Kept> find_seeds(const SignedMesh& mesh, const Lattice& lattice, double width,
                           const Keep& keep, const Job& job) {
  struct Found {
    glm::ivec3 coordinate;
    std::unique_ptr<Kept> kept;
  };
  MeshVoxelizer voxelizer(mesh, lattice, {width, width}, job);
  // By node and place, so that threads may fill them in any order.
  std::vector<std::vector<Found>> nodes(voxelizer.nodes());
  parallel_for("seeds", voxelizer.nodes(), 1, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      std::vector<Found> found(kNodeBricks * kNodeBricks * kNodeBricks);
      const glm::ivec3 origin = voxelizer.node_origin(node);
      voxelizer.run(
          node,
          [&](const Brick& brick) {
            const glm::ivec3 at = (brick.origin - origin) / kBrickEdge;
            found[static_cast<std::size_t>((at.x * kNodeBricks + at.y) * kNodeBricks + at.z)] = {
                brick.origin / kBrickEdge, std::make_unique<Kept>(keep(brick))};
          },
          job);
      std::erase_if(found, [](const Found& brick) { return brick.kept == nullptr; });
      nodes[node] = {std::make_move_iterator(found.begin()), std::make_move_iterator(found.end())};
    }
  });
  std::vector<glm::ivec3> coordinates;
  for (const auto& node : nodes) {
    for (const Found& brick : node) coordinates.push_back(brick.coordinate);
  }
  MeshSeeds<Kept> seeds{BrickTable(std::move(coordinates)), {}, voxelizer.contradicted()};
  seeds.bricks.resize(seeds.table.size());
  for (auto& node : nodes) {
    for (Found& brick : node) {
      const auto i = static_cast<std::size_t>(seeds.table.find(brick.coordinate));
      seeds.bricks[i] = std::move(brick.kept);
    }
  }
  return seeds;
}

}  // namespace sdfgrid
