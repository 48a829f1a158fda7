#include "sdfgrid/voxelize/mesh_voxelizer.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/voxelize/brick_kernel.h"
#include "sdfgrid/voxelize/brick_sign.h"

namespace sdfgrid {
namespace {

constexpr std::size_t kBricksPerTask = 32;
constexpr double kLeastReach = 1.01;  // voxels: neighbours across the surface, with slack

// Buffers of one thread, reused from brick to brick.
struct Workspace {
  std::vector<TriangleFrame> frames;
  std::vector<std::uint32_t> triangles;  // of the mesh, by frame
  std::vector<float> center_distance;
  std::vector<std::int32_t> lists;
  BrickDistances distances;
  BrickLinks links;
  alignas(64) float values[512];
  std::uint64_t active[8];

  void reserve(std::size_t count) {
    frames.resize(count);
    triangles.resize(count);
    if (lists.size() < 32 * count) {
      lists.resize(32 * count);
      center_distance.resize(32 * count);
    }
  }
};

// Whether the brick is needed: a sample is in the band, or so near to the surface that its
// neighbour in the next brick, from which tiles take their sign, may be on the other side.
bool is_needed(const Workspace& work) {
  constexpr float kNear = 1.002F;  // squared, voxels
  return std::any_of(work.active, work.active + 8, [](std::uint64_t word) { return word != 0; }) ||
         std::any_of(work.distances.squared, work.distances.squared + 512,
                     [](float squared) { return squared < kNear; });
}

BrickBits signs(const SignedMesh& mesh, const Workspace& work, const BrickPosition& position,
                std::atomic<bool>& contradicted) {
  switch (mesh.method) {
    case SignMethod::normal: {
      const NormalSigns signs =
          negative_by_normal(mesh, work.distances, work.links, position, work.triangles);
      if (signs.contradicted) contradicted = true;
      return signs.negative;
    }
    case SignMethod::winding:
      return negative_by_winding(*mesh.winding, work.links, position);
    case SignMethod::automatic:
    case SignMethod::no_sign:
      break;
  }
  return {};
}

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
  const BrickKernel& kernel = brick_kernel();
  const glm::ivec3 node_origin = bins_.origin(node);
  const std::span<const std::uint32_t> triangles = bins_.triangles(node);
  const BrickBins bricks(mesh_.soup, lattice_, reach_, node_origin, triangles);
  const BandWidths widths = {static_cast<float>(lattice_.voxel), static_cast<float>(band_.exwidth),
                             static_cast<float>(band_.inwidth),
                             static_cast<float>(band_.exwidth * lattice_.voxel),
                             static_cast<float>(band_.inwidth * lattice_.voxel)};
  parallel_for(bricks.slots().size(), kBricksPerTask, job, [&](std::size_t begin, std::size_t end) {
    const auto work = std::make_unique<Workspace>();
    for (std::size_t i = begin; i < end; ++i) {
      const int slot = bricks.slots()[i];
      const glm::ivec3 origin =
          node_origin + kBrickEdge * glm::ivec3(slot >> 8, (slot >> 4) & 15, slot & 15);
      const double center[3] = {origin.x + 3.5, origin.y + 3.5, origin.z + 3.5};
      const std::span<const std::uint32_t> locals = bricks.locals(i);
      work->reserve(locals.size());
      for (std::size_t j = 0; j < locals.size(); ++j) {
        kernel.make_frame(bricks.record(locals[j]), center, work->frames[j]);
        work->triangles[j] = triangles[locals[j]];
      }
      kernel.distances(work->frames.data(), static_cast<std::int32_t>(locals.size()),
                       static_cast<float>(reach_),
                       {work->center_distance.data(), work->lists.data()}, work->distances);
      kernel.links(work->distances, static_cast<float>(reach_), work->links);
      const BrickPosition position{lattice_.to_world(glm::dvec3(origin)) - mesh_.soup.origin,
                                   lattice_.voxel};
      const BrickBits negative = signs(mesh_, *work, position, contradicted_);
      kernel.finish(work->distances, negative.data(), widths, work->values, work->active);
      if (is_needed(*work)) take({origin, work->values, work->active});
    }
  });
}

}  // namespace sdfgrid
