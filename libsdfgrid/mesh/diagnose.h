// mesh/diagnose.h: what is to be known of a mesh before it is used: its size, whether it closes a
// volume, and what is wrong with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sdfgrid/mesh/soup.h"

namespace sdfgrid {

// Points are taken as one where they share an index. Triangles with two corners in one point have
// no edges: they count as zero-area faces only.
struct MeshDiagnosis {
  std::size_t triangles = 0;
  std::size_t points = 0;      // that triangles use
  std::size_t components = 0;  // sets of triangles that edges connect
  std::size_t edges = 0;
  std::size_t boundary_edges = 0;     // of one triangle
  std::size_t nonmanifold_edges = 0;  // of more than two
  std::size_t flipped_neighbours =
      0;  // edges whose two triangles run along them in the same direction
  std::size_t zero_area_faces = 0;  // within rounding of double
  std::size_t duplicate_faces = 0;  // each with the three points of an earlier one, in any order
  Box bounds;                       // world units
  double area = 0.0;                // world units squared
  double volume = 0.0;  // signed, positive if triangles face outward; of no meaning unless closed()
  std::vector<std::uint32_t> component;  // of each triangle, numbered as they first appear

  // Every edge belongs to exactly two triangles.
  [[nodiscard]] bool closed() const {
    return edges > 0 && boundary_edges == 0 && nonmanifold_edges == 0;
  }
  [[nodiscard]] bool consistently_oriented() const { return flipped_neighbours == 0; }
};

// O(triangles), but for points that very many triangles share.
[[nodiscard]] MeshDiagnosis diagnose(const TriangleSoup& soup);

}  // namespace sdfgrid
