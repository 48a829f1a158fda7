#include "sdfgrid/mesh/topology.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace sdfgrid {
namespace {

// 1 if triangle u has the edge a -> b, -1 if it has b -> a, 0 if neither.
int direction(const glm::uvec3& u, std::uint32_t a, std::uint32_t b) {
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t from = u[k];
    const std::uint32_t to = u[(k + 1) % 3];
    if (from == a && to == b) return 1;
    if (from == b && to == a) return -1;
  }
  return 0;
}

glm::dvec3 unit_normal(const TriangleSoup& soup, std::uint32_t t) {
  const glm::uvec3& v = soup.triangles[t];
  const glm::dvec3 a = soup.local(v.x);
  const glm::dvec3 n = glm::cross(soup.local(v.y) - a, soup.local(v.z) - a);
  const double length = glm::length(n);
  return length > 0 ? n / length : glm::dvec3(0.0);
}

int corner_of(const glm::uvec3& triangle, std::uint32_t v) {
  return triangle.x == v ? 0 : triangle.y == v ? 1 : 2;
}

double corner_angle(const TriangleSoup& soup, std::uint32_t t, std::uint32_t vertex) {
  const glm::uvec3& v = soup.triangles[t];
  const int k = corner_of(v, vertex);
  const glm::dvec3 e = soup.local(v[(k + 1) % 3]) - soup.local(v[k]);
  const glm::dvec3 f = soup.local(v[(k + 2) % 3]) - soup.local(v[k]);
  return std::atan2(glm::length(glm::cross(e, f)), glm::dot(e, f));
}

// Over the fan of triangles that edges connect to `start` around v: where two fans touch in one
// point, only one of them is the surface that is near.
glm::dvec3 vertex_normal(const TriangleSoup& soup, const Topology& topology, std::uint32_t start,
                         std::uint32_t v) {
  glm::dvec3 sum(0.0);
  std::uint32_t t = start;
  for (std::size_t guard = topology.around(v).size(); guard > 0; --guard) {
    sum += corner_angle(soup, t, v) * unit_normal(soup, t);
    t = topology.across(t, (corner_of(soup.triangles[t], v) + 2) % 3);
    if (t == start || t == Topology::kNone) break;
  }
  return sum;
}

}  // namespace

Topology::Topology(const TriangleSoup& soup)
    : first_(soup.points.size() + 1, 0),
      faces_(3 * soup.triangles.size()),
      triangles_(soup.triangles) {
  for (const glm::uvec3& t : soup.triangles) {
    for (int k = 0; k < 3; ++k) ++first_[t[k] + 1];
  }
  for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t t = 0; t < soup.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) faces_[next[soup.triangles[t][k]]++] = t;
  }
}

std::uint32_t Topology::across(std::uint32_t t, int k) const {
  const std::uint32_t a = triangles_[t][k];
  const std::uint32_t b = triangles_[t][(k + 1) % 3];
  std::uint32_t other = kNone;
  // At the end with fewer triangles: the other may be the hub of a large fan.
  for (const std::uint32_t u : around(a).size() <= around(b).size() ? around(a) : around(b)) {
    if (u == t) continue;
    const int d = direction(triangles_[u], a, b);
    if (d == 0) continue;
    if (d > 0 || other != kNone) return kNone;
    other = u;
  }
  return other;
}

bool behind_pseudonormal(const TriangleSoup& soup, const Topology& topology, std::uint32_t t,
                         const glm::dvec3& p) {
  const glm::uvec3& v = soup.triangles[t];
  const glm::dvec3 corner[3] = {soup.local(v.x), soup.local(v.y), soup.local(v.z)};
  const glm::dvec3 n = unit_normal(soup, t);
  bool face = true;
  double nearest = 1e300;
  int edge = 0;
  double along = 0;  // where the nearest point is on that edge, 0 to 1
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 e = corner[(k + 1) % 3] - corner[k];
    const glm::dvec3 d = p - corner[k];
    face = face && glm::dot(glm::cross(n, e), d) > 0;
    const double s = glm::clamp(glm::dot(d, e) / glm::dot(e, e), 0.0, 1.0);
    const glm::dvec3 offset = d - s * e;
    const double squared = glm::dot(offset, offset);
    if (squared < nearest) {
      nearest = squared;
      edge = k;
      along = s;
    }
  }
  if (face) return glm::dot(n, p - corner[0]) < 0;
  glm::dvec3 normal;
  if (along > 0 && along < 1) {
    const std::uint32_t other = topology.across(t, edge);
    normal = other == Topology::kNone ? n : n + unit_normal(soup, other);
  } else {
    normal = vertex_normal(soup, topology, t, v[along > 0 ? (edge + 1) % 3 : edge]);
  }
  return glm::dot(normal, p - corner[along >= 1 ? (edge + 1) % 3 : edge]) < 0;
}

}  // namespace sdfgrid
