#include "render/scenes.h"

#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "sdfgrid/grid/vdb.h"

namespace sdfgrid::test {

Grid grid_of(const Distance& distance, const Box& box, double voxel) {
  openvdb::initialize();
  const double width = 3 * voxel;
  auto grid = openvdb::FloatGrid::create(static_cast<float>(width));
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setName("surface");
  auto values = grid->getAccessor();
  const glm::ivec3 lo(glm::floor(box.lo / voxel));
  const glm::ivec3 hi(glm::ceil(box.hi / voxel));
  for (int x = lo.x; x <= hi.x; ++x) {
    for (int y = lo.y; y <= hi.y; ++y) {
      for (int z = lo.z; z <= hi.z; ++z) {
        const double d = distance(voxel * glm::dvec3(x, y, z));
        if (std::abs(d) < width) values.setValue({x, y, z}, static_cast<float>(d));
      }
    }
  }
  openvdb::tools::signedFloodFill(grid->tree());
  return from_vdb(grid);
}

Distance sphere(const glm::dvec3& center, double radius) {
  return [=](const glm::dvec3& p) { return glm::length(p - center) - radius; };
}

Distance cuboid(const glm::dvec3& lo, const glm::dvec3& hi) {
  return [=](const glm::dvec3& p) {
    const glm::dvec3 q = glm::abs(p - 0.5 * (lo + hi)) - 0.5 * (hi - lo);
    return glm::length(glm::max(q, 0.0)) + std::min(0.0, std::max({q.x, q.y, q.z}));
  };
}

Distance either(const Distance& a, const Distance& b) {
  return [=](const glm::dvec3& p) { return std::min(a(p), b(p)); };
}

Grid unit_sphere() {
  return grid_of(sphere(glm::dvec3(0), 1), {glm::dvec3(-1.2), glm::dvec3(1.2)}, 1.0 / 32);
}

}  // namespace sdfgrid::test
