// trace/camera.h: a perspective camera in world units, right-handed, in double.
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "sdfgrid/core/lattice.h"

namespace sdfgrid {

struct Camera {
  glm::dvec3 eye{0, 0, 5};
  glm::dvec3 target{0.0};
  glm::dvec3 up{0, 1, 0};
  double fov = 40.0;  // degrees, across the picture's height
  int width = 1024;   // pixels
  int height = 1024;
};

struct Ray {
  glm::dvec3 origin;
  glm::dvec3 direction;  // unit length
};

// The rays of a camera: through (x, y) in pixels, (0, 0) the upper left corner of the picture, so
// that pixel (i, j) has its centre at (i + 0.5, j + 0.5).
class RayGenerator {
 public:
  // Throws Error{usage} if eye equals target, fov is outside (0, 180) or the size is not positive.
  explicit RayGenerator(const Camera& camera);
  [[nodiscard]] Ray ray(double x, double y) const;

  // The direction through (x, y), before it gets unit length, is corner + x right + y down.
  [[nodiscard]] const glm::dvec3& corner() const { return corner_; }
  [[nodiscard]] const glm::dvec3& right() const { return right_; }
  [[nodiscard]] const glm::dvec3& down() const { return down_; }

 private:
  glm::dvec3 eye_, corner_, right_, down_;  // corner_ + x right_ + y down_ is the direction
};

// From where to look at something. The side that faces an observer at turn 0 is the one towards +z
// if y is up, and towards -y if z is up, as most modelling programs have it.
struct View {
  glm::dvec3 up{0, 1, 0};
  double turn = 24;   // degrees that the observer goes round `up`, to the right
  double tilt = 15;   // degrees that the observer is above the horizon
  double fov = 40;    // as Camera::fov
  double margin = 0;  // part of the half picture to leave free at each border
};

// The nearest camera of the view that sees all of `points`, which so touch two opposite borders of
// the picture less its margin. Throws Error{usage} if there are no points, or the view makes no
// sense.
[[nodiscard]] Camera frame(std::span<const glm::dvec3> points, int width, int height,
                           const View& view);

// The same for the corners of a box, from above and to the side.
[[nodiscard]] Camera frame(const Box& box, int width, int height, double fov = 40.0);

}  // namespace sdfgrid
