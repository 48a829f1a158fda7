#include "sdfgrid/trace/curvature.h"

#include <glm/common.hpp>

namespace sdfgrid {
namespace {

// The seven-point Laplacian at a lattice point, 1 / voxel.
float laplacian(const Atlas& atlas, const glm::ivec3& at) {
  float sum = -6 * atlas.value(at);
  for (int a = 0; a < 3; ++a) {
    glm::ivec3 step(0);
    step[a] = 1;
    sum += atlas.value(at + step) + atlas.value(at - step);
  }
  return sum;
}

}  // namespace

float mean_curvature_at(const Atlas& atlas, const glm::dvec3& world) {
  const glm::dvec3 index = atlas.lattice.to_index(world);
  const glm::dvec3 cell = glm::floor(index);
  const glm::vec3 t(index - cell);
  float sum = 0;
  for (int n = 0; n < 8; ++n) {
    const glm::ivec3 step(n >> 2, (n >> 1) & 1, n & 1);
    float weight = 1;
    for (int a = 0; a < 3; ++a) weight *= step[a] != 0 ? t[a] : 1 - t[a];
    sum += weight * laplacian(atlas, glm::ivec3(cell) + step);
  }
  return static_cast<float>(0.5 * sum / atlas.lattice.voxel);
}

}  // namespace sdfgrid
