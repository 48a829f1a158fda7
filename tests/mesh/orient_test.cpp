#include "sdfgrid/mesh/orient.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "property/random_meshes.h"
#include "sdfgrid/mesh/piercing.h"

namespace sdfgrid {
namespace {

using shapes::flipped;
using shapes::icosphere;
using shapes::joined;

std::vector<double> volumes(const TriangleSoup& soup, const MeshDiagnosis& diagnosis) {
  std::vector<double> result(diagnosis.components, 0.0);
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const glm::uvec3& corner = soup.triangles[t];
    result[diagnosis.component[t]] +=
        glm::dot(soup.local(corner.x), glm::cross(soup.local(corner.y), soup.local(corner.z))) /
        6.0;
  }
  return result;
}

// Orients, and returns for each component whether it faces outward.
std::vector<bool> oriented(TriangleSoup& soup, std::vector<std::string>* warnings = nullptr) {
  const MeshDiagnosis diagnosis = diagnose(soup);
  const std::vector<std::string> said = orient_closed_components(soup, diagnosis);
  if (warnings != nullptr) *warnings = said;
  std::vector<bool> outward;
  for (const double v : volumes(soup, diagnosis)) outward.push_back(v > 0.0);
  return outward;
}

// A line that leaves a closed surface as often as it enters it, however it meets corners and edges.
TEST(Piercing, LinesThroughCornersAndEdgesCountOnce) {
  TriangleSoup lattice;
  for (int i = 0; i < 3; ++i) {
    const double x = 3.0 * i;
    lattice = joined(lattice, shapes::box_mesh({x, 0, 0}, {x + 2, 2, 2}));
  }
  for (const TriangleSoup& soup : {lattice, icosphere(2, 1.0), shapes::torus_mesh(1.0, 0.4)}) {
    const Piercing piercing(soup);
    std::vector<glm::dvec3> places;  // corners, middles of edges
    for (const glm::uvec3& t : soup.triangles) {
      places.push_back(soup.local(t.x));
      places.push_back(0.5 * (soup.local(t.x) + soup.local(t.y)));
    }
    for (const glm::dvec3& p : places) {
      int balance = 0;
      int crossings = 0;
      piercing.along_x(p.y, p.z, [&](std::uint32_t, double, int direction) {
        balance += direction;
        ++crossings;
      });
      EXPECT_EQ(balance, 0) << p.y << ' ' << p.z;
      EXPECT_EQ(crossings % 2, 0);
    }
  }
}

TEST(Piercing, SaysWhere) {
  const TriangleSoup soup = shapes::box_mesh({1, 0, 0}, {3, 2, 2});
  std::vector<double> xs;
  Piercing(soup).along_x(0.7, 1.1, [&](std::uint32_t, double x, int) { xs.push_back(x); });
  std::sort(xs.begin(), xs.end());
  EXPECT_EQ(xs, (std::vector<double>{1.0, 3.0}));
  Piercing(soup).along_x(2.5, 1.0, [&](std::uint32_t, double, int) { FAIL(); });
}

TEST(Orient, TurnsAnInsideOutSphere) {
  TriangleSoup soup = flipped(icosphere(2, 1.0));
  std::vector<std::string> warnings;
  EXPECT_EQ(oriented(soup, &warnings), std::vector<bool>{true});
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0], "turned the mesh: it was inside out");
}

TEST(Orient, LeavesASphereAlone) {
  TriangleSoup soup = icosphere(2, 1.0);
  const TriangleSoup before = soup;
  std::vector<std::string> warnings;
  EXPECT_EQ(oriented(soup, &warnings), std::vector<bool>{true});
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(soup.triangles, before.triangles);
}

TEST(Orient, NestedShellsStayHollowFromAllFourOrientations) {
  const TriangleSoup outer = icosphere(2, 1.0);
  const TriangleSoup inner = icosphere(3, 0.5, {0.2, 0.1, 0.0});
  for (const bool turn_outer : {false, true}) {
    for (const bool turn_inner : {false, true}) {
      TriangleSoup soup =
          joined(turn_outer ? flipped(outer) : outer, turn_inner ? flipped(inner) : inner);
      std::vector<std::string> warnings;
      EXPECT_EQ(oriented(soup, &warnings), (std::vector<bool>{true, false}));
      const int turned = int(turn_outer) + int(!turn_inner);
      ASSERT_EQ(warnings.size(), turned > 0 ? 1U : 0U);
      if (turned > 0) {
        EXPECT_TRUE(warnings[0].starts_with("turned " + std::to_string(turned) + " of 2 closed"));
      }
    }
  }
}

TEST(Orient, ThreeShellsDeepInAnyOrder) {
  for (const bool inside_first : {false, true}) {
    TriangleSoup soup;
    for (int level = 0; level < 4; ++level) {
      const int i = inside_first ? 3 - level : level;
      soup = joined(soup, icosphere(2, 4.0 - i, {0.1 * i, 0.0, -0.05 * i}));
    }
    const std::vector<bool> expected = inside_first ? std::vector<bool>{false, true, false, true}
                                                    : std::vector<bool>{true, false, true, false};
    EXPECT_EQ(oriented(soup), expected);
  }
}

TEST(Orient, ManyCavitiesInOnePlane) {
  TriangleSoup soup = shapes::box_mesh({0, 0, 0}, {9, 9, 9});
  for (int i = 1; i < 8; i += 2) {
    for (int j = 1; j < 8; j += 2) {
      for (int k = 1; k < 8; k += 2) {
        soup = joined(soup, shapes::box_mesh({i, j, k}, {i + 1, j + 1, k + 1}));
      }
    }
  }
  std::vector<bool> expected(65, false);
  expected[0] = true;
  EXPECT_EQ(oriented(soup), expected);
}

TEST(Orient, ComponentsThatOverlapOrTouchFaceOutward) {
  TriangleSoup soup = joined(icosphere(3, 1.0), flipped(icosphere(3, 1.0, {0.7, 0.2, 0.1})));
  EXPECT_EQ(oriented(soup), (std::vector<bool>{true, true}));
  TriangleSoup boxes = joined(flipped(shapes::box_mesh({0, 0, 0}, {1, 1, 1})),
                              shapes::box_mesh({1, 0, 0}, {2, 1, 1}));
  EXPECT_EQ(oriented(boxes), (std::vector<bool>{true, true}));
}

TEST(Orient, ATorusInTheHoleOfATorusIsNotInIt) {
  TriangleSoup soup = joined(shapes::torus_mesh(3.0, 0.5), shapes::torus_mesh(1.5, 0.5));
  EXPECT_EQ(oriented(soup), (std::vector<bool>{true, true}));
}

TEST(Orient, ThousandsOfBubbles) {
  shapes::Random random(5);
  TriangleSoup soup = icosphere(5, 40.0);
  std::vector<bool> expected = {true};
  for (int i = -8; i < 8; ++i) {
    for (int j = -8; j < 8; ++j) {
      for (int k = -8; k < 8; ++k) {
        if (i * i + j * j + k * k > 90) continue;
        const TriangleSoup bubble = icosphere(0, 1.0, {4.0 * i, 4.0 * j, 4.0 * k});
        soup = joined(std::move(soup), random.unit() < 0.5 ? bubble : flipped(bubble));
        expected.push_back(false);
      }
    }
  }
  ASSERT_GT(expected.size(), 2000U);
  EXPECT_EQ(oriented(soup), expected);
}

TEST(Orient, NeighboursAgreeWithTheMostOfThem) {
  TriangleSoup soup = joined(icosphere(2, 1.0), shapes::with_hole(icosphere(2, 3.0), 0, 4));
  const TriangleSoup before = soup;
  std::size_t turned = 0;
  for (std::size_t t = 0; t < soup.triangles.size(); t += 5, ++turned) {
    std::swap(soup.triangles[t].y, soup.triangles[t].z);
  }
  EXPECT_GT(diagnose(soup).flipped_neighbours, 0U);
  EXPECT_EQ(agree_with_neighbours(soup, diagnose(soup)), turned);
  EXPECT_EQ(diagnose(soup).flipped_neighbours, 0U);
  EXPECT_EQ(soup.triangles, before.triangles);
}

// A strip with half a turn in it, and three sheets at one edge: no choice makes all agree.
TEST(Orient, WhatCannotAgreeStaysAsItIs) {
  TriangleSoup strip;
  for (const float a : {0.0F, 1.0F, 2.0F, 3.0F, 4.0F}) {
    strip.points.emplace_back(a, 0, 0);
    strip.points.emplace_back(a, 1, a);
  }
  strip.triangles = {{0, 2, 1}, {1, 2, 3}, {2, 4, 3}, {3, 4, 5}, {4, 6, 5},
                     {5, 6, 7}, {6, 8, 7}, {7, 8, 9}, {8, 1, 9}, {9, 1, 0}};
  TriangleSoup fan;
  fan.points = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0}};
  fan.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
  for (TriangleSoup soup : {strip, fan}) {
    const TriangleSoup before = soup;
    EXPECT_EQ(agree_with_neighbours(soup, diagnose(soup)), 0U);
    EXPECT_EQ(soup.triangles, before.triangles);
  }
  EXPECT_GT(diagnose(strip).flipped_neighbours, 0U);
  TriangleSoup asked = strip;
  EXPECT_NE(orient_mesh(asked).warnings.front().find("cannot agree"), std::string::npos);
}

TEST(Orient, LeavesOtherMeshesAlone) {
  TriangleSoup open = flipped(icosphere(2, 1.0));
  open.triangles.pop_back();
  TriangleSoup inconsistent = flipped(icosphere(2, 1.0));
  std::swap(inconsistent.triangles[0].y, inconsistent.triangles[0].z);
  for (TriangleSoup* soup : {&open, &inconsistent}) {
    const TriangleSoup before = *soup;
    EXPECT_TRUE(orient_closed_components(*soup, diagnose(*soup)).empty());
    EXPECT_EQ(soup->triangles, before.triangles);
  }
}

}  // namespace
}  // namespace sdfgrid
