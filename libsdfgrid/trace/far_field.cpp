#include "sdfgrid/trace/far_field.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "sdfgrid/core/parallel.h"

namespace sdfgrid {
namespace {

constexpr int kBlock = 4;  // cells a side for which one surface point is kept

// Of one sample of a brick, by central differences where the brick has both neighbours.
glm::vec3 gradient(const float* samples, const glm::ivec3& at) {
  constexpr int strides[3] = {Atlas::kEdge * Atlas::kEdge, Atlas::kEdge, 1};
  const int here = at.x * strides[0] + at.y * strides[1] + at.z * strides[2];
  glm::vec3 g;
  for (int a = 0; a < 3; ++a) {
    const int before = at[a] > 0 ? 1 : 0;
    const int after = at[a] < Atlas::kBrick ? 1 : 0;
    const float change = samples[here + after * strides[a]] - samples[here - before * strides[a]];
    g[a] = change / static_cast<float>(before + after);
  }
  return g;
}

// A point of the surface within the block at `corner`, if it has both signs: its sample nearest to
// the surface, moved along the gradient.
bool point_of_block(const float* samples, const glm::ivec3& corner, glm::vec3& point) {
  glm::ivec3 best = corner;
  float nearest = std::numeric_limits<float>::max();
  bool inside = false;
  bool outside = false;
  for (int x = corner.x; x <= corner.x + kBlock; ++x) {
    for (int y = corner.y; y <= corner.y + kBlock; ++y) {
      const float* row = samples + (x * Atlas::kEdge + y) * Atlas::kEdge;
      for (int z = corner.z; z <= corner.z + kBlock; ++z) {
        (row[z] < 0 ? inside : outside) = true;
        if (std::abs(row[z]) < nearest) {
          nearest = std::abs(row[z]);
          best = {x, y, z};
        }
      }
    }
  }
  if (!inside || !outside) return false;
  const float value = samples[(best.x * Atlas::kEdge + best.y) * Atlas::kEdge + best.z];
  const glm::vec3 g = gradient(samples, best);
  const glm::vec3 move = -value / std::max(glm::dot(g, g), 0.25F) * g;
  point = glm::vec3(best) + glm::clamp(move, -1.0F, 1.0F);
  return true;
}

void points_of_brick(const float* samples, const glm::vec3& corner, std::vector<glm::vec3>& out) {
  glm::vec3 point;
  for (int x = 0; x < Atlas::kBrick; x += kBlock) {
    for (int y = 0; y < Atlas::kBrick; y += kBlock) {
      for (int z = 0; z < Atlas::kBrick; z += kBlock) {
        if (point_of_block(samples, {x, y, z}, point)) out.push_back(corner + point);
      }
    }
  }
}

// The box of the zeros on the edges of cells in a block of `edge` cells a side. It holds the zeros
// within the cells, too: a plane across a cell holds some only if the edges that it cuts have both
// signs there, as bilinear values lie between those at the corners; so the extreme planes go
// through zeros of edges.
bool box_of_block(const float* samples, const glm::ivec3& corner, int edge, glm::vec3& lo,
                  glm::vec3& hi) {
  constexpr int strides[3] = {Atlas::kEdge * Atlas::kEdge, Atlas::kEdge, 1};
  lo = glm::vec3(std::numeric_limits<float>::max());
  hi = -lo;
  for (int n = 0; n < (edge + 1) * (edge + 1) * (edge + 1); ++n) {
    const glm::ivec3 step(n / ((edge + 1) * (edge + 1)), n / (edge + 1) % (edge + 1),
                          n % (edge + 1));
    const glm::ivec3 at = corner + step;
    const int here = at.x * strides[0] + at.y * strides[1] + at.z;
    for (int a = 0; a < 3; ++a) {
      if (step[a] == edge) continue;
      const float from = samples[here];
      const float to = samples[here + strides[a]];
      if ((from < 0) == (to < 0)) continue;
      glm::vec3 zero(at);
      zero[a] += from / (from - to);
      lo = glm::min(lo, zero);
      hi = glm::max(hi, zero);
    }
  }
  return lo.x <= hi.x;
}

void corners_of_brick(const float* samples, const glm::vec3& base, int edge,
                      std::vector<glm::vec3>& out) {
  glm::vec3 lo;
  glm::vec3 hi;
  for (int x = 0; x < Atlas::kBrick; x += edge) {
    for (int y = 0; y < Atlas::kBrick; y += edge) {
      for (int z = 0; z < Atlas::kBrick; z += edge) {
        if (!box_of_block(samples, {x, y, z}, edge, lo, hi)) continue;
        for (int n = 0; n < 8; ++n) {
          const glm::bvec3 upper(n & 4, n & 2, n & 1);
          out.push_back(base + glm::mix(lo, hi, upper));
        }
      }
    }
  }
}

// What `add` makes of each crossing brick (its samples and first one's place), in the bricks'
// order.
template <class Add>
std::vector<glm::vec3> gather(const Atlas& atlas, const Job& job, const Add& add) {
  std::vector<std::vector<glm::vec3>> planes(static_cast<std::size_t>(atlas.dims.x));
  parallel_for("light", planes.size(), 1, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t x = begin; x < end; ++x) {
      for (int y = 0; y < atlas.dims.y; ++y) {
        for (int z = 0; z < atlas.dims.z; ++z) {
          const glm::ivec3 slot(static_cast<int>(x), y, z);
          const std::int32_t brick = atlas.crossing_brick(slot);
          if (brick < 0) continue;
          const float* samples =
              atlas.samples.data() + static_cast<std::size_t>(brick) * Atlas::kSamples;
          add(samples, glm::vec3(Atlas::kBrick * slot), planes[x]);
        }
      }
    }
  });
  std::vector<glm::vec3> points;
  for (const auto& plane : planes) points.insert(points.end(), plane.begin(), plane.end());
  return points;
}

// Nearest points on the nodes of a far field, spread from node to node.
class Spreader {
 public:
  explicit Spreader(const FarField& field)
      : field_(field), nearest_(field.values.size(), {glm::vec3(0), kNone}) {}

  // Offers the point to the eight nodes around it.
  void seed(const glm::vec3& point) {
    const glm::ivec3 cell((point - field_.origin) / field_.spacing);
    for (int n = 0; n < 8; ++n) {
      const glm::ivec3 node = cell + glm::ivec3(n >> 2, (n >> 1) & 1, n & 1);
      offer(place(node), position(node), point);
    }
  }

  // One pass over all nodes in rising (direction 1) or falling (-1) order, each taking what is best
  // among the 13 neighbours that come before it.
  void sweep(int direction, const Job& job) {
    const glm::ivec3 last = field_.dims - 1;
    for (int i = 0; i <= last.x; ++i) {
      job.checkpoint();
      for (int j = 0; j <= last.y; ++j) {
        for (int k = 0; k <= last.z; ++k) {
          const glm::ivec3 node(i, j, k);
          take_from_earlier(direction > 0 ? node : last - node, direction);
        }
      }
    }
  }

  [[nodiscard]] float distance(std::size_t node) const { return std::sqrt(nearest_[node].squared); }

 private:
  static constexpr float kNone = 1e30F;
  struct Nearest {
    glm::vec3 point;
    float squared;
  };

  [[nodiscard]] std::size_t place(const glm::ivec3& n) const {
    return (static_cast<std::size_t>(n.x) * field_.dims.y + n.y) * field_.dims.z + n.z;
  }
  [[nodiscard]] glm::vec3 position(const glm::ivec3& n) const {
    return field_.origin + field_.spacing * glm::vec3(n);
  }
  void offer(std::size_t node, const glm::vec3& at, const glm::vec3& point) {
    const glm::vec3 d = point - at;
    const float squared = glm::dot(d, d);
    if (squared < nearest_[node].squared) nearest_[node] = {point, squared};
  }
  void take_from_earlier(const glm::ivec3& node, int direction) {
    const glm::vec3 at = position(node);
    const std::size_t here = place(node);
    for (int n = 0; n < 13; ++n) {  // the neighbours before (0, 0, 0) in lexicographic order
      const glm::ivec3 other = node + direction * glm::ivec3(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
      const bool exists = other.x >= 0 && other.y >= 0 && other.z >= 0 && other.x < field_.dims.x &&
                          other.y < field_.dims.y && other.z < field_.dims.z;
      if (!exists) continue;
      const Nearest& offered = nearest_[place(other)];
      if (offered.squared < kNone) offer(here, at, offered.point);
    }
  }

  const FarField& field_;
  std::vector<Nearest> nearest_;
};

FarField layout(const std::vector<glm::vec3>& points, int nodes) {
  glm::vec3 lo = points.front();
  glm::vec3 hi = lo;
  for (const glm::vec3& p : points) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  const glm::vec3 size = hi - lo;
  const float longest = std::max({size.x, size.y, size.z, 1.0F});
  const float margin = 0.25F * longest;
  FarField field;
  field.spacing = std::max(1.0F, (longest + 2 * margin) / static_cast<float>(nodes - 2));
  field.origin = lo - margin;
  field.dims = glm::ivec3(glm::ceil((size + 2 * margin) / field.spacing)) + 2;
  field.values.resize(static_cast<std::size_t>(field.dims.x) * field.dims.y * field.dims.z);
  return field;
}

}  // namespace

std::vector<glm::vec3> surface_points(const Atlas& atlas, const Job& job) {
  return gather(atlas, job, points_of_brick);
}

std::vector<glm::vec3> surface_corners(const Atlas& atlas, const Job& job) {
  const int longest = Atlas::kBrick * std::max({atlas.dims.x, atlas.dims.y, atlas.dims.z});
  int edge = 1;
  while (edge < Atlas::kBrick && 96 * edge < longest) edge *= 2;
  return gather(atlas, job,
                [edge](const float* samples, const glm::vec3& base, std::vector<glm::vec3>& out) {
                  corners_of_brick(samples, base, edge, out);
                });
}

FarField make_far_field(const Atlas& atlas, const std::vector<glm::vec3>& points, int nodes,
                        const Job& job) {
  if (points.empty()) return {};
  FarField field = layout(points, nodes);
  Spreader spreader(field);
  for (const glm::vec3& point : points) spreader.seed(point);
  spreader.sweep(1, job);
  spreader.sweep(-1, job);
  std::size_t node = 0;
  for (int x = 0; x < field.dims.x; ++x) {
    for (int y = 0; y < field.dims.y; ++y) {
      for (int z = 0; z < field.dims.z; ++z, ++node) {
        const glm::vec3 at = field.origin + field.spacing * glm::vec3(x, y, z);
        const glm::ivec3 index = Atlas::kBrick * atlas.lo + glm::ivec3(glm::round(at));
        const float distance = spreader.distance(node);
        field.values[node] = atlas.value(index) < 0 ? -distance : distance;
      }
    }
  }
  return field;
}

}  // namespace sdfgrid
