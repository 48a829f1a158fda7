#include "trace/lattice_field.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "sdfgrid/grid/vdb.h"
#include "trace/bisection.h"

namespace sdfgrid::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The next plane of an axis that a ray meets, by number and when.
struct Plane {
  int next;
  int step;
  double origin, direction;
  [[nodiscard]] double time() const {
    return direction == 0 ? kInfinity : (next - origin) / direction;
  }
};

}  // namespace

LatticeField::LatticeField(const Grid& grid) : lattice_(grid.lattice()) {
  const auto& tree = vdb(grid)->tree();
  outside_ = static_cast<float>(tree.background() / lattice_.voxel);
  openvdb::CoordBBox box;
  for (auto value = tree.cbeginValueAll(); value; ++value) {
    if (*value != tree.background()) box.expand(value.getBoundingBox());
  }
  const auto first = box.min();
  lo_ = glm::ivec3(first.x(), first.y(), first.z()) - 2;
  const auto last = box.max();
  size_ = glm::ivec3(last.x(), last.y(), last.z()) + 3 - lo_;
  samples_.reserve(std::size_t(size_.x) * size_.y * size_.z);
  const auto values = vdb(grid)->getConstAccessor();
  for (int x = 0; x < size_.x; ++x) {
    for (int y = 0; y < size_.y; ++y) {
      for (int z = 0; z < size_.z; ++z) {
        const float value = values.getValue({lo_.x + x, lo_.y + y, lo_.z + z});
        samples_.push_back(static_cast<float>(value / lattice_.voxel));
      }
    }
  }
  mark_cells();
}

void LatticeField::mark_cells() {
  near_zero_.resize(samples_.size());
  for (int x = 0; x + 1 < size_.x; ++x) {
    for (int y = 0; y + 1 < size_.y; ++y) {
      for (int z = 0; z + 1 < size_.z; ++z) {
        const glm::ivec3 cell = lo_ + glm::ivec3(x, y, z);
        float low = sample(cell);
        float high = low;
        for (int n = 1; n < 8; ++n) {
          const float value = sample(cell + glm::ivec3(n >> 2, (n >> 1) & 1, n & 1));
          low = std::min(low, value);
          high = std::max(high, value);
        }
        near_zero_[place(cell)] = static_cast<char>(low <= 1e-6F && high >= -1e-6F);
      }
    }
  }
}

std::size_t LatticeField::place(const glm::ivec3& index) const {
  const glm::ivec3 at = index - lo_;
  return (std::size_t(at.x) * size_.y + at.y) * size_.z + at.z;
}

float LatticeField::sample(const glm::ivec3& index) const {
  for (int a = 0; a < 3; ++a) {
    if (index[a] < lo_[a] || index[a] >= lo_[a] + size_[a]) return outside_;
  }
  return samples_[place(index)];
}

double LatticeField::in_cell(const glm::ivec3& cell, const glm::dvec3& point) const {
  const glm::dvec3 w = point - glm::dvec3(cell);
  const float* p = samples_.data() + place(cell);
  const std::ptrdiff_t x = std::ptrdiff_t(size_.y) * size_.z;
  const std::ptrdiff_t y = size_.z;
  const auto along_z = [&](const float* v) { return v[0] + w.z * (double(v[1]) - v[0]); };
  const auto along_y = [&](const float* v) {
    const double v0 = along_z(v);
    return v0 + w.y * (along_z(v + y) - v0);
  };
  const double v0 = along_y(p);
  return v0 + w.x * (along_y(p + x) - v0);
}

double LatticeField::at(const glm::dvec3& point) const {
  const glm::ivec3 cell(glm::floor(point));
  for (int a = 0; a < 3; ++a) {
    if (cell[a] < lo_[a] || cell[a] >= hi()[a]) return outside_;
  }
  return in_cell(cell, point);
}

bool LatticeField::clip(const Ray& ray, double& from, double& to) const {
  for (int a = 0; a < 3; ++a) {
    const double below = lo_[a] - ray.origin[a];
    const double above = hi()[a] - ray.origin[a];
    if (ray.direction[a] == 0) {
      if (below >= 0 || above <= 0) return false;
      continue;
    }
    const double t0 = below / ray.direction[a];
    const double t1 = above / ray.direction[a];
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  }
  return from < to;
}

Crossing LatticeField::first_crossing(const Ray& world, double from) const {
  const Ray ray{lattice_.to_index(world.origin), world.direction};
  Crossing result;
  const double sign = at(ray.origin + from * ray.direction) < 0 ? -1 : 1;
  double to = kInfinity;
  if (!clip(ray, from, to)) return result;
  Plane planes[3];
  for (int a = 0; a < 3; ++a) {
    const double d = ray.direction[a];
    const double start = ray.origin[a] + from * d;
    planes[a] = {int(d > 0 ? std::floor(start) : std::ceil(start)), d > 0 ? 1 : -1, ray.origin[a],
                 d};
    while (planes[a].time() <= from) planes[a].next += planes[a].step;
  }
  for (double t = from; t < to;) {
    const double exit = std::min({planes[0].time(), planes[1].time(), planes[2].time(), to});
    for (Plane& plane : planes) {
      if (plane.time() <= exit) plane.next += plane.step;
    }
    // Its middle says in which cell a piece lies, whatever the rounding at its ends.
    const glm::dvec3 middle = ray.origin + 0.5 * (t + exit) * ray.direction;
    const glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor(middle)), lo_, hi() - 1);
    if (near_zero_[place(cell)] != 0) {
      const auto f = [&](double s) { return sign * in_cell(cell, ray.origin + s * ray.direction); };
      if (!result.early) result.early = first_at_most<double>(f, t, exit, kDoubt);
      result.late = first_at_most<double>(f, t, exit, -kDoubt);
      if (result.late) return result;
    }
    t = exit;
  }
  return result;
}

}  // namespace sdfgrid::test
