// One ray in double: the reference to which the packets of trace_primary() fall back.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "sdfgrid/trace/cubic.h"
#include "sdfgrid/trace/trace.h"
#include "sdfgrid/trace/walk.h"

namespace sdfgrid {
namespace {

constexpr int kBrick = Atlas::kBrick;

// A ray in units of cells, counted from the first slot of the tables.
struct CellRay {
  glm::dvec3 origin;
  glm::dvec3 direction;
  glm::dvec3 inverse;
  glm::ivec3 forward;  // 1 where the direction's component is not negative, else 0

  [[nodiscard]] glm::dvec3 at(double t) const { return origin + t * direction; }
};

CellRay cell_ray(const Atlas& atlas, const Ray& ray) {
  CellRay r{};
  r.origin = atlas.lattice.to_index(ray.origin) - glm::dvec3(atlas.lo * kBrick);
  r.direction = ray.direction;
  for (int a = 0; a < 3; ++a) {
    // A direction so flat never leaves its cell that way; an infinite inverse would make 0 * inf.
    constexpr double kFlat = 1e-300;
    double& d = r.direction[a];
    if (std::abs(d) < kFlat) d = kFlat;
    r.inverse[a] = 1 / d;
    r.forward[a] = d > 0 ? 1 : 0;
  }
  return r;
}

// Clips [from, to] to the box of the tables; false if nothing is left.
bool clip(const CellRay& ray, const glm::ivec3& cells, double& from, double& to) {
  for (int a = 0; a < 3; ++a) {
    const double zero = -ray.origin[a] * ray.inverse[a];
    const double end = (cells[a] - ray.origin[a]) * ray.inverse[a];
    from = std::max(from, std::min(zero, end));
    to = std::min(to, std::max(zero, end));
  }
  return from < to;
}

// Where the ray leaves the box of cells [lo, hi): the time, and the cell after, into `cell`. The
// cell never moves against the ray, and always moves along one axis, so a walk ends.
double leave(const CellRay& ray, const glm::ivec3& lo, const glm::ivec3& hi, glm::ivec3& cell) {
  int axis = 0;
  double exit = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a) {
    const double t = ((ray.forward[a] != 0 ? hi[a] : lo[a]) - ray.origin[a]) * ray.inverse[a];
    if (t < exit) {
      exit = t;
      axis = a;
    }
  }
  for (int a = 0; a < 3; ++a) {
    const bool forward = ray.forward[a] != 0;
    if (a == axis) {
      cell[a] = forward ? hi[a] : lo[a] - 1;
    } else {
      const double at = std::floor(ray.origin[a] + exit * ray.direction[a]);
      const double first = forward ? cell[a] : lo[a];
      const double last = forward ? hi[a] - 1 : cell[a];
      cell[a] = static_cast<int>(std::clamp(at, first, last));
    }
  }
  return exit;
}

void load_corners(const float* samples, const glm::ivec3& at, double (&corners)[8]) {
  for (int n = 0; n < 8; ++n) {
    const glm::ivec3 c = at + glm::ivec3(n >> 2, (n >> 1) & 1, n & 1);
    corners[n] = samples[(c.x * Atlas::kEdge + c.y) * Atlas::kEdge + c.z];
  }
}

bool contains(const glm::ivec3& cells, const glm::ivec3& cell) {
  return cell.x >= 0 && cell.y >= 0 && cell.z >= 0 && cell.x < cells.x && cell.y < cells.y &&
         cell.z < cells.z;
}

}  // namespace

Walk walk_ray(const Atlas& atlas, const Ray& world, double from, double to) {
  Walk walk;
  const CellRay ray = cell_ray(atlas, world);
  const glm::ivec3 cells = atlas.dims * kBrick;
  const double start = from;
  if (!clip(ray, cells, from, to)) return walk;
  glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor(ray.at(from))), glm::ivec3(0), cells - 1);
  // Beyond the tables all is outside.
  const bool inside = from <= start && value_at(atlas, ray.at(from)) < 0;
  double t = from;
  while (t < to && contains(cells, cell)) {
    ++walk.steps;
    const glm::ivec3 slot = cell / kBrick;
    const std::int32_t jump = atlas.jumps[atlas.place(slot)];
    if (jump < 0) {
      t = leave(ray, (slot + jump + 1) * kBrick, (slot - jump) * kBrick, cell);
      continue;
    }
    const glm::ivec3 corner = slot * kBrick;
    const glm::ivec3 at = cell - corner;
    const int hop = atlas.hops[std::size_t(jump) * Atlas::kCells + (at.x * 8 + at.y) * 8 + at.z];
    if (hop > 0) {
      t = leave(ray, glm::max(corner, cell - hop + 1), glm::min(corner + kBrick, cell + hop), cell);
      continue;
    }
    double corners[8];
    load_corners(atlas.samples.data() + std::size_t(jump) * Atlas::kSamples, at, corners);
    const Cubic cubic = cell_cubic(corners, ray.at(t) - glm::dvec3(cell), ray.direction);
    const double exit = std::min(to, leave(ray, cell, cell + 1, cell));
    const auto crossing = first_crossing(cubic, std::max(exit - t, 0.0), inside);
    if (crossing) {
      walk.hit = true;
      walk.t = t + *crossing;
      return walk;
    }
    t = exit;
  }
  return walk;
}

std::optional<double> trace_ray(const Atlas& atlas, const Ray& ray, double t_min, double t_max) {
  const double voxel = atlas.lattice.voxel;
  const Walk walk = walk_ray(atlas, ray, t_min / voxel, t_max / voxel);
  if (!walk.hit) return std::nullopt;
  return walk.t * voxel;
}

}  // namespace sdfgrid
