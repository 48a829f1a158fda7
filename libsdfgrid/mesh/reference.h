// mesh/reference.h: the distance to a triangle soup, by other means than the converter's, to
// measure it with. All in double: nearest point by a bounding volume hierarchy, sign by the exact
// winding number from one ray and the soup's border.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sdfgrid/mesh/reference_tree.h"
#include "sdfgrid/mesh/soup.h"

namespace sdfgrid {

class ReferenceDistance {
 public:
  // Copies what it needs of the soup. Throws Error{input} if the soup has no triangles, an index
  // out of range or a coordinate that is not finite.
  explicit ReferenceDistance(const TriangleSoup& soup);

  // The nearest point of the surface, world units. `known` is any point of the surface: one near to
  // `world`, such as the answer for a neighbour, makes the search shorter and does not change it.
  [[nodiscard]] glm::dvec3 closest(const glm::dvec3& world) const;
  [[nodiscard]] glm::dvec3 closest(const glm::dvec3& world, const glm::dvec3& known) const;

  // Distance to the surface, world units, >= 0.
  [[nodiscard]] double distance(const glm::dvec3& world) const;

  // The same, negative where the winding number is above 1/2; 0 has no sign.
  [[nodiscard]] double signed_distance(const glm::dvec3& world) const;

  // How often the surface winds round a point off the surface: the solid angle that it fills there
  // over 4 pi, positive seen from its back. An integer if the surface is closed. Exact to rounding.
  //
  // The surface less the cone of its border towards infinity, against the ray's direction, is
  // closed and winds an integer number of times: the ray's crossings, for the cone is parallel to
  // the ray. What the cone itself contributes is a sum over the border's edges. (The formula of
  // Martens, Trettner and Bessmeltsev 2026, The Antipodal Method, arXiv 2605.01536.)
  [[nodiscard]] double winding_number(const glm::dvec3& world) const;

  // The same as the plain sum of the triangles' solid angles (van Oosterom and Strackee 1983): slow
  // and simple, to check the other with.
  [[nodiscard]] double winding_number_by_sum(const glm::dvec3& world) const;

  // Whether every edge is used as often in one direction as in the other: then the sign is a matter
  // of whole numbers, and there is no place where it is a matter of taste.
  [[nodiscard]] bool closed() const { return border_.empty(); }

 private:
  struct Edge {
    std::uint32_t from, to;  // into border_points_, in the direction in which the triangles run
  };

  [[nodiscard]] double cone_winding(const glm::dvec3& p, const glm::dvec3& apex) const;

  glm::dvec3 origin_;
  std::vector<Edge> border_;  // an edge once for each time that it is used too often
  std::vector<glm::dvec3> border_points_;
  reference::TriangleTree tree_;
};

}  // namespace sdfgrid
