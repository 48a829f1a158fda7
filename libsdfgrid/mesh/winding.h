// mesh/winding.h: how often a triangle soup winds around a point, for soups that have holes,
// overlaps or flipped parts and so no inside in the strict sense. The sign of a distance is then
// "inside where the winding number is above one half".
//
// The generalized winding number is the solid angle that the triangles cover, seen from the point
// and counted negative where their back is seen, over 4 pi. It is 1 inside and 0 outside of a
// closed mesh, varies smoothly near holes and jumps by 1 across every triangle. Evaluation is
// hierarchical after Barill, Dickson, Schmidt, Levin and Jacobson, "Fast winding numbers for soups
// and clouds" (2018); docs/methods.md says where ours differs.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <span>

#include "sdfgrid/core/job.h"
#include "sdfgrid/mesh/soup.h"

namespace sdfgrid {

class WindingNumber {
 public:
  // Builds the tree, on all threads; it holds about 45 bytes a triangle. Indices must be in range
  // and points finite. Throws Error{cancelled} if `job` is. The soup need not outlive the call.
  explicit WindingNumber(const TriangleSoup& soup, const Job& job = Job());
  ~WindingNumber();
  WindingNumber(WindingNumber&&) noexcept;
  WindingNumber& operator=(WindingNumber&&) noexcept;

  // The winding number at a position relative to soup.origin, within tolerance() of the exact one,
  // except closer to a triangle than float rounding of the position. On a triangle it is any value
  // between those of its two sides. Zero where `local` is not finite. The same bits in any batch
  // and on any thread.
  [[nodiscard]] double at(const glm::dvec3& local) const;
  // The same for many positions, faster where neighbours in space are neighbours in the list.
  // Throws std::invalid_argument unless out.size() equals locals.size().
  void at(std::span<const glm::dvec3> locals, std::span<double> out) const;

  // The same at the 8^3 points corner + step * (x, y, z), z fastest (out[64 x + 8 y + z]), several
  // times as fast as one by one: what is far from the cube is evaluated at 4^3 points and
  // interpolated. Differs from at() by rather less than tolerance().
  static constexpr std::size_t kCubePoints = 512;
  void at_cube(const glm::dvec3& corner, double step, std::span<double, kCubePoints> out) const;

  // What at() and at_cube() may be off by, in winding numbers. Each expansion's error has a proven
  // bound; that they sum to less than this is measured (0.0015 at worst on single surfaces, 0.0035
  // where eight concentric ones add up), not proven.
  [[nodiscard]] static constexpr double tolerance() { return 0.005; }

  // Upper bound on the length of the exact winding number's gradient, per unit of local length,
  // over the ball, apart from the jumps across triangles. +inf when a boundary edge enters the
  // ball; 0 everywhere if closed(): then the winding number is constant wherever no triangle is
  // crossed.
  [[nodiscard]] double gradient_bound(const glm::dvec3& center, double radius) const;

  // Whether that gradient is shown to be at most `limit`: the same question, but no more of the
  // boundary is looked at than the answer needs, so ask this where the boundary has many edges.
  [[nodiscard]] bool gradient_below(const glm::dvec3& center, double radius, double limit) const;

  // Whether every edge is passed as often one way as the other, so that there is no boundary.
  [[nodiscard]] bool closed() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace sdfgrid
