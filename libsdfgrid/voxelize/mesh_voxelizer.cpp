#include "sdfgrid/voxelize/mesh_voxelizer.h"

#include <algorithm>
#include <memory>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"

namespace sdfgrid {
namespace {

constexpr std::size_t kBricksPerTask = 32;
constexpr double kLeastReach = 1.01;  // voxels: neighbours across the surface, with slack

}  // namespace

MeshVoxelizer::MeshVoxelizer(const SignedMesh& mesh, const Lattice& lattice, const Band& band,
                             const Job& job)
    : mesh_(mesh),
      lattice_(lattice),
      band_(band),
      reach_(std::max({band.exwidth, band.inwidth, kLeastReach})),
      bins_((band.exwidth >= 1 && band.inwidth >= 1)
                ? NodeBins(mesh.soup, lattice, reach_, job)
                : throw Error(ErrorKind::usage, "a band must be at least 1 voxel wide")) {}

void MeshVoxelizer::run(std::size_t node, const std::function<void(const Brick&)>& take,
                        const Job& job) {
  const glm::ivec3 node_origin = bins_.origin(node);
  const std::span<const std::uint32_t> triangles = bins_.triangles(node);
  const BrickBins bricks(mesh_.soup, lattice_, reach_, node_origin, triangles);
  parallel_for(bricks.slots().size(), kBricksPerTask, job, [&](std::size_t begin, std::size_t end) {
    const auto maker = std::make_unique<BrickMaker>(mesh_, lattice_, band_, reach_);
    for (std::size_t i = begin; i < end; ++i) {
      const int slot = bricks.slots()[i];
      maker->begin(node_origin + kBrickEdge * glm::ivec3(slot >> 8, (slot >> 4) & 15, slot & 15));
      for (const std::uint32_t local : bricks.locals(i)) {
        maker->add(bricks.record(local), triangles[local]);
      }
      const Brick brick = maker->make();
      if (maker->contradicted()) contradicted_ = true;
      if (maker->is_needed()) take(brick);
    }
  });
}

}  // namespace sdfgrid
