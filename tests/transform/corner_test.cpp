// Solids of a few planes, which the anti-aliased transform has at edges and corners, against trying
// points.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "sdfgrid/transform/coverage_corner.h"

namespace sdfgrid {
namespace {

// A corner of three planes that meet askew, or of the first of them.
Corner askew(int planes, bool hollow) {
  Corner corner;
  corner.count = planes;
  corner.hollow = hollow;
  corner.planes = {{{{0.1F, 0.2F, 0.3F}, glm::normalize(glm::vec3(1, 0.3F, 0.2F))},
                    {{0.2F, 0.1F, 0.3F}, glm::normalize(glm::vec3(-0.4F, 1, 0.1F))},
                    {{0.3F, 0.1F, 0.2F}, glm::normalize(glm::vec3(0.2F, -0.3F, 1))}}};
  return corner;
}

bool is_inside(const Corner& corner, const glm::vec3& p) {
  bool all = true;
  bool any = false;
  for (int i = 0; i < corner.count; ++i) {
    const auto& plane = corner.planes[static_cast<std::size_t>(i)];
    const bool below = glm::dot(plane.normal, p - plane.point) < 0;
    all = all && below;
    any = any || below;
  }
  return corner.hollow ? any : all;
}

// The nearest point is on the surface, and all of the ball up to it is on one side.
TEST(Corner, NearestPointsAreNearest) {
  std::mt19937 random(11);
  const auto unit = [&] { return std::uniform_real_distribution<float>(-1, 1)(random); };
  const auto place = [&] { return glm::vec3(unit(), unit(), unit()); };
  for (int n = 0; n < 600; ++n) {
    const Corner corner = askew(1 + n % 3, n % 2 == 0);
    const glm::vec3 p = 3.0F * place();
    const CornerFoot foot = nearest_on(corner, p);
    const float distance = glm::distance(p, foot.point);
    ASSERT_EQ(foot.distance < 0, is_inside(corner, p));
    ASSERT_NEAR(std::abs(foot.distance), distance, 1e-4F);
    bool both_sides[2] = {false, false};
    for (int i = 0; i < 400; ++i) {
      both_sides[is_inside(corner, foot.point + 0.01F * place()) ? 1 : 0] = true;
      const glm::vec3 way = place();
      if (glm::length(way) > 1) continue;
      ASSERT_EQ(is_inside(corner, p + 0.999F * distance * way), is_inside(corner, p));
    }
    ASSERT_TRUE(both_sides[0] && both_sides[1]);
  }
}

TEST(Corner, CoversItsPartOfABox) {
  std::mt19937 random(12);
  const auto unit = [&] { return std::uniform_real_distribution<>(-1, 1)(random); };
  constexpr int kSteps = 24;
  for (int n = 0; n < 60; ++n) {
    const Corner corner = askew(1 + n % 3, n % 2 == 0);
    const glm::dvec3 middle(unit(), unit(), unit());
    const glm::dvec3 sides(1, 1.2, 1.5);
    int inside = 0;
    for (int i = 0; i < kSteps * kSteps * kSteps; ++i) {
      const glm::dvec3 at(i % kSteps, i / kSteps % kSteps, i / kSteps / kSteps);
      const glm::dvec3 p = ((at + 0.5) / static_cast<double>(kSteps) - 0.5) * sides + middle;
      inside += is_inside(corner, glm::vec3(p)) ? 1 : 0;
    }
    EXPECT_NEAR(covered_by(corner, middle, sides), inside / std::pow(kSteps, 3), 0.02);
  }
}

}  // namespace
}  // namespace sdfgrid
