// frame(): everything is in the picture, and nothing is left to spare.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <random>

#include "sdfgrid/core/error.h"
#include "sdfgrid/trace/camera.h"

namespace sdfgrid {
namespace {

// Where a point appears, in half pictures from the centre: x to the right, y down.
glm::dvec2 projected(const Camera& camera, const glm::dvec3& p) {
  const glm::dvec3 w = glm::normalize(camera.target - camera.eye);
  const glm::dvec3 right = glm::normalize(glm::cross(w, camera.up));
  const glm::dvec3 down = glm::cross(w, right);
  const double half = std::tan(glm::radians(camera.fov) / 2);
  const glm::dvec3 d = p - camera.eye;
  const double aspect = static_cast<double>(camera.width) / camera.height;
  return {glm::dot(d, right) / (glm::dot(d, w) * half * aspect),
          glm::dot(d, down) / (glm::dot(d, w) * half)};
}

std::vector<glm::dvec3> cloud(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 60; ++i) {
    points.emplace_back(100 + 3 * unit(random), 7 * unit(random), 20 * unit(random));
  }
  return points;
}

TEST(Framing, PointsFillThePictureLessItsMargin) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto points = cloud(seed);
    View view;
    view.turn = 18.0 * static_cast<double>(seed);
    view.tilt = 8.0 * static_cast<double>(seed) - 80;
    view.fov = 20 + 3 * static_cast<double>(seed);
    view.margin = 0.1;
    view.up = seed % 2 == 0 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 2);
    const Camera camera = frame(points, 400, 300, view);
    double extent[4] = {-9, -9, -9, -9};
    for (const glm::dvec3& p : points) {
      const glm::dvec2 at = projected(camera, p);
      extent[0] = std::max(extent[0], at.x);
      extent[1] = std::max(extent[1], -at.x);
      extent[2] = std::max(extent[2], at.y);
      extent[3] = std::max(extent[3], -at.y);
    }
    for (const double e : extent) EXPECT_LE(e, 0.9 + 1e-9);
    EXPECT_NEAR(*std::max_element(extent, extent + 4), 0.9, 1e-9);
    const bool touches_both = (extent[0] > 0.9 - 1e-9 && extent[1] > 0.9 - 1e-9) ||
                              (extent[2] > 0.9 - 1e-9 && extent[3] > 0.9 - 1e-9);
    EXPECT_TRUE(touches_both) << "seed " << seed;
  }
}

TEST(Framing, LooksFromWhereTheViewSays) {
  const auto points = cloud(1);
  View view;
  view.turn = 0;
  view.tilt = 0;
  const auto from = [&] {
    const Camera camera = frame(points, 100, 100, view);
    return glm::normalize(camera.eye - camera.target);
  };
  const auto near = [](const glm::dvec3& a, const glm::dvec3& b) {
    return glm::distance(a, b) < 1e-9;
  };
  EXPECT_TRUE(near(from(), {0, 0, 1}));
  view.turn = 90;  // to the right of one who looks along -z with y up
  EXPECT_TRUE(near(from(), {1, 0, 0}));
  view.tilt = 30;
  EXPECT_NEAR(from().y, 0.5, 1e-9);
  view = {{0, 0, 1}, 0, 0};
  EXPECT_TRUE(near(from(), {0, -1, 0}));
  view.turn = 90;
  EXPECT_TRUE(near(from(), {1, 0, 0}));
}

TEST(Framing, OnePointIsInTheMiddle) {
  const glm::dvec3 point(3, 4, 5);
  const Camera camera = frame(std::span(&point, 1), 100, 50, View());
  EXPECT_NEAR(glm::length(projected(camera, point)), 0, 1e-12);
}

TEST(Framing, RefusesWhatMakesNoSense) {
  const auto points = cloud(1);
  const auto refused = [&](const View& view) {
    EXPECT_THROW((void)frame(points, 100, 100, view), Error);
  };
  EXPECT_THROW((void)frame(std::span<const glm::dvec3>(), 100, 100, View()), Error);
  EXPECT_THROW((void)frame(points, 0, 100, View()), Error);
  EXPECT_THROW((void)frame(Box(), 100, 100), Error);
  View view;
  view.up = glm::dvec3(0);
  refused(view);
  view = View();
  view.fov = 180;
  refused(view);
  view = View();
  view.tilt = 91;
  refused(view);
  view = View();
  view.margin = 1;
  refused(view);
}

}  // namespace
}  // namespace sdfgrid
