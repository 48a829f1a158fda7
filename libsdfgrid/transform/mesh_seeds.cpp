#include "sdfgrid/transform/mesh_seeds.h"

#include <algorithm>
#include <atomic>
#include <memory>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/voxelize/mesh_voxelizer.h"

namespace sdfgrid {
namespace {

struct FoundBrick {
  glm::ivec3 coordinate;
  std::unique_ptr<SeedBrick> seeds;
};

std::unique_ptr<SeedBrick> copy_seeds(const Brick& brick, double voxel) {
  auto seeds = std::make_unique<SeedBrick>();
  std::copy_n(brick.active, 8, seeds->known.begin());
  const double per_voxel = 1 / voxel;
  for (std::size_t s = 0; s < 512; ++s) {
    const std::int32_t nearest = brick.nearest[s];
    seeds->triangle[s] = nearest < 0 ? 0 : brick.triangles[nearest >> 2];
    seeds->distance[s] = static_cast<float>(static_cast<double>(brick.values[s]) * per_voxel);
  }
  return seeds;
}

}  // namespace

MeshSeeds find_seeds(const SignedMesh& mesh, const Lattice& lattice, const Job& job, double width) {
  MeshVoxelizer voxelizer(mesh, lattice, {width, width}, job);
  // By node and place, so that threads may fill them in any order.
  std::vector<std::vector<FoundBrick>> nodes(voxelizer.nodes());
  std::atomic<std::size_t> done{0};
  parallel_for(voxelizer.nodes(), 1, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      std::vector<FoundBrick> found(kNodeBricks * kNodeBricks * kNodeBricks);
      const glm::ivec3 origin = voxelizer.node_origin(node);
      voxelizer.run(
          node,
          [&](const Brick& brick) {
            const glm::ivec3 at = (brick.origin - origin) / kBrickEdge;
            found[static_cast<std::size_t>((at.x * kNodeBricks + at.y) * kNodeBricks + at.z)] = {
                brick.origin / kBrickEdge, copy_seeds(brick, lattice.voxel)};
          },
          job);
      std::erase_if(found, [](const FoundBrick& brick) { return brick.seeds == nullptr; });
      nodes[node] = {std::make_move_iterator(found.begin()), std::make_move_iterator(found.end())};
      job.report("seeds", static_cast<double>(++done) / static_cast<double>(nodes.size()));
    }
  });
  std::vector<glm::ivec3> coordinates;
  for (const auto& node : nodes) {
    for (const FoundBrick& brick : node) coordinates.push_back(brick.coordinate);
  }
  MeshSeeds seeds{BrickTable(std::move(coordinates)), {}, voxelizer.contradicted()};
  seeds.bricks.resize(seeds.table.size());
  for (auto& node : nodes) {
    for (FoundBrick& brick : node) {
      seeds.bricks[static_cast<std::size_t>(seeds.table.find(brick.coordinate))] = *brick.seeds;
      brick.seeds.reset();
    }
  }
  return seeds;
}

}  // namespace sdfgrid
