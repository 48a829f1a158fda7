#include "sdfgrid/voxelize/nearest_triangle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "sdfgrid/voxelize/node_bins.h"

namespace sdfgrid {
namespace {

constexpr std::size_t kLeaf = 4;  // triangles

double square_to(const float lo[3], const float hi[3], const glm::dvec3& at) {
  double square = 0;
  for (int a = 0; a < 3; ++a) {
    const double below = static_cast<double>(lo[a]) - at[a];
    const double above = at[a] - static_cast<double>(hi[a]);
    const double away = std::max({below, above, 0.0});
    square += away * away;
  }
  return square;
}

}  // namespace

struct NearestTriangle::Corners {
  std::array<glm::dvec3, 3> at;

  [[nodiscard]] double middle(int axis) const {
    return at[0][axis] + at[1][axis] + at[2][axis];  // three times it
  }
};

NearestTriangle::NearestTriangle(const TriangleSoup& soup, const Lattice& lattice) {
  std::vector<Corners> triangles(soup.triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    index_corners(soup, lattice, t, triangles[t].at.data());
  }
  nodes_.reserve(triangles.size());
  records_.reserve(triangles.size());
  root_ = build(triangles, 0, triangles.size());
  for (const Corners& corners : triangles) records_.push_back(make_record(corners.at.data()));
}

// Halves by the middles along the longest side.
NearestTriangle::Box NearestTriangle::build(std::vector<Corners>& triangles, std::size_t begin,
                                            std::size_t end) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  glm::dvec3 lo(1e300);
  glm::dvec3 hi(-1e300);
  for (std::size_t t = begin; t < end; ++t) {
    for (const glm::dvec3& corner : triangles[t].at) {
      lo = glm::min(lo, corner);
      hi = glm::max(hi, corner);
    }
  }
  Box box{};
  for (int a = 0; a < 3; ++a) {  // rounded outwards
    box.lo[a] = std::nextafter(static_cast<float>(lo[a]), -kInfinity);
    box.hi[a] = std::nextafter(static_cast<float>(hi[a]), kInfinity);
  }
  box.first = static_cast<std::uint32_t>(begin);
  box.count = static_cast<std::uint32_t>(end - begin);
  if (end - begin <= kLeaf) return box;
  const glm::dvec3 size = hi - lo;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto middle = static_cast<std::ptrdiff_t>(begin + (end - begin) / 2);
  std::nth_element(
      triangles.begin() + static_cast<std::ptrdiff_t>(begin), triangles.begin() + middle,
      triangles.begin() + static_cast<std::ptrdiff_t>(end),
      [axis](const Corners& a, const Corners& b) { return a.middle(axis) < b.middle(axis); });
  const std::size_t node = nodes_.size();
  nodes_.emplace_back();
  const Box below = build(triangles, begin, static_cast<std::size_t>(middle));
  const Box above = build(triangles, static_cast<std::size_t>(middle), end);
  nodes_[node] = {{below, above}};
  box.first = static_cast<std::uint32_t>(node);
  box.count = 0;
  return box;
}

double NearestTriangle::distance(const glm::dvec3& at, std::uint32_t& known) const {
  const double p[3] = {at.x, at.y, at.z};
  double best = brick_kernel().squared_distance(records_[known], p);
  visit(root_, at, best, known);
  return std::sqrt(best);
}

void NearestTriangle::collect(const glm::dvec3& at, double reach,
                              std::vector<std::uint32_t>& triangles) const {
  collect(root_, at, reach * reach, triangles);
}

void NearestTriangle::collect(const Box& box, const glm::dvec3& at, double square,
                              std::vector<std::uint32_t>& triangles) const {
  if (square_to(box.lo, box.hi, at) > square) return;
  for (std::uint32_t t = box.first; t < box.first + box.count; ++t) triangles.push_back(t);
  if (box.count > 0) return;
  for (const Box& side : nodes_[box.first].sides) collect(side, at, square, triangles);
}

void NearestTriangle::visit(const Box& box, const glm::dvec3& at, double& best,
                            std::uint32_t& known) const {
  if (box.count > 0) {
    const double p[3] = {at.x, at.y, at.z};
    for (std::uint32_t t = box.first; t < box.first + box.count; ++t) {
      const double square = brick_kernel().squared_distance(records_[t], p);
      if (square >= best) continue;
      best = square;
      known = t;
    }
    return;
  }
  const Node& node = nodes_[box.first];
  const double square[2] = {square_to(node.sides[0].lo, node.sides[0].hi, at),
                            square_to(node.sides[1].lo, node.sides[1].hi, at)};
  const int nearer = square[1] < square[0] ? 1 : 0;
  if (square[nearer] < best) visit(node.sides[nearer], at, best, known);
  if (square[1 - nearer] < best) visit(node.sides[1 - nearer], at, best, known);
}

}  // namespace sdfgrid
