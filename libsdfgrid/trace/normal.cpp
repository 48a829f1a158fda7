#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "sdfgrid/trace/trace.h"
#include "sdfgrid/trace/walk.h"

namespace sdfgrid {
namespace {

// A place split into its cell and the position therein; far places saturate.
struct Place {
  explicit Place(const glm::dvec3& index)
      : cell(glm::clamp(glm::floor(index), glm::dvec3(-1e9), glm::dvec3(1e9))),
        at(glm::clamp(index - glm::dvec3(cell), 0.0, 1.0)) {}
  glm::ivec3 cell;
  glm::dvec3 at;

  // The weight of the corner that `offset`, of zeros and ones, leads to.
  [[nodiscard]] double weight(const glm::ivec3& offset) const {
    double w = 1;
    for (int a = 0; a < 3; ++a) w *= offset[a] != 0 ? at[a] : 1 - at[a];
    return w;
  }
};

glm::ivec3 corner(int n) { return {n >> 2, (n >> 1) & 1, n & 1}; }

double interpolate(const Atlas& atlas, const glm::dvec3& index) {
  const Place place(index);
  double sum = 0;
  for (int n = 0; n < 8; ++n) {
    sum += place.weight(corner(n)) * double(atlas.value(place.cell + corner(n)));
  }
  return sum;
}

}  // namespace

double value_at(const Atlas& atlas, const glm::dvec3& place) {
  return interpolate(atlas, place + glm::dvec3(atlas.lo * Atlas::kBrick));
}

float distance_at(const Atlas& atlas, const glm::dvec3& world) {
  const double voxels = interpolate(atlas, atlas.lattice.to_index(world));
  return static_cast<float>(voxels * atlas.lattice.voxel);
}

glm::vec3 normal_at(const Atlas& atlas, const glm::dvec3& world) {
  const Place place(atlas.lattice.to_index(world));
  glm::dvec3 gradient(0.0);
  for (int n = 0; n < 8; ++n) {
    const glm::ivec3 at = place.cell + corner(n);
    const double weight = place.weight(corner(n));
    for (int a = 0; a < 3; ++a) {
      glm::ivec3 step(0);
      step[a] = 1;
      gradient[a] += weight * (double(atlas.value(at + step)) - double(atlas.value(at - step)));
    }
  }
  const double length = glm::length(gradient);
  return length > 0 ? glm::vec3(gradient / length) : glm::vec3(0.0F);
}

}  // namespace sdfgrid
