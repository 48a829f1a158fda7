// Cameras that see all of what they are given; declared in camera.h.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include "sdfgrid/core/error.h"
#include "sdfgrid/trace/camera.h"

namespace sdfgrid {
namespace {

// One axis of the picture: how far points reach towards its two borders, in a frame where the eye
// is at depth -distance and a border falls back by `slope` for each unit of depth.
struct Reach {
  double slope;
  double right = -std::numeric_limits<double>::infinity();
  double left = -std::numeric_limits<double>::infinity();

  void add(double across, double depth) {
    right = std::max(right, across - slope * depth);
    left = std::max(left, -across - slope * depth);
  }
  // The eye must stand at center() and at least this far back for both borders to be clear.
  [[nodiscard]] double distance() const { return (right + left) / (2 * slope); }
  [[nodiscard]] double center() const { return (right - left) / 2; }
};

// Where the observer stands at turn 0: level, in front.
glm::dvec3 front(const glm::dvec3& up) {
  const glm::dvec3 axis = std::abs(up.z) < 0.7 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, -1, 0);
  return glm::normalize(axis - glm::dot(axis, up) * up);
}

void check(std::span<const glm::dvec3> points, int width, int height, const View& view) {
  const auto refuse = [](const char* why) { throw Error(ErrorKind::usage, why); };
  if (points.empty()) refuse("there is nothing to frame; give the camera's eye and target");
  if (!(glm::length(view.up) > 0)) refuse("the direction up has no length");
  if (!(view.fov > 0 && view.fov < 180))
    refuse("the camera's fov must be between 0 and 180 degrees");
  if (!(view.margin >= 0 && view.margin < 1)) refuse("the picture's margin must be in [0, 1)");
  if (!(std::abs(view.tilt) <= 90)) refuse("the camera's tilt must be between -90 and 90 degrees");
  if (width <= 0 || height <= 0) refuse("the picture's size must be at least 1x1 pixels");
}

}  // namespace

Camera frame(std::span<const glm::dvec3> points, int width, int height, const View& view) {
  check(points, width, height, view);
  const glm::dvec3 up = glm::normalize(view.up);
  const glm::dvec3 level = front(up);
  const glm::dvec3 side = glm::cross(up, level);
  const double turn = glm::radians(view.turn);
  // Not quite 90 degrees, where up would have no direction in the picture.
  const double tilt = glm::radians(std::clamp(view.tilt, -89.9, 89.9));
  const glm::dvec3 back =
      std::sin(tilt) * up + std::cos(tilt) * (std::cos(turn) * level + std::sin(turn) * side);
  const glm::dvec3 right = glm::normalize(glm::cross(up, back));
  const glm::dvec3 over = glm::cross(back, right);

  const double slope = (1 - view.margin) * std::tan(glm::radians(view.fov) / 2);
  Reach across{slope * width / height};
  Reach down{slope};
  for (const glm::dvec3& point : points) {
    const glm::dvec3 p = point - points.front();
    across.add(glm::dot(p, right), -glm::dot(p, back));
    down.add(glm::dot(p, over), -glm::dot(p, back));
  }
  double distance = std::max(across.distance(), down.distance());
  if (!(distance > 0)) distance = 1;  // one point
  Camera camera;
  camera.target = points.front() + across.center() * right + down.center() * over;
  camera.eye = camera.target + distance * back;
  camera.up = up;
  camera.fov = view.fov;
  camera.width = width;
  camera.height = height;
  return camera;
}

Camera frame(const Box& box, int width, int height, double fov) {
  glm::dvec3 corners[8];
  for (int n = 0; n < 8; ++n) {
    corners[n] = {(n & 4) != 0 ? box.hi.x : box.lo.x, (n & 2) != 0 ? box.hi.y : box.lo.y,
                  (n & 1) != 0 ? box.hi.z : box.lo.z};
  }
  View view;
  view.fov = fov;
  if (box.empty()) return frame(std::span<const glm::dvec3>(), width, height, view);
  return frame(corners, width, height, view);
}

}  // namespace sdfgrid
