#include "edit/grids.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "sdfgrid/grid/vdb.h"

namespace sdfgrid::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

Grid make_grid(const std::function<double(const glm::dvec3&)>& distance, int extent, double voxel,
               double width) {
  openvdb::initialize();
  const auto background = static_cast<float>(width * voxel);
  const auto vdb = openvdb::FloatGrid::create(background);
  vdb->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
  vdb->setGridClass(openvdb::GRID_LEVEL_SET);
  vdb->setName("surface");
  openvdb::tree::ValueAccessor<openvdb::FloatTree> values(vdb->tree());
  for (int x = -extent; x <= extent; ++x) {
    for (int y = -extent; y <= extent; ++y) {
      for (int z = -extent; z <= extent; ++z) {
        const double d = distance(glm::dvec3(x, y, z));
        const openvdb::Coord at(x, y, z);
        if (std::abs(d) < width) {
          values.setValue(at, static_cast<float>(d * voxel));
        } else if (d < 0) {
          values.setValueOff(at, -background);
        }
      }
    }
  }
  vdb->pruneGrid();
  return from_vdb(vdb);
}

Grid ball_grid(double radius, double voxel, double width) {
  const int extent = static_cast<int>(std::ceil(radius + width)) + 2;
  return make_grid([radius](const glm::dvec3& p) { return glm::length(p) - radius; }, extent, voxel,
                   width);
}

Content content_of(const Grid& grid, int extent) {
  Content content;
  const auto& tree = vdb(grid)->tree();
  openvdb::tree::ValueAccessor<const openvdb::FloatTree> values(tree);
  for (int x = -extent; x <= extent; ++x) {
    for (int y = -extent; y <= extent; ++y) {
      for (int z = -extent; z <= extent; ++z) {
        const openvdb::Coord at(x, y, z);
        content.emplace_back(values.getValue(at), values.isValueOn(at));
      }
    }
  }
  return content;
}

Stroke ball_stroke(StrokeOp op, const glm::dvec3& at, double radius, double voxel) {
  Stroke stroke;
  stroke.op = op;
  stroke.brush.radius = radius * voxel;
  stroke.path = {{at * voxel}};
  return stroke;
}

double TwoBalls::to_crease(const glm::dvec3& p) const {
  const glm::dvec3 axis = b - a;
  const double d = glm::length(axis);
  const double along = (d * d + ra * ra - rb * rb) / (2 * d);
  const double radius2 = ra * ra - along * along;
  if (!(radius2 > 0)) return kInfinity;
  const double x = glm::dot(p - a, axis) / d;
  const double y = glm::length(p - a - axis * (x / d));
  return std::hypot(x - along, y - std::sqrt(radius2));
}

double TwoBalls::unite(const glm::dvec3& p) const {
  const double da = glm::length(p - a) - ra;
  const double db = glm::length(p - b) - rb;
  if (std::min(da, db) >= 0) return std::min(da, db);
  // The nearest points of the two spheres count unless the other ball covers them.
  const glm::dvec3 on_a = a + glm::normalize(p - a) * ra;
  const glm::dvec3 on_b = b + glm::normalize(p - b) * rb;
  double nearest = to_crease(p);
  if (glm::length(on_a - b) >= rb) nearest = std::min(nearest, std::abs(da));
  if (glm::length(on_b - a) >= ra) nearest = std::min(nearest, std::abs(db));
  return -nearest;
}

double TwoBalls::subtract(const glm::dvec3& p) const {
  const double da = glm::length(p - a) - ra;
  const double db = rb - glm::length(p - b);
  const glm::dvec3 on_a = a + glm::normalize(p - a) * ra;
  const glm::dvec3 on_b = b + glm::normalize(p - b) * rb;
  double nearest = to_crease(p);
  if (glm::length(on_a - b) >= rb) nearest = std::min(nearest, std::abs(da));
  if (glm::length(on_b - a) <= ra) nearest = std::min(nearest, std::abs(db));
  return std::max(da, db) < 0 ? -nearest : nearest;
}

double TwoBalls::intersect(const glm::dvec3& p) const {
  const double da = glm::length(p - a) - ra;
  const double db = glm::length(p - b) - rb;
  const glm::dvec3 on_a = a + glm::normalize(p - a) * ra;
  const glm::dvec3 on_b = b + glm::normalize(p - b) * rb;
  double nearest = to_crease(p);
  if (glm::length(on_a - b) <= rb) nearest = std::min(nearest, std::abs(da));
  if (glm::length(on_b - a) <= ra) nearest = std::min(nearest, std::abs(db));
  return std::max(da, db) < 0 ? -nearest : nearest;
}

std::vector<Stroke> random_strokes(int count, unsigned seed, double least_radius) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-18, 18);
  std::uniform_real_distribution<double> radius(least_radius, 9);
  std::vector<Stroke> strokes;
  for (int i = 0; i < count; ++i) {
    Stroke s = ball_stroke(i % 2 == 0 ? StrokeOp::unite : StrokeOp::subtract,
                           {place(random), place(random), place(random)}, radius(random));
    if (i % 3 == 0) {
      s.path.push_back({{0.1 * place(random), 0.1 * place(random), 0.1 * place(random)}, 0.6});
    }
    strokes.push_back(s);
  }
  return strokes;
}

}  // namespace sdfgrid::test
