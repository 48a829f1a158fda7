#include "sdfgrid/mesh/diagnose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "property/random_meshes.h"

namespace sdfgrid {
namespace {

using shapes::box_mesh;

TriangleSoup cube() { return box_mesh({0, 0, 0}, {1, 1, 1}); }

TEST(Diagnose, Cube) {
  const MeshDiagnosis d = diagnose(cube());
  EXPECT_EQ(d.triangles, 12U);
  EXPECT_EQ(d.points, 8U);
  EXPECT_EQ(d.edges, 18U);
  EXPECT_EQ(d.components, 1U);
  EXPECT_TRUE(d.closed());
  EXPECT_TRUE(d.consistently_oriented());
  EXPECT_EQ(d.zero_area_faces, 0U);
  EXPECT_EQ(d.duplicate_faces, 0U);
  EXPECT_DOUBLE_EQ(d.area, 6.0);
  EXPECT_DOUBLE_EQ(d.volume, 1.0);
  EXPECT_EQ(d.bounds.lo, glm::dvec3(0.0));
  EXPECT_EQ(d.bounds.hi, glm::dvec3(1.0));
}

TEST(Diagnose, InsideOutCubeFarFromZero) {
  TriangleSoup soup = shapes::flipped(cube());
  soup.origin = {612345.0, 4123456.0, 0.0};
  const MeshDiagnosis d = diagnose(soup);
  EXPECT_TRUE(d.closed());
  EXPECT_TRUE(d.consistently_oriented());
  EXPECT_DOUBLE_EQ(d.volume, -1.0);
  EXPECT_EQ(d.bounds.lo, soup.origin);
}

TEST(Diagnose, SphereHasItsAreaAndVolume) {
  const MeshDiagnosis d = diagnose(shapes::icosphere(5, 2.0));
  EXPECT_NEAR(d.area, 16.0 * std::numbers::pi, 0.1);
  EXPECT_NEAR(d.volume, 32.0 / 3.0 * std::numbers::pi, 0.1);
}

TEST(Diagnose, OpenBox) {
  TriangleSoup soup = cube();
  soup.triangles.resize(10);
  const MeshDiagnosis d = diagnose(soup);
  EXPECT_EQ(d.boundary_edges, 4U);
  EXPECT_FALSE(d.closed());
  EXPECT_TRUE(d.consistently_oriented());
}

TEST(Diagnose, MoebiusStripHasOneFlippedEdge) {
  TriangleSoup soup;
  const int n = 12;
  for (int i = 0; i < n; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / n;
    for (const double side : {-0.3, 0.3}) {
      const double r = 1.0 + side * std::cos(0.5 * angle);
      soup.points.emplace_back(r * std::cos(angle), r * std::sin(angle),
                               side * std::sin(0.5 * angle));
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 * i;
    const std::uint32_t b = a + 1;
    const bool last = i + 1 == n;
    const std::uint32_t c = last ? 1 : a + 2;
    const std::uint32_t d = last ? 0 : a + 3;
    soup.triangles.emplace_back(a, c, b);
    soup.triangles.emplace_back(b, c, d);
  }
  const MeshDiagnosis d = diagnose(soup);
  EXPECT_EQ(d.components, 1U);
  EXPECT_EQ(d.boundary_edges, 2U * n);
  EXPECT_EQ(d.nonmanifold_edges, 0U);
  EXPECT_EQ(d.flipped_neighbours, 1U);
  EXPECT_FALSE(d.consistently_oriented());
}

TEST(Diagnose, TwoCubesThatShareAnEdge) {
  TriangleSoup soup = cube();
  // Points 3 and 7 of the first are 0 and 4 of the second.
  const TriangleSoup other = box_mesh({1, 1, 0}, {2, 2, 1});
  const std::uint32_t index[8] = {3, 8, 9, 10, 7, 11, 12, 13};
  for (const int i : {1, 2, 3, 5, 6, 7}) soup.points.push_back(other.points[i]);
  for (const glm::uvec3& t : other.triangles) {
    soup.triangles.emplace_back(index[t.x], index[t.y], index[t.z]);
  }
  const MeshDiagnosis d = diagnose(soup);
  EXPECT_EQ(d.nonmanifold_edges, 1U);
  EXPECT_EQ(d.boundary_edges, 0U);
  EXPECT_EQ(d.components, 1U);
  EXPECT_FALSE(d.closed());
  EXPECT_DOUBLE_EQ(d.volume, 2.0);
}

TEST(Diagnose, TwoCubesThatShareACorner) {
  TriangleSoup soup = cube();
  const TriangleSoup other = box_mesh({1, 1, 1}, {2, 2, 2});
  for (int i = 1; i < 8; ++i) soup.points.push_back(other.points[i]);
  for (const glm::uvec3& t : other.triangles) soup.triangles.push_back(t + 7U);
  const MeshDiagnosis d = diagnose(soup);
  EXPECT_EQ(d.components, 2U);
  EXPECT_TRUE(d.closed());
  EXPECT_EQ(d.component.front(), 0U);
  EXPECT_EQ(d.component.back(), 1U);
}

TEST(Diagnose, FlippedFaceFlipsItsThreeEdges) {
  TriangleSoup soup = cube();
  std::swap(soup.triangles[3].y, soup.triangles[3].z);
  const MeshDiagnosis d = diagnose(soup);
  EXPECT_TRUE(d.closed());
  EXPECT_EQ(d.flipped_neighbours, 3U);
}

TEST(Diagnose, DuplicatesInAnyOrder) {
  TriangleSoup soup = cube();
  const glm::uvec3 t = soup.triangles[0];
  soup.triangles.emplace_back(t.y, t.z, t.x);
  soup.triangles.emplace_back(t.x, t.z, t.y);
  const MeshDiagnosis d = diagnose(soup);
  EXPECT_EQ(d.duplicate_faces, 2U);
  EXPECT_EQ(d.nonmanifold_edges, 3U);
}

TEST(Diagnose, ZeroAreaFaces) {
  TriangleSoup soup = cube();
  soup.points.emplace_back(0.5F, 0.0F, 0.0F);  // 8, on the edge 0-1
  soup.triangles.emplace_back(0, 8, 1);
  soup.triangles.emplace_back(2, 2, 3);  // has no edges: the cube's stay as they are
  const MeshDiagnosis d = diagnose(soup);
  EXPECT_EQ(d.zero_area_faces, 2U);
  EXPECT_EQ(d.boundary_edges, 2U);
  EXPECT_EQ(d.nonmanifold_edges, 1U);
  EXPECT_EQ(d.components, 2U);
}

TEST(Diagnose, SmallTrianglesHaveArea) {
  EXPECT_EQ(diagnose(shapes::scaled(cube(), 1e-12)).zero_area_faces, 0U);
}

TEST(Diagnose, NoTriangles) {
  const MeshDiagnosis d = diagnose(TriangleSoup{});
  EXPECT_EQ(d.triangles, 0U);
  EXPECT_EQ(d.components, 0U);
  EXPECT_FALSE(d.closed());
  EXPECT_TRUE(d.bounds.empty());
}

}  // namespace
}  // namespace sdfgrid
