// The reference that everything else is measured with, measured against CGAL: its AABB tree for
// distances, its side_of_triangle_mesh (exact predicates) for signs.
#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "property/random_meshes.h"
#include "sdfgrid/mesh/reference.h"

namespace sdfgrid {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Primitive = CGAL::AABB_face_graph_triangle_primitive<Mesh>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

// Relative to soup.origin, where both see the same doubles.
Mesh to_cgal(const TriangleSoup& soup) {
  Mesh mesh;
  std::vector<Mesh::Vertex_index> vertices;
  for (std::uint32_t i = 0; i < soup.points.size(); ++i) {
    const glm::dvec3 p = soup.local(i);
    vertices.push_back(mesh.add_vertex(Point(p.x, p.y, p.z)));
  }
  for (const glm::uvec3& t : soup.triangles) {
    EXPECT_NE(mesh.add_face(vertices[t.x], vertices[t.y], vertices[t.z]), Mesh::null_face());
  }
  return mesh;
}

// Points in and around the mesh, half of them near its surface.
std::vector<glm::dvec3> probes(const TriangleSoup& soup, shapes::Random& random, int count) {
  const Box box = bounds(soup);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 spread = random.in_box(glm::dvec3(-0.75), glm::dvec3(0.75));
    if (i % 2 == 0) {
      points.push_back(box.center() - soup.origin + spread * box.size());
    } else {
      const int last = static_cast<int>(soup.triangles.size()) - 1;
      const glm::uvec3 t = soup.triangles[static_cast<std::size_t>(random.integer(0, last))];
      points.push_back((soup.local(t.x) + soup.local(t.y) + soup.local(t.z)) / 3.0 +
                       0.02 * spread * box.size());
    }
  }
  return points;
}

TEST(Cgal, AgreesWithTheReferenceOnDistanceAndSign) {
  shapes::Random random(11);
  std::size_t inside = 0;
  std::size_t all = 0;
  for (const auto& [name, soup] : shapes::random_closed_meshes(31, 12)) {
    const Mesh mesh = to_cgal(soup);
    Tree tree(faces(mesh).begin(), faces(mesh).end(), mesh);
    const CGAL::Side_of_triangle_mesh<Mesh, Kernel> side(mesh);
    const ReferenceDistance reference(soup);
    const glm::dvec3 size = bounds(soup).size();
    const double scale = std::max({size.x, size.y, size.z});
    // What a world position loses where the mesh is far from zero.
    const double lost = 1e-15 * glm::length(soup.origin) + 1e-13 * scale;
    for (const glm::dvec3& p : probes(soup, random, 400)) {
      const Point q(p.x, p.y, p.z);
      const double expected = std::sqrt(tree.squared_distance(q));
      const double signed_distance = reference.signed_distance(soup.origin + p);
      ASSERT_NEAR(std::abs(signed_distance), expected, lost) << name;
      if (expected < 10 * lost) continue;
      const bool cgal_inside = side(q) == CGAL::ON_BOUNDED_SIDE;
      ASSERT_EQ(signed_distance < 0, cgal_inside) << name;
      inside += cgal_inside ? 1 : 0;
      ++all;
    }
  }
  EXPECT_GT(inside, all / 10);
  EXPECT_LT(inside, all);
}

}  // namespace
}  // namespace sdfgrid
