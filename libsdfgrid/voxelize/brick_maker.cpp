#include "sdfgrid/voxelize/brick_maker.h"

#include <algorithm>

#include "sdfgrid/voxelize/brick_sign.h"

namespace sdfgrid {
namespace {

BrickBits signs(const SignedMesh& mesh, const BrickDistances& distances, const BrickLinks& links,
                const BrickPosition& position, std::span<const std::uint32_t> triangles,
                bool& contradicted) {
  contradicted = false;
  switch (mesh.method) {
    case SignMethod::normal: {
      const NormalSigns found = negative_by_normal(mesh, distances, links, position, triangles);
      contradicted = found.contradicted;
      return found.negative;
    }
    case SignMethod::winding:
      return negative_by_winding(*mesh.winding, links, position);
    case SignMethod::automatic:
    case SignMethod::no_sign:
      break;
  }
  return {};
}

}  // namespace

BrickMaker::BrickMaker(const SignedMesh& mesh, const Lattice& lattice, const Band& band,
                       double reach, Culling culling)
    : mesh_(mesh),
      lattice_(lattice),
      reach_(static_cast<float>(reach)),
      culling_(culling),
      widths_{static_cast<float>(lattice.voxel), static_cast<float>(band.exwidth),
              static_cast<float>(band.inwidth), static_cast<float>(band.exwidth * lattice.voxel),
              static_cast<float>(band.inwidth * lattice.voxel)} {}

void BrickMaker::begin(const glm::ivec3& origin) {
  origin_ = origin;
  frames_.clear();
  triangles_.clear();
}

void BrickMaker::add(const TriangleRecord& record, std::uint32_t triangle) {
  const double center[3] = {origin_.x + 3.5, origin_.y + 3.5, origin_.z + 3.5};
  brick_kernel().make_frame(record, center, frames_.emplace_back());
  triangles_.push_back(triangle);
}

Brick BrickMaker::make() {
  const BrickKernel& kernel = brick_kernel();
  const std::size_t count = frames_.size();
  if (lists_.size() < 32 * count) {
    lists_.resize(32 * count);
    center_distance_.resize(32 * count);
  }
  kernel.distances(frames_.data(), static_cast<std::int32_t>(count), reach_, culling_,
                   {center_distance_.data(), lists_.data()}, distances_);
  kernel.links(distances_, reach_, links_);
  const BrickPosition position{lattice_.to_world(glm::dvec3(origin_)) - mesh_.soup.origin,
                               lattice_.voxel};
  const BrickBits negative = signs(mesh_, distances_, links_, position, triangles_, contradicted_);
  kernel.finish(distances_, negative.data(), widths_, values_, active_);
  return {origin_, values_, active_, distances_.nearest, triangles_.data()};
}

bool BrickMaker::is_needed() const {
  constexpr float kNear = 1.002F;  // squared, voxels
  return std::any_of(active_, active_ + 8, [](std::uint64_t word) { return word != 0; }) ||
         std::any_of(distances_.squared, distances_.squared + 512,
                     [](float squared) { return squared < kNear; });
}

}  // namespace sdfgrid
