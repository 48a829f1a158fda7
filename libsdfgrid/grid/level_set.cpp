#include "sdfgrid/grid/level_set.h"

#include <openvdb/io/io.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <cstring>
#include <sstream>

namespace sdfgrid {
namespace {

// OpenVDB refuses to construct a map whose voxels are below 1.4e-5 (their volume looks like zero to
// it), but reads one from a file. Its record holds vectors that follow from the scale and the
// translation.
openvdb::math::Transform::Ptr make_transform(const Lattice& lattice) {
  const openvdb::Vec3d translation(lattice.origin.x, lattice.origin.y, lattice.origin.z);
  const double h = lattice.voxel;
  std::stringstream record;
  openvdb::io::setCurrentVersion(record);
  openvdb::writeString(record, openvdb::math::UniformScaleTranslateMap::mapType());
  translation.write(record);
  for (const double v : {h, h, 1 / h, 1 / (h * h), 0.5 / h}) openvdb::Vec3d(v).write(record);
  auto transform = std::make_shared<openvdb::math::Transform>();
  transform->read(record);
  return transform;
}

}  // namespace

LeafPointer make_leaf(const glm::ivec3& origin, const float* values, const std::uint64_t* active) {
  using Leaf = openvdb::FloatTree::LeafNodeType;
  auto leaf = std::make_unique<Leaf>(openvdb::PartialCreate(), to_coord(origin), 0.0F, false);
  leaf->allocate();
  std::memcpy(leaf->buffer().data(), values, sizeof(float) * Leaf::SIZE);
  Leaf::NodeMaskType mask;
  for (openvdb::Index word = 0; word < 8; ++word) {
    mask.getWord<openvdb::Index64>(word) = active[word];
  }
  leaf->setValueMask(mask);
  return leaf;
}

openvdb::FloatGrid::Ptr make_level_set(const Lattice& lattice, const Band& band) {
  openvdb::initialize();
  const auto grid = openvdb::FloatGrid::create(static_cast<float>(band.exwidth * lattice.voxel));
  grid->setTransform(make_transform(lattice));
  grid->setName("surface");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

void flood_interior(openvdb::FloatGrid& grid, float in_background) {
  constexpr openvdb::Index kAboveLeaves = 1;  // the bricks came out whole
  openvdb::tools::signedFloodFillWithValues(grid.tree(), grid.background(), -in_background, true, 1,
                                            kAboveLeaves);
}

}  // namespace sdfgrid
