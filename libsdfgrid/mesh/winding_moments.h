// mesh/winding_moments.h: what the winding number of a patch of triangles looks like from afar (not
// installed). The winding number is the potential of a dipole layer, so outside a ball around the
// patch it is a series of multipoles. We keep degrees one to three; Barill et al. (2018) reach the
// same order with Taylor terms, of which 15 combinations matter, as the field is harmonic.
#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/mesh/winding_kernel.h"

namespace sdfgrid::winding {

// Integrals over a patch, positions p taken relative to `center`, n the unit normal.
struct Moments {
  glm::dvec3 center{0.0};  // centroid by area
  double area = 0.0;
  double spread = 0.0;  // of |p|^2
  double radius = 0.0;  // no point of the patch is farther from the centre
  Box box;
  glm::dvec3 normal{0.0};  // of n
  glm::dmat3 first{0.0};   // of n_i p_j, as first[j][i]
  // of n_i p_j p_k, as second[jk][i] with jk = xx, yy, zz, xy, xz, yz
  std::array<glm::dvec3, 6> second{};
};

using Triangle = std::array<glm::dvec3, 3>;

// Of some triangles, about their centroid by area. Some triangle must have an area.
[[nodiscard]] Moments moments_of(std::span<const Triangle> triangles);

// Of the union of some patches, about its own centroid.
[[nodiscard]] Moments merged(std::span<const Moments> parts);

// The expansion's coefficients, in the order that the kernel evaluates them.
[[nodiscard]] std::array<double, kCoefficients> coefficients(const Moments& m);

// Bound on the error of the expansion, in winding numbers, at a distance greater than m.radius.
[[nodiscard]] double expansion_error(const Moments& m, double distance);

// What an expansion may be off by, in winding numbers.
struct Accuracy {
  double absolute;
  double relative;  // to the winding number of as large a patch that faces the point flat
};

// The distance from the centre beyond which the expansion keeps to both.
[[nodiscard]] double reach(const Moments& m, const Accuracy& accuracy);

}  // namespace sdfgrid::winding
