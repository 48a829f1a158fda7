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

// A ray in units of cells, counted from the first slot of the tables, and mirrored so that it runs
// towards growing coordinates on all axes; a mirrored cell c is the cell ~c of the lattice.
struct CellRay {
  glm::dvec3 origin;
  glm::dvec3 direction;  // > 0
  glm::dvec3 inverse;
  glm::ivec3 flip;  // -1 where mirrored, else 0
  int octant = 0;   // as in Atlas

  [[nodiscard]] glm::ivec3 real(const glm::ivec3& cell) const { return cell ^ flip; }
  // Exact, so the same serves for directions.
  [[nodiscard]] glm::dvec3 real(const glm::dvec3& place) const {
    return glm::dvec3(2 * flip + 1) * place;
  }
  [[nodiscard]] glm::dvec3 at(double t) const { return origin + t * direction; }
};

CellRay cell_ray(const Atlas& atlas, const Ray& ray) {
  CellRay r;
  const glm::dvec3 origin = atlas.lattice.to_index(ray.origin) - glm::dvec3(atlas.lo * kBrick);
  for (int a = 0; a < 3; ++a) {
    r.flip[a] = ray.direction[a] < 0 ? -1 : 0;
    r.octant = 2 * r.octant - r.flip[a];
    // A ray so flat never leaves its cell that way; an infinite inverse would make 0 * inf.
    r.direction[a] = std::max(std::abs(ray.direction[a]), 1e-300);
    r.inverse[a] = 1 / r.direction[a];
  }
  r.origin = r.real(origin);
  return r;
}

// Clips [from, to] to the mirrored box of cells [lo, hi); false if nothing is left.
bool clip(const CellRay& ray, const glm::ivec3& lo, const glm::ivec3& hi, double& from,
          double& to) {
  for (int a = 0; a < 3; ++a) {
    from = std::max(from, (lo[a] - ray.origin[a]) * ray.inverse[a]);
    to = std::min(to, (hi[a] - ray.origin[a]) * ray.inverse[a]);
  }
  return from < to;
}

// When the ray reaches the first of the planes before the cells `past`, and into `cell` the cell
// there. The cell never moves back, and always moves along one axis, so a walk ends.
double leave(const CellRay& ray, const glm::ivec3& past, glm::ivec3& cell) {
  const glm::dvec3 times = (glm::dvec3(past) - ray.origin) * ray.inverse;
  const double exit = std::min({times.x, times.y, times.z});
  const glm::dvec3 place = ray.at(exit);
  for (int a = 0; a < 3; ++a) {
    const double reached = std::clamp<double>(std::floor(place[a]), cell[a], past[a] - 1);
    cell[a] = times[a] <= exit ? past[a] : static_cast<int>(reached);
  }
  return exit;
}

// The edge of the empty cube ahead of a cell of a crossing brick, in cells; 0 if it is crossing.
int hop(const Atlas& atlas, std::int32_t brick, int octant, const glm::ivec3& cell) {
  const std::uint32_t* hops =
      atlas.hops.data() + std::size_t(brick) * Atlas::kHops + octant * kBrick * kBrick;
  const glm::ivec3 at = cell & (kBrick - 1);
  return static_cast<int>(hops[at.x * kBrick + at.y] >> (4 * at.z) & 15U);
}

void load_corners(const Atlas& atlas, std::int32_t brick, const glm::ivec3& at,
                  double (&corners)[8]) {
  const float* samples = atlas.samples.data() + std::size_t(brick) * Atlas::kSamples;
  for (int n = 0; n < 8; ++n) {
    const glm::ivec3 c = at + glm::ivec3(n >> 2, (n >> 1) & 1, n & 1);
    corners[n] = samples[(c.x * Atlas::kEdge + c.y) * Atlas::kEdge + c.z];
  }
}

bool before(const glm::ivec3& cell, const glm::ivec3& end) {
  return cell.x < end.x && cell.y < end.y && cell.z < end.z;
}

}  // namespace

Walk walk_ray(const Atlas& atlas, const Ray& world, double from, double to) {
  Walk walk;
  const CellRay ray = cell_ray(atlas, world);
  const glm::ivec3 cells = atlas.dims * kBrick;
  const glm::ivec3 lo = cells * ray.flip;
  const glm::ivec3 hi = lo + cells;
  const double start = from;
  if (!clip(ray, lo, hi, from, to)) return walk;
  glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor(ray.at(from))), lo, hi - 1);
  // Beyond the tables all is outside.
  const bool inside = from <= start && value_at(atlas, ray.real(ray.at(from))) < 0;
  for (double t = from; t < to && before(cell, hi);) {
    ++walk.steps;
    const glm::ivec3 real = ray.real(cell);
    const std::size_t place = atlas.place(real >> 3);
    const int jump = atlas.jump(ray.octant, place);
    if (jump > 0) {
      t = leave(ray, (cell & ~7) + kBrick * jump, cell);
      continue;
    }
    const std::int32_t brick = atlas.bricks[place];
    const int edge = hop(atlas, brick, ray.octant, cell);
    if (edge > 0) {
      t = leave(ray, glm::min(cell + edge, (cell | 7) + 1), cell);
      continue;
    }
    double corners[8];
    load_corners(atlas, brick, real & 7, corners);
    const Cubic cubic =
        cell_cubic(corners, ray.real(ray.at(t)) - glm::dvec3(real), ray.real(ray.direction));
    const double exit = std::min(to, leave(ray, cell + 1, cell));
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
