#include "sdfgrid/grid/grid.h"

#include <algorithm>
#include <cmath>

#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/vdb.h"

namespace sdfgrid {
namespace {

glm::dvec3 to_glm(const openvdb::Vec3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

Grid::Grid() : storage_(std::make_shared<GridStorage>()) {
  openvdb::initialize();
  storage_->vdb = openvdb::FloatGrid::create(3.0F);
  storage_->vdb->setGridClass(openvdb::GRID_LEVEL_SET);
  storage_->vdb->setName("surface");
}

Lattice Grid::lattice() const {
  const auto& transform = storage_->vdb->transform();
  return {to_glm(transform.indexToWorld(openvdb::Vec3d(0.0))), transform.voxelSize().x()};
}

float Grid::background() const { return storage_->vdb->background(); }

std::string Grid::grid_class() const {
  return openvdb::GridBase::gridClassToString(storage_->vdb->getGridClass());
}

bool Grid::is_level_set() const { return storage_->vdb->getGridClass() == openvdb::GRID_LEVEL_SET; }

std::size_t Grid::active_voxels() const { return storage_->vdb->activeVoxelCount(); }

std::size_t Grid::bricks() const { return storage_->vdb->tree().leafCount(); }

std::size_t Grid::bytes() const {
  return storage_->vdb->memUsage() + (storage_->paint ? storage_->paint->memUsage() : 0);
}

void Grid::active_bounds(glm::ivec3& lo, glm::ivec3& hi) const {
  const openvdb::CoordBBox box = storage_->vdb->evalActiveVoxelBoundingBox();
  lo = {box.min().x(), box.min().y(), box.min().z()};
  hi = {box.max().x(), box.max().y(), box.max().z()};
}

glm::ivec3 Grid::dims() const {
  glm::ivec3 lo;
  glm::ivec3 hi;
  active_bounds(lo, hi);
  const bool empty = lo.x > hi.x || lo.y > hi.y || lo.z > hi.z;
  return empty ? glm::ivec3(0) : hi - lo + 1;
}

Box Grid::bounds() const {
  glm::ivec3 lo;
  glm::ivec3 hi;
  active_bounds(lo, hi);
  Box box;
  if (lo.x > hi.x) return box;
  box.add(lattice().to_world(glm::dvec3(lo)));
  box.add(lattice().to_world(glm::dvec3(hi)));
  return box;
}

float Grid::value(const glm::ivec3& index) const {
  return storage_->vdb->tree().getValue(openvdb::Coord(index.x, index.y, index.z));
}

bool Grid::has_inside() const {
  const openvdb::FloatTree& tree = storage_->vdb->tree();
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    const float* values = leaf->buffer().data();
    if (std::any_of(values, values + openvdb::FloatTree::LeafNodeType::SIZE,
                    [](float d) { return d < 0; })) {
      return true;
    }
  }
  auto tile = tree.cbeginValueAll();
  tile.setMaxDepth(openvdb::FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    if (*tile < 0) return true;
  }
  return false;
}

std::string Grid::name() const { return storage_->vdb->getName(); }

std::string Grid::metadata(const std::string& key) const {
  const auto found = (*storage_->vdb)[key];
  return found ? found->str() : std::string();
}

std::map<std::string, std::string> Grid::all_metadata() const {
  std::map<std::string, std::string> all;
  for (auto it = storage_->vdb->beginMeta(); it != storage_->vdb->endMeta(); ++it) {
    if (it->second) all[it->first] = it->second->str();
  }
  return all;
}

void Grid::set_metadata(const std::string& key, const std::string& value) {
  storage_->vdb->removeMeta(key);
  storage_->vdb->insertMeta(key, openvdb::StringMetadata(value));
}

void Grid::set_metadata(const std::string& key, double value) {
  storage_->vdb->removeMeta(key);
  storage_->vdb->insertMeta(key, openvdb::DoubleMetadata(value));
}

void Grid::remove_metadata(const std::string& key) { storage_->vdb->removeMeta(key); }

Grid Grid::clone() const {
  auto storage = std::make_shared<GridStorage>();
  storage->vdb = storage_->vdb->deepCopy();
  if (storage_->paint) storage->paint = storage_->paint->deepCopy();
  return Grid(storage);
}

Grid from_vdb(openvdb::FloatGrid::Ptr vdb, const std::string& source) {
  openvdb::initialize();
  const auto& transform = vdb->transform();
  const openvdb::Vec3d zero = transform.indexToWorld(openvdb::Vec3d(0.0));
  const double voxel = (transform.indexToWorld(openvdb::Vec3d(1, 0, 0)) - zero).x();
  bool uniform = transform.isLinear() && std::isfinite(voxel) && voxel > 0;
  for (int a = 0; a < 3 && uniform; ++a) {
    openvdb::Vec3d unit(0.0);
    unit[a] = 1.0;
    openvdb::Vec3d step = transform.indexToWorld(unit) - zero;
    step[a] -= voxel;
    uniform = step.length() <= 1e-6 * voxel + 1e-12 * zero.length();
  }
  if (!uniform) {
    throw input_error(source, "transform", "voxels are not cubes along the axes",
                      "resample the grid to a uniform scale and translation");
  }
  if (!std::isfinite(vdb->background())) {
    throw input_error(source, "background", "the value beyond the band is not a finite number",
                      "give the grid the band's width for its background");
  }
  auto storage = std::make_shared<GridStorage>();
  storage->vdb = std::move(vdb);
  return Grid(storage);
}

}  // namespace sdfgrid
