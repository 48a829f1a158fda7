// trace/camera.h: a perspective camera in world units, right-handed, in double.
#pragma once

#include <glm/vec3.hpp>

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

 private:
  glm::dvec3 eye_, corner_, right_, down_;  // corner_ + x right_ + y down_ is the direction
};

// A camera that sees all of `box` from above and to the side, filling the picture.
[[nodiscard]] Camera frame(const Box& box, int width, int height, double fov = 40.0);

}  // namespace sdfgrid
