#include "sdfgrid/trace/camera.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "sdfgrid/core/error.h"

namespace sdfgrid {

RayGenerator::RayGenerator(const Camera& camera) : eye_(camera.eye) {
  const glm::dvec3 forward = camera.target - camera.eye;
  if (!(glm::length(forward) > 0)) {
    throw Error(ErrorKind::usage, "the camera's eye and target are the same point");
  }
  if (!(camera.fov > 0 && camera.fov < 180)) {
    throw Error(ErrorKind::usage, "the camera's fov must be between 0 and 180 degrees");
  }
  if (camera.width <= 0 || camera.height <= 0) {
    throw Error(ErrorKind::usage, "the picture's size must be at least 1x1 pixels");
  }
  const glm::dvec3 w = glm::normalize(forward);
  glm::dvec3 right = glm::cross(w, camera.up);
  if (!(glm::length(right) > 1e-9 * glm::length(camera.up))) {
    // Looking along `up`: any other axis gives a picture.
    right = glm::cross(w, std::abs(w.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1));
  }
  right = glm::normalize(right);
  const glm::dvec3 down = glm::cross(w, right);
  const double half = std::tan(glm::radians(camera.fov) / 2);
  const double pixel = 2 * half / camera.height;
  right_ = pixel * right;
  down_ = pixel * down;
  corner_ = w - (0.5 * camera.width) * right_ - (0.5 * camera.height) * down_;
}

Ray RayGenerator::ray(double x, double y) const {
  return {eye_, glm::normalize(corner_ + x * right_ + y * down_)};
}

}  // namespace sdfgrid
