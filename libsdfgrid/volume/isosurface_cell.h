// volume/isosurface_cell.h: the surface within one cell of eight samples. Internal to
// volume/isosurface.h.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <utility>

namespace sdfgrid::cell {

inline constexpr int kCorners = 8;  // corner c is at (c & 1, c >> 1 & 1, c >> 2 & 1)
inline constexpr int kEdges = 12;

// An edge runs from a corner along an axis: number 4 * axis + place.
inline constexpr std::array<std::pair<int, int>, kEdges> kEdgeStart = {{{0, 0},
                                                                        {2, 0},
                                                                        {4, 0},
                                                                        {6, 0},
                                                                        {0, 1},
                                                                        {1, 1},
                                                                        {4, 1},
                                                                        {5, 1},
                                                                        {0, 2},
                                                                        {1, 2},
                                                                        {2, 2},
                                                                        {3, 2}}};

// The edge between two corners that differ in one bit.
constexpr int edge_between(int a, int b) {
  const int axis = (a ^ b) >> 1;  // 1, 2, 4 -> 0, 1, 2
  const int from = a & b;
  for (int edge = 4 * axis; edge < 4 * axis + 4; ++edge) {
    if (kEdgeStart[edge].first == from) return edge;
  }
  return -1;
}

// Corners of each face, counter-clockwise seen from outside the cell.
inline constexpr std::array<std::array<int, 4>, 6> kFaces = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

struct Loop {
  int size = 0;
  std::array<int, kEdges> edges{};  // counter-clockwise seen from the outside of the surface
};

using Values = std::array<float, kCorners>;

// For each crossed edge the one that follows it in its loop.
using Next = std::array<int, kEdges>;

// Adds the segments in which the surface cuts a face. Going round the face, crossings that leave
// the inside alternate with such that enter it, and a segment runs from one that enters to one that
// leaves. Where the corners alternate too there are two ways to pair them, and the value at the
// saddle of the bilinear interpolant decides.
inline void join_face(const Values& values, unsigned inside, const std::array<int, 4>& face,
                      Next& next) {
  const auto is_inside = [&](int k) { return (inside >> face[k & 3] & 1U) != 0; };
  const auto edge = [&](int k) { return edge_between(face[k & 3], face[(k + 1) & 3]); };
  const bool ambiguous =
      is_inside(0) == is_inside(2) && is_inside(1) == is_inside(3) && is_inside(0) != is_inside(1);
  if (ambiguous) {
    const int in = is_inside(0) ? 0 : 1;
    const auto value = [&](int k) { return double(values[face[k & 3]]); };
    const bool joined = value(in) * value(in + 2) >= value(in + 1) * value(in + 3);
    next[edge(joined ? in + 1 : in + 3)] = edge(in);
    next[edge(joined ? in + 3 : in + 1)] = edge(in + 2);
    return;
  }
  int leaves = -1, enters = -1;
  for (int k = 0; k < 4; ++k) {
    if (is_inside(k) == is_inside(k + 1)) continue;
    (is_inside(k) ? leaves : enters) = edge(k);
  }
  if (enters >= 0) next[enters] = leaves;
}

// Calls take(loop) for each loop of the cell whose corners are inside as the bits say.
template <class Take>
void for_loops(const Values& values, unsigned inside, const Take& take) {
  Next next;
  next.fill(-1);
  for (const auto& face : kFaces) join_face(values, inside, face, next);
  for (int start = 0; start < kEdges; ++start) {
    if (next[start] < 0) continue;
    Loop loop;
    for (int edge = start; next[edge] >= 0;) {
      loop.edges[loop.size++] = edge;
      edge = std::exchange(next[edge], -1);
    }
    take(loop);
  }
}

// The point of the trilinear interpolant's zero that Newton's method finds from `p`, within the
// cell; `p` itself if it does not get there.
[[nodiscard]] glm::dvec3 pull_to_surface(const Values& values, const glm::dvec3& p);

}  // namespace sdfgrid::cell
