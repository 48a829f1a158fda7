#include "sdfgrid/mesh/winding_boundary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <tuple>

namespace sdfgrid::winding {
namespace {

constexpr std::uint32_t kLeafEdges = 4;

// An edge between point indices lo < hi, passed `times` more often upwards than downwards.
struct IndexEdge {
  std::uint32_t lo, hi;
  std::int32_t times;
};

void add_edge(std::vector<IndexEdge>& edges, std::uint32_t from, std::uint32_t to,
              std::int32_t times) {
  if (from < to) edges.push_back({from, to, times});
  if (to < from) edges.push_back({to, from, -times});
}

// Adds up equal edges and drops those that cancel. Buckets by the lower index, because sorting all
// edges at once takes several times as long.
std::vector<IndexEdge> net_edges(const std::vector<IndexEdge>& edges, std::size_t points) {
  std::vector<std::uint32_t> start(points + 1, 0);
  for (const IndexEdge& e : edges) ++start[e.lo + 1];
  for (std::size_t i = 0; i < points; ++i) start[i + 1] += start[i];
  std::vector<IndexEdge> bucketed(edges.size());
  std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
  for (const IndexEdge& e : edges) bucketed[next[e.lo]++] = e;

  std::vector<IndexEdge> net;
  for (std::size_t i = 0; i < points; ++i) {
    const auto begin = bucketed.begin() + start[i];
    const auto end = bucketed.begin() + start[i + 1];
    std::sort(begin, end, [](const IndexEdge& a, const IndexEdge& b) { return a.hi < b.hi; });
    for (auto e = begin; e != end;) {
      IndexEdge sum = *e;
      for (++e; e != end && e->hi == sum.hi; ++e) sum.times += e->times;
      if (sum.times != 0) net.push_back(sum);
    }
  }
  return net;
}

// Renames both ends of each edge to the first of the edges' points at the same position.
std::vector<IndexEdge> welded(const std::vector<IndexEdge>& edges,
                              const std::vector<glm::vec3>& points) {
  std::vector<std::uint32_t> used;
  for (const IndexEdge& e : edges) used.insert(used.end(), {e.lo, e.hi});
  const auto place = [&](std::uint32_t i) {
    return std::tuple(points[i].x, points[i].y, points[i].z);
  };
  std::sort(used.begin(), used.end(), [&](std::uint32_t i, std::uint32_t j) {
    return std::tuple(place(i), i) < std::tuple(place(j), j);
  });
  std::vector<std::uint32_t> name(points.size());
  for (std::size_t i = 0; i < used.size(); ++i) {
    const bool again = i > 0 && place(used[i]) == place(used[i - 1]);
    name[used[i]] = again ? name[used[i - 1]] : used[i];
  }
  std::vector<IndexEdge> renamed;
  for (const IndexEdge& e : edges) add_edge(renamed, name[e.lo], name[e.hi], e.times);
  return renamed;
}

double distance_to_box(const Box& box, const glm::dvec3& p) {
  return glm::length(glm::max(glm::max(box.lo - p, p - box.hi), glm::dvec3(0.0)));
}

// At least the integral of 1 / distance^2 along a to b, for every point of the ball.
double edge_integral(const BoundaryEdge& edge, const glm::dvec3& center, double radius) {
  const glm::dvec3 along = edge.b - edge.a;
  const double length = glm::length(along);
  if (length == 0.0) return 0.0;
  const glm::dvec3 to_a = edge.a - center;
  const double from =
      glm::dot(to_a, along) / length;  // positions on the line, 0 nearest the centre
  const double to = from + length;
  const double line = glm::length(to_a - along * (from / length));
  const double distance = std::hypot(line, std::clamp(0.0, from, to));
  if (distance <= radius) return std::numeric_limits<double>::infinity();
  double integral = length / (distance * distance);
  // The closed form pays for long edges, and loses its digits close to the line's own direction.
  if (length > 0.25 * distance && line > 1e-6 * distance) {
    integral = std::min(integral, (std::atan(to / line) - std::atan(from / line)) / line);
  }
  // Every distance to the ball is at least (1 - radius / distance) of that to its centre.
  const double shrink = 1.0 - radius / distance;
  return integral / (shrink * shrink);
}

}  // namespace

std::vector<BoundaryEdge> boundary_edges(const TriangleSoup& soup) {
  std::vector<IndexEdge> edges;
  edges.reserve(3 * soup.triangles.size());
  for (const glm::uvec3& t : soup.triangles) {
    add_edge(edges, t.x, t.y, 1);
    add_edge(edges, t.y, t.z, 1);
    add_edge(edges, t.z, t.x, 1);
  }
  edges = net_edges(edges, soup.points.size());
  // Equal points with different indices are rare: it pays to look for them among the rest only.
  if (!edges.empty()) edges = net_edges(welded(edges, soup.points), soup.points.size());
  std::vector<BoundaryEdge> boundary;
  boundary.reserve(edges.size());
  for (const IndexEdge& e : edges) {
    const bool up = e.times > 0;
    boundary.push_back({soup.local(up ? e.lo : e.hi), soup.local(up ? e.hi : e.lo),
                        std::abs(static_cast<double>(e.times))});
  }
  return boundary;
}

Boundary::Boundary(std::vector<BoundaryEdge> edges) : edges_(std::move(edges)) {
  if (!edges_.empty()) build(0, static_cast<std::uint32_t>(edges_.size()));
}

std::uint32_t Boundary::build(std::uint32_t begin, std::uint32_t end) {
  Node node;
  Box middles;
  for (std::uint32_t i = begin; i < end; ++i) {
    node.box.add(edges_[i].a);
    node.box.add(edges_[i].b);
    middles.add(0.5 * (edges_[i].a + edges_[i].b));
  }
  const glm::dvec3 center = node.box.center();
  for (std::uint32_t i = begin; i < end; ++i) {
    const BoundaryEdge& e = edges_[i];
    const double length = e.times * glm::distance(e.a, e.b);
    node.length += length;
    node.current += e.times * (e.b - e.a);
    // The distance from a point is convex along an edge, so its mean is at most that of the ends.
    node.spread += 0.5 * length * (glm::distance(e.a, center) + glm::distance(e.b, center));
  }
  node.begin = begin;
  node.end = end;
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back(node);
  if (end - begin <= kLeafEdges) return index;

  const glm::dvec3 size = middles.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(edges_.begin() + begin, edges_.begin() + middle, edges_.begin() + end,
                   [axis](const BoundaryEdge& e, const BoundaryEdge& f) {
                     return e.a[axis] + e.b[axis] < f.a[axis] + f.b[axis];
                   });
  build(begin, middle);
  const std::uint32_t right = build(middle, end);
  nodes_[index].right = right;
  return index;
}

// A node far away is bounded in two ways, and the less of both taken: all its length at the box's
// distance D; or its net current at D plus what the kernel x / |x|^3 changes between the box's
// centre and an edge, at most 2 / D^3 times their distance.
double Boundary::gradient_bound(const glm::dvec3& center, double radius, double opening,
                                double limit) const {
  const double enough = 4.0 * std::numbers::pi * limit;
  double sum = 0.0;
  std::array<std::uint32_t, 64> stack;
  std::size_t waiting = 0;
  if (!nodes_.empty()) stack[waiting++] = 0;
  while (waiting > 0) {
    const std::uint32_t index = stack[--waiting];
    const Node& node = nodes_[index];
    const double distance = distance_to_box(node.box, center) - radius;
    if (distance > 0.0 && glm::length(node.box.size()) < opening * distance) {
      const double d2 = distance * distance;
      const double with_current = glm::length(node.current) + 2.0 * node.spread / distance;
      sum += std::min(node.length, with_current) / d2;
    } else if (node.right != 0) {
      const double left = distance_to_box(nodes_[index + 1].box, center);
      const double right = distance_to_box(nodes_[node.right].box, center);
      stack[waiting++] = left < right ? node.right : index + 1;
      stack[waiting++] = left < right ? index + 1 : node.right;  // the nearer on top
    } else {
      for (std::uint32_t i = node.begin; i < node.end; ++i) {
        sum += edges_[i].times * edge_integral(edges_[i], center, radius);
      }
    }
    if (sum > enough) return std::numeric_limits<double>::infinity();
  }
  return 0.25 * std::numbers::inv_pi * sum;
}

}  // namespace sdfgrid::winding
