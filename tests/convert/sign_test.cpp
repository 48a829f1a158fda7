// Signs where methods fail: edges, vertices, gaps, shells, plates, holes, and meshes that are not
// what they should be.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "property/random_meshes.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/grid/vdb.h"
#include "sdfgrid/mesh/reference.h"
#include "sdfgrid/mesh/topology.h"

namespace sdfgrid {
namespace {

using shapes::Random;

struct Signs {
  std::size_t wrong = 0;
  std::size_t inside = 0;
  std::size_t checked = 0;
};

Conversion convert(const TriangleSoup& soup, double voxel,
                   SignMethod sign = SignMethod::automatic) {
  ConvertOptions options;
  options.voxel = voxel;
  options.sign = sign;
  return convert_mesh(soup, options, Job());
}

// Compares the sign of every sample of every brick, active or not, with inside(world).
template <class Inside>
Signs count(const Grid& grid, const Inside& inside) {
  Signs signs;
  const Lattice lattice = grid.lattice();
  for (auto leaf = vdb(grid)->tree().cbeginLeaf(); leaf; ++leaf) {
    for (openvdb::Index i = 0; i < 512; ++i) {
      const float value = leaf->getValue(i);
      if (std::abs(value) < 1e-5 * lattice.voxel) continue;  // on the surface
      const openvdb::Coord c = leaf->offsetToGlobalCoord(i);
      const bool expected = inside(lattice.to_world({c.x(), c.y(), c.z()}));
      ++signs.checked;
      signs.inside += value < 0 ? 1 : 0;
      signs.wrong += (value < 0) != expected ? 1 : 0;
    }
  }
  return signs;
}

TEST(Sign, CubeAlignedWithTheLatticeAndTurned) {
  for (const bool turned : {false, true}) {
    const glm::dmat3 m = turned ? Random(5).rotation() : glm::dmat3(1.0);
    const TriangleSoup cube =
        shapes::transformed(shapes::box_mesh(glm::dvec3(-1), glm::dvec3(1)), m);
    const Conversion conversion = convert(cube, 0.11);
    EXPECT_EQ(conversion.sign, SignMethod::normal);
    const Signs signs = count(conversion.grid, [&](const glm::dvec3& p) {
      const glm::dvec3 q = glm::transpose(m) * p;
      return std::max(std::abs(q.x), std::max(std::abs(q.y), std::abs(q.z))) < 1;
    });
    EXPECT_EQ(signs.wrong, 0U);
    EXPECT_GT(signs.inside, 1000U);
  }
}

// The exterior of a sharp tetrahedron near its edges and vertices: there the nearest face's own
// normal gives the wrong sign for half of the samples.
TEST(Sign, TetrahedronIsOutsideNearItsEdgesAndVertices) {
  const TriangleSoup soup =
      shapes::tetrahedron_mesh({0, 0, 0}, {3, 0.2, 0.1}, {0.1, 0.5, 3}, {2.9, 0.4, 2.7});
  const Topology topology(soup);
  const auto inside = [&](const glm::dvec3& p) {
    for (std::uint32_t t = 0; t < 4; ++t) {
      const glm::uvec3 v = soup.triangles[t];
      const glm::dvec3 a = soup.local(v.x);
      const glm::dvec3 n = glm::cross(soup.local(v.y) - a, soup.local(v.z) - a);
      if (glm::dot(n, p - a) > 0) return false;
    }
    return true;
  };
  const Signs signs = count(convert(soup, 0.05).grid, inside);
  EXPECT_EQ(signs.wrong, 0U);
  EXPECT_GT(signs.inside, 500U);
}

TEST(Sign, SpheresOneTenthApartKeepTheirGap) {
  const TriangleSoup soup = shapes::two_spheres(3, 1.0, 0.1);
  const ReferenceDistance reference(soup);
  for (const double voxel : {0.2, 0.1, 0.05}) {
    const Signs signs = count(convert(soup, voxel).grid, [&](const glm::dvec3& p) {
      return reference.signed_distance(p) < 0;
    });
    EXPECT_EQ(signs.wrong, 0U) << voxel;
    EXPECT_GT(signs.checked, 1000U);
  }
}

TEST(Sign, NestedShellsStayHollowWhicheverWayTheyFace) {
  for (int variant = 0; variant < 4; ++variant) {
    TriangleSoup outer = shapes::icosphere(3, 1.0);
    TriangleSoup inner = shapes::icosphere(3, 0.5);
    if ((variant & 1) != 0) outer = shapes::flipped(outer);
    if ((variant & 2) != 0) inner = shapes::flipped(inner);
    const Conversion conversion = convert(shapes::joined(outer, inner), 0.06);
    const ReferenceDistance big(shapes::icosphere(3, 1.0));
    const ReferenceDistance small(shapes::icosphere(3, 0.5));
    const Signs signs = count(conversion.grid, [&](const glm::dvec3& p) {
      return big.signed_distance(p) < 0 && small.signed_distance(p) > 0;
    });
    EXPECT_EQ(signs.wrong, 0U) << variant;
    // Only the outward outer with the inward inner shell needs no turning.
    EXPECT_EQ(conversion.warnings.empty(), variant == 2) << variant;
    // Tiles too: the middle is outside, between the shells is inside.
    EXPECT_GT(conversion.grid.value({0, 0, 0}), 0);
    EXPECT_LT(conversion.grid.value({static_cast<int>(0.75 / 0.06), 0, 0}), 0);
  }
}

TEST(Sign, PlateOfOneVoxelHasAnInside) {
  for (const double thickness : {1.0, 0.5, 0.01}) {
    const double h = 0.1;
    const TriangleSoup plate = shapes::plate_mesh({0, 0, 0.031}, 2, thickness * h);
    const ReferenceDistance reference(plate);
    const Signs signs = count(convert(plate, h).grid, [&](const glm::dvec3& p) {
      return reference.signed_distance(p) < 0;
    });
    EXPECT_EQ(signs.wrong, 0U) << thickness;
    EXPECT_GT(signs.checked, 1000U);
  }
}

TEST(Sign, InsideOutSphereIsTurnedWithAWarning) {
  const Conversion conversion = convert(shapes::flipped(shapes::icosphere(3, 1.0)), 0.05);
  EXPECT_EQ(conversion.warnings.size(), 1U);
  EXPECT_LT(conversion.grid.value({0, 0, 0}), 0);
}

// A mesh with a hole has an inside all the same, and its cap is where the winding number is one
// half.
TEST(Sign, HolesGetACapWhereTheWindingNumberIsOneHalf) {
  const TriangleSoup soup = shapes::with_hole(shapes::icosphere(4, 1.0), 300, 150);
  const Conversion conversion = convert(soup, 0.04);
  EXPECT_EQ(conversion.sign, SignMethod::winding);
  EXPECT_NE(conversion.sign_reason.find("boundary edges"), std::string::npos);
  const ReferenceDistance reference(soup);
  const double doubt = 0.005;  // the tolerance of the hierarchical winding number
  const Grid& grid = conversion.grid;
  const Lattice lattice = grid.lattice();
  std::size_t wrong = 0;
  std::size_t inside = 0;
  for (int x = -30; x <= 30; ++x) {
    for (int y = -30; y <= 30; ++y) {
      for (int z = -30; z <= 30; ++z) {
        const glm::dvec3 p = lattice.to_world({x, y, z});
        const double w = reference.winding_number(p);
        if (std::abs(w - 0.5) < doubt || reference.distance(p) < 1e-5 * lattice.voxel) continue;
        const bool negative = grid.value({x, y, z}) < 0;
        wrong += negative != (w > 0.5) ? 1 : 0;
        inside += negative ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_NEAR(static_cast<double>(inside) * std::pow(lattice.voxel, 3), 4.19, 0.15);
}

TEST(Sign, WindingAgreesWithNormalsOnClosedMeshes) {
  for (const auto& [name, soup] : shapes::random_closed_meshes(21, 6)) {
    ConvertOptions options;
    options.dim = 24;
    options.sign = SignMethod::normal;
    const Conversion normal = convert_mesh(soup, options, Job());
    options.sign = SignMethod::winding;
    const Conversion winding = convert_mesh(soup, options, Job());
    const auto other = vdb(winding.grid)->getConstAccessor();
    const double h = normal.grid.lattice().voxel;
    for (auto it = vdb(normal.grid)->cbeginValueOn(); it; ++it) {
      if (std::abs(*it) < 1e-5 * h) continue;
      ASSERT_EQ(*it, other.getValue(it.getCoord())) << name;
    }
  }
}

// Where two closed meshes cross, their triangles inside one another are no surface of the whole.
TEST(Sign, OverlappingSpheresAreOneSolid) {
  const TriangleSoup a = shapes::icosphere(3, 1.0, {-0.4, 0, 0});
  const TriangleSoup b = shapes::icosphere(3, 1.0, {0.4, 0, 0});
  const ReferenceDistance first(a);
  const ReferenceDistance second(b);
  for (const SignMethod method : {SignMethod::winding, SignMethod::automatic}) {
    const Conversion conversion = convert(shapes::joined(a, b), 0.05, method);
    EXPECT_EQ(conversion.sign, SignMethod::winding) << conversion.sign_reason;
    const Signs signs = count(conversion.grid, [&](const glm::dvec3& p) {
      return first.signed_distance(p) < 0 || second.signed_distance(p) < 0;
    });
    EXPECT_EQ(signs.wrong, 0U);
  }
}

// Normals contradict each other where parts cross by a voxel or more, and only there.
TEST(Sign, ContradictingNormalsAreNoticed) {
  const auto crossing = [](double gap) {
    return shapes::joined(shapes::icosphere(4, 1.0, {-1.0 - 0.5 * gap, 0, 0}),
                          shapes::icosphere(4, 1.0, {1.0 + 0.5 * gap, 0.1, 0.03}));
  };
  const auto warnings = [&](double gap) {
    return convert(crossing(gap), 0.05, SignMethod::normal).warnings.size();
  };
  EXPECT_EQ(warnings(0.02), 0U);
  EXPECT_EQ(warnings(-0.12), 1U);
  EXPECT_EQ(convert(crossing(0.02), 0.05).sign, SignMethod::normal);
  const Conversion found = convert(crossing(-0.12), 0.05);
  EXPECT_EQ(found.sign, SignMethod::winding);
  EXPECT_NE(found.sign_reason.find("crosses itself"), std::string::npos) << found.sign_reason;
  for (const auto& [name, soup] : shapes::random_closed_meshes(5, 6)) {
    ConvertOptions options;
    options.dim = 40;
    EXPECT_EQ(convert_mesh(soup, options, Job()).sign, SignMethod::normal) << name;
  }
}

// Two pyramids that share the vertex of their tips: one is sharp, the other blunt.
TEST(Sign, PinchedVertexBelongsToOneFanAtATime) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0},      {1, 1, 2},       {-1, 1, 2},       {-1, -1, 2},    {1, -1, 2},
                 {0.3, 0.3, -2}, {-0.3, 0.3, -2}, {-0.3, -0.3, -2}, {0.3, -0.3, -2}};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}, {1, 4, 3}, {1, 3, 2},
                    {0, 6, 5}, {0, 7, 6}, {0, 8, 7}, {0, 5, 8}, {5, 6, 7}, {5, 7, 8}};
  soup = shapes::flipped(soup);  // outward
  const Conversion conversion = convert(soup, 0.07);
  EXPECT_EQ(conversion.sign, SignMethod::normal);
  const ReferenceDistance reference(soup);
  const Signs signs =
      count(conversion.grid, [&](const glm::dvec3& p) { return reference.signed_distance(p) < 0; });
  EXPECT_EQ(signs.wrong, 0U);
  EXPECT_GT(signs.inside, 1000U);
}

// A closed part whose front and back coincide has no volume: all is outside, whichever triangle
// comes first.
TEST(Sign, FlatClosedPartsHaveNoInside) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  for (int order = 0; order < 2; ++order) {
    const Conversion conversion = convert(soup, 0.1);
    EXPECT_EQ(conversion.sign, SignMethod::winding) << conversion.sign_reason;
    EXPECT_EQ(count(conversion.grid, [](const glm::dvec3&) { return false; }).wrong, 0U);
    std::reverse(soup.triangles.begin(), soup.triangles.end());
  }
}

TEST(Sign, AutomaticChoiceSaysWhatIsWrongWithTheMesh) {
  const TriangleSoup holed = shapes::with_hole(shapes::icosphere(2, 1.0), 0, 3);
  const Conversion conversion = convert(holed, 0.1);
  EXPECT_EQ(conversion.sign, SignMethod::winding);
  EXPECT_NE(conversion.sign_reason.find("boundary edges"), std::string::npos)
      << conversion.sign_reason;
  EXPECT_THROW((void)convert(holed, 0.1, SignMethod::normal), Error);
}

// Every third face of a ball faces inward: the inside is the ball's all the same.
TEST(Sign, FacesThatFaceAgainstTheirNeighboursAreTurned) {
  TriangleSoup soup = shapes::icosphere(3, 1.0);
  for (std::size_t t = 0; t < soup.triangles.size(); t += 3) {
    std::swap(soup.triangles[t].x, soup.triangles[t].y);
  }
  const Conversion conversion = convert(soup, 0.1);
  EXPECT_EQ(conversion.sign, SignMethod::normal) << conversion.sign_reason;
  ASSERT_FALSE(conversion.warnings.empty());
  EXPECT_NE(conversion.warnings.front().find("faced against their neighbours"), std::string::npos);
  const ReferenceDistance reference(shapes::icosphere(3, 1.0));
  const Signs signs =
      count(conversion.grid, [&](const glm::dvec3& p) { return reference.signed_distance(p) < 0; });
  EXPECT_EQ(signs.wrong, 0U);
  EXPECT_GT(signs.inside, 500U);
}

}  // namespace
}  // namespace sdfgrid
