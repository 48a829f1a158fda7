#include "sdfgrid/grid/dense.h"

#include <fmt/format.h>
#include <openvdb/tools/Dense.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/memory.h"
#include "sdfgrid/grid/vdb.h"

namespace sdfgrid {
namespace {

// Adds the brick at `origin`, all of it that is within the volume.
void add_brick(const Volume& distances, const std::vector<float>& samples,
               const openvdb::Coord& origin, openvdb::FloatTree& tree) {
  auto* leaf = tree.touchLeaf(origin);
  for (openvdb::Index n = 0; n < openvdb::FloatTree::LeafNodeType::SIZE; ++n) {
    const openvdb::Coord at = leaf->offsetToGlobalCoord(n);
    if (at.x() >= distances.dims.x || at.y() >= distances.dims.y || at.z() >= distances.dims.z) {
      continue;
    }
    leaf->setValueOn(n, samples[distances.place({at.x(), at.y(), at.z()})]);
  }
}

openvdb::FloatGrid::Ptr make_vdb(const Volume& distances, const std::vector<float>& samples,
                                 float background) {
  openvdb::initialize();
  float farthest = 0;
  float least = 0;
  for (const float d : samples) {
    farthest = std::max(farthest, std::abs(d));
    least = std::min(least, d);
  }
  const auto grid = openvdb::FloatGrid::create(background > 0 ? background : farthest);
  const auto transform = openvdb::math::Transform::createLinearTransform(distances.spacing.x);
  transform->postTranslate({distances.origin.x, distances.origin.y, distances.origin.z});
  grid->setTransform(transform);
  grid->setName("surface");
  grid->setGridClass(least < 0 ? openvdb::GRID_LEVEL_SET : openvdb::GRID_UNKNOWN);
  return grid;
}

}  // namespace

Volume to_volume(const Grid& grid, int margin) {
  glm::ivec3 lo;
  glm::ivec3 hi;
  grid.active_bounds(lo, hi);
  if (lo.x > hi.x) throw Error(ErrorKind::input, "the grid has no active voxels");
  return to_volume(grid, lo - margin, hi + margin);
}

Volume to_volume(const Grid& grid, const glm::ivec3& lo, const glm::ivec3& hi) {
  const Lattice lattice = grid.lattice();
  Volume volume;
  volume.dims = hi - lo + 1;
  volume.spacing = glm::dvec3(lattice.voxel);
  volume.origin = lattice.to_world(glm::dvec3(lo));
  check_fits(static_cast<double>(volume.size()) * sizeof(float),
             fmt::format("a dense volume of {} x {} x {} samples", volume.dims.x, volume.dims.y,
                         volume.dims.z),
             "write a .vdb, or use larger voxels");
  std::vector<float> samples(volume.size());
  using View = openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ>;
  View view(openvdb::CoordBBox({lo.x, lo.y, lo.z}, {hi.x, hi.y, hi.z}), samples.data());
  openvdb::tools::copyToDense(*vdb(grid), view, /*serial=*/true);  // threads are core/parallel's
  volume.samples = std::move(samples);
  return volume;
}

Grid to_grid(const Volume& distances, double background) {
  const auto* samples = std::get_if<std::vector<float>>(&distances.samples);
  const glm::dvec3& spacing = distances.spacing;
  const double difference =
      std::max(std::abs(spacing.y - spacing.x), std::abs(spacing.z - spacing.x));
  if (samples == nullptr || difference > 1e-6 * spacing.x || !distances.axis_aligned()) {
    throw Error(ErrorKind::usage,
                "a grid has cubic voxels along the world's axes; write .nrrd or .vti, which hold "
                "any spacing and orientation");
  }
  const auto grid = make_vdb(distances, *samples, static_cast<float>(background));
  constexpr int kEdge = 8;
  for (int x = 0; x < distances.dims.x; x += kEdge) {
    for (int y = 0; y < distances.dims.y; y += kEdge) {
      for (int z = 0; z < distances.dims.z; z += kEdge) {
        add_brick(distances, *samples, {x, y, z}, grid->tree());
      }
    }
  }
  return from_vdb(grid);
}

}  // namespace sdfgrid
