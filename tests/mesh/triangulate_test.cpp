#include "sdfgrid/mesh/triangulate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <random>
#include <vector>

namespace sdfgrid {
namespace {

struct Result {
  Cut cut = Cut::clean;
  std::size_t triangles = 0;
  double covered = 0.0;  // sum of the triangles' areas
  glm::dvec3 area{0.0};  // sum of their area vectors
};

Result cut(const std::vector<glm::dvec3>& points) {
  std::vector<std::uint32_t> polygon(points.size());
  std::iota(polygon.begin(), polygon.end(), 0U);
  Result result;
  result.cut = triangulate(points, polygon, [&](auto a, auto b, auto c) {
    const glm::dvec3 area = 0.5 * glm::cross(points[b] - points[a], points[c] - points[a]);
    ++result.triangles;
    result.covered += glm::length(area);
    result.area += area;
  });
  return result;
}

// Triangles that do not overlap cover exactly the polygon's area.
void expect_clean(const std::vector<glm::dvec3>& points, double area) {
  const Result result = cut(points);
  EXPECT_EQ(result.cut, Cut::clean);
  EXPECT_EQ(result.triangles, points.size() - 2);
  EXPECT_NEAR(result.covered, area, 1e-9 * area);
  EXPECT_NEAR(glm::length(result.area), area, 1e-9 * area);
}

TEST(Triangulate, ConcaveQuadFromEveryCorner) {
  std::vector<glm::dvec3> dart = {{0, 0, 0}, {4, 0, 0}, {1, 1, 0}, {0, 4, 0}};
  for (int turn = 0; turn < 4; ++turn) {
    expect_clean(dart, 4.0);
    std::rotate(dart.begin(), dart.begin() + 1, dart.end());
  }
}

TEST(Triangulate, ConcaveQuadOnAnyPlane) {
  const glm::dvec3 u = glm::normalize(glm::dvec3(1, 2, -1));
  const glm::dvec3 v = glm::normalize(glm::cross(u, glm::dvec3(0.3, 0.1, 1)));
  std::vector<glm::dvec3> dart;
  for (const auto& [x, y] : {std::pair(0.0, 0.0), {4.0, 0.0}, {1.0, 1.0}, {0.0, 4.0}}) {
    dart.push_back(glm::dvec3(612345.25, 4123456.5, 17.0) + x * u + y * v);
  }
  expect_clean(dart, 4.0);
}

TEST(Triangulate, CombWithManyTeeth) {
  std::vector<glm::dvec3> comb;
  const int teeth = 100;
  for (int i = 0; i < teeth; ++i) {
    comb.emplace_back(2 * i, 0, 0);
    comb.emplace_back(2 * i + 1, 10, 0);
  }
  comb.emplace_back(2 * teeth, 0, 0);
  comb.emplace_back(2 * teeth, 12, 0);
  comb.emplace_back(0, 12, 0);
  std::reverse(comb.begin(), comb.end());
  double area = 0.0;
  for (std::size_t i = 0; i < comb.size(); ++i) {
    const glm::dvec3& a = comb[i];
    const glm::dvec3& b = comb[(i + 1) % comb.size()];
    area += 0.5 * (a.x * b.y - a.y * b.x);
  }
  expect_clean(comb, std::abs(area));
}

TEST(Triangulate, RandomStarShapedPolygons) {
  std::mt19937 engine(7);
  for (int round = 0; round < 200; ++round) {
    const int corners = 4 + round % 60;
    std::vector<glm::dvec3> star;
    double area = 0.0;
    for (int i = 0; i < corners; ++i) {
      const double angle = 6.283185307179586 * i / corners;
      const double radius = 0.1 + static_cast<double>(engine() % 1000) / 1000.0;
      star.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
    }
    for (int i = 0; i < corners; ++i) {
      area += 0.5 * glm::cross(star[i], star[(i + 1) % corners]).z;
    }
    expect_clean(star, area);
  }
}

// As programs write a face with a hole: one loop that runs along a bridge twice.
TEST(Triangulate, HoleWithABridge) {
  expect_clean({{0, 0, 0},
                {9, 0, 0},
                {9, 9, 0},
                {0, 9, 0},
                {0, 0, 0},
                {3, 3, 0},
                {3, 6, 0},
                {6, 6, 0},
                {6, 3, 0},
                {3, 3, 0}},
               72.0);
}

TEST(Triangulate, CollinearCornersStayConvex) {
  expect_clean({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}}, 4.0);
}

TEST(Triangulate, SaysWhenAPolygonCrossesItself) {
  std::vector<glm::dvec3> pentagram;
  for (int i = 0; i < 5; ++i) {
    const double angle = 2.0 * 6.283185307179586 * i / 5;
    pentagram.emplace_back(std::cos(angle), std::sin(angle), 0.0);
  }
  const Result result = cut(pentagram);
  EXPECT_EQ(result.cut, Cut::crossing);
  EXPECT_EQ(result.triangles, 3U);
}

TEST(Triangulate, SaysWhenAPolygonHasNoArea) {
  const Result result = cut({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}});
  EXPECT_EQ(result.cut, Cut::crossing);
  EXPECT_EQ(result.triangles, 2U);
}

}  // namespace
}  // namespace sdfgrid
