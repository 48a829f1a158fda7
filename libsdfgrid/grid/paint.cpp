#include "sdfgrid/grid/paint.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>

#include "sdfgrid/grid/vdb.h"

namespace sdfgrid {

using PaintTree = openvdb::Int32Tree;

bool has_paint(const Grid& grid) {
  const openvdb::Int32Grid::Ptr& paint = grid.storage().paint;
  return paint && !paint->tree().empty() && paint->activeVoxelCount() > 0;
}

std::map<int, std::size_t> paint_counts(const Grid& grid) {
  std::map<int, std::size_t> counts;
  if (!grid.storage().paint) return counts;
  for (auto at = grid.storage().paint->tree().cbeginValueOn(); at; ++at) {
    counts[*at] += at.getVoxelCount();
  }
  return counts;
}

struct PaintReader::Access {
  explicit Access(const PaintTree& tree) : materials(tree) {}
  openvdb::tree::ValueAccessor<const PaintTree> materials;
};

PaintReader::PaintReader(const Grid& grid) : grid_(grid) {
  if (grid.storage().paint) access_ = std::make_unique<Access>(grid.storage().paint->tree());
}

PaintReader::~PaintReader() = default;

int PaintReader::at(const glm::dvec3& world) const {
  if (access_ == nullptr) return 0;
  const glm::dvec3 index = grid_.lattice().to_index(world);
  const glm::dvec3 low = glm::floor(index);
  const glm::dvec3 t = index - low;
  const glm::ivec3 first(low);
  std::array<int, 8> materials{};
  std::array<double, 8> weights{};
  for (int n = 0; n < 8; ++n) {
    const glm::ivec3 step(n >> 2, n >> 1 & 1, n & 1);
    const glm::dvec3 w = glm::mix(1.0 - t, t, glm::dvec3(step));
    const glm::ivec3 p = first + step;
    const int material = access_->materials.getValue(openvdb::Coord(p.x, p.y, p.z));
    const auto* known = std::find(materials.begin(), materials.begin() + n, material);
    materials[n] = material;
    weights[known - materials.begin()] += w.x * w.y * w.z;
  }
  int best = 0;
  for (int n = 1; n < 8; ++n) {
    const bool more = weights[n] > weights[best];
    if (more || (weights[n] == weights[best] && materials[n] < materials[best])) best = n;
  }
  return materials[best];
}

}  // namespace sdfgrid
