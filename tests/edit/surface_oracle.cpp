#include "edit/surface_oracle.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sdfgrid::test {
namespace {

long key_of(const glm::ivec3& c) {
  return (static_cast<long>(c.x + 4096) << 32) | (static_cast<long>(c.y + 4096) << 16) |
         (c.z + 4096);
}

constexpr double kCell = 4;  // voxels a side, of CarvedBalls

double trilinear(const double (&c)[8], const glm::dvec3& t) {
  double sum = 0;
  for (int n = 0; n < 8; ++n) {
    const double wx = (n & 4) != 0 ? t.x : 1 - t.x;
    const double wy = (n & 2) != 0 ? t.y : 1 - t.y;
    const double wz = (n & 1) != 0 ? t.z : 1 - t.z;
    sum += wx * wy * wz * c[n];
  }
  return sum;
}

}  // namespace

long SurfaceOracle::key(const glm::ivec3& c) { return key_of(c); }

const SurfaceOracle::Cell* SurfaceOracle::cell(const glm::ivec3& at) const {
  const auto found = cells_.find(key(at));
  return found == cells_.end() ? nullptr : &found->second;
}

SurfaceOracle::SurfaceOracle(const Grid& grid, int extent, int fine) {
  const double voxel = grid.lattice().voxel;
  const int edge = 2 * extent + 1;
  std::vector<double> values(static_cast<std::size_t>(edge) * edge * edge);
  const auto at = [&](int x, int y, int z) -> double& {
    return values[(static_cast<std::size_t>(x + extent) * edge + y + extent) * edge + z + extent];
  };
  for (int x = -extent; x <= extent; ++x) {
    for (int y = -extent; y <= extent; ++y) {
      for (int z = -extent; z <= extent; ++z) at(x, y, z) = grid.value({x, y, z}) / voxel;
    }
  }
  for (int x = -extent; x < extent; ++x) {
    for (int y = -extent; y < extent; ++y) {
      for (int z = -extent; z < extent; ++z) {
        double c[8];
        int negative = 0;
        for (int n = 0; n < 8; ++n) {
          c[n] = at(x + (n >> 2), y + (n >> 1 & 1), z + (n & 1));
          negative += c[n] < 0 ? 1 : 0;
        }
        if (negative == 0 || negative == 8) continue;
        Cell& cell = cells_[key({x, y, z})];
        const glm::dvec3 slope(c[4] + c[5] + c[6] + c[7] - c[0] - c[1] - c[2] - c[3],
                               c[2] + c[3] + c[6] + c[7] - c[0] - c[1] - c[4] - c[5],
                               c[1] + c[3] + c[5] + c[7] - c[0] - c[2] - c[4] - c[6]);
        cell.normal = slope / std::max(glm::length(slope), 1e-9);
        for (int i = 0; i <= fine; ++i) {
          for (int j = 0; j <= fine; ++j) {
            for (int k = 0; k <= fine; ++k) {
              const glm::dvec3 t = glm::dvec3(i, j, k) / double(fine);
              const double a = trilinear(c, t);
              for (int axis = 0; axis < 3; ++axis) {
                glm::dvec3 u = t;
                u[axis] += 1.0 / fine;
                if (u[axis] > 1 + 1e-9) continue;
                const double b = trilinear(c, u);
                if ((a < 0) == (b < 0)) continue;
                cell.points.push_back(glm::dvec3(x, y, z) + glm::mix(t, u, a / (a - b)));
              }
            }
          }
        }
      }
    }
  }
}

SurfaceOracle::Nearest SurfaceOracle::nearest(const glm::dvec3& p, double reach) const {
  Nearest best;
  const glm::ivec3 lo(glm::floor(p - reach));
  const glm::ivec3 hi(glm::floor(p + reach));
  for (int x = lo.x; x <= hi.x; ++x) {
    for (int y = lo.y; y <= hi.y; ++y) {
      for (int z = lo.z; z <= hi.z; ++z) {
        const glm::dvec3 low(x, y, z);
        const glm::dvec3 beside = glm::clamp(p, low, low + 1.0);
        if (glm::length(p - beside) >= best.distance) continue;
        const Cell* c = cell({x, y, z});
        if (c == nullptr) continue;
        for (const glm::dvec3& q : c->points) {
          const double d = glm::length(p - q);
          if (d >= best.distance) continue;
          best.distance = d;
          best.point = q;
        }
      }
    }
  }
  if (best.distance > 1e200) return best;
  const glm::ivec3 middle(glm::floor(best.point));
  const Cell* own = cell(middle);
  for (int n = 0; n < 125; ++n) {
    const Cell* c = cell(middle + glm::ivec3(n / 25 - 2, n / 5 % 5 - 2, n % 5 - 2));
    if (c == nullptr) continue;
    if (own == nullptr) own = c;
    if (glm::dot(own->normal, c->normal) < 0.866) best.crease = true;
  }
  return best;
}

CarvedBalls::CarvedBalls(const std::vector<Ball>& balls) {
  constexpr double kApart = 0.5;
  constexpr double kPi = 3.14159265358979;
  const double golden = kPi * (3 - std::sqrt(5.0));
  const auto covers = [](const Ball& ball, const glm::dvec3& p) {
    return glm::length(p - ball.middle) < ball.radius;
  };
  for (std::size_t b = 0; b < balls.size(); ++b) {
    const Ball& ball = balls[b];
    const int count = int(4 * kPi * ball.radius * ball.radius / (kApart * kApart));
    for (int i = 0; i < count; ++i) {
      const double z = 1 - (2 * i + 1) / double(count);
      const double across = std::sqrt(1 - z * z);
      const glm::dvec3 p = ball.middle + ball.radius * glm::dvec3(across * std::cos(i * golden),
                                                                  across * std::sin(i * golden), z);
      // No later ball may cover the point, and its own must have changed what was there.
      const auto later = balls.begin() + long(b) + 1;
      if (std::any_of(later, balls.end(), [&](const Ball& o) { return covers(o, p); })) continue;
      const auto before = std::find_if(balls.rend() - long(b), balls.rend(),
                                       [&](const Ball& o) { return covers(o, p); });
      const bool was_inside = before != balls.rend() && before->added;
      if (was_inside == ball.added) continue;
      cells_[key_of(glm::ivec3(glm::floor(p / kCell)))].push_back({p, b});
    }
  }
}

bool CarvedBalls::crease(const glm::dvec3& p, double reach) const {
  const glm::ivec3 lo(glm::floor((p - reach) / kCell));
  const glm::ivec3 hi(glm::floor((p + reach) / kCell));
  const Point* first = nullptr;
  for (int x = lo.x; x <= hi.x; ++x) {
    for (int y = lo.y; y <= hi.y; ++y) {
      for (int z = lo.z; z <= hi.z; ++z) {
        const auto found = cells_.find(key_of({x, y, z}));
        if (found == cells_.end()) continue;
        for (const Point& point : found->second) {
          if (glm::length(point.at - p) > reach) continue;
          if (first == nullptr) first = &point;
          if (point.ball != first->ball) return true;
        }
      }
    }
  }
  return false;
}

}  // namespace sdfgrid::test
