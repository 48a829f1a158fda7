// trace/shader.h: the colours of many rays at once, whose hits are known; internal to trace/.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sdfgrid/trace/shade.h"
#include "sdfgrid/trace/visibility.h"

namespace sdfgrid {

// A ray of the picture: the place in pixels that it goes through, and its hit.
struct Sample {
  double x, y;
  float depth;  // world units; +inf where nothing is hit
};

class Shader {
 public:
  Shader(const Seen& seen, const Atlas& atlas, const Surroundings& surroundings,
         const Camera& camera, const Look& look);

  // Colours and, unless they are empty, normals and indices of materials of the samples. Safe to
  // call from many threads.
  void operator()(std::span<const Sample> samples, std::span<glm::vec3> colors,
                  std::span<glm::vec3> normals, std::span<int> indices) const;

 private:
  struct Points;  // where light arrives, as the visibility kernel wants it
  enum class Kind { background, floor, surface };

  void set_up_light();
  void set_up_cones();
  void set_up_floor(const std::vector<glm::vec3>& points);
  Kind locate(const Ray& ray, float depth, glm::dvec3& world) const;
  void describe(std::span<const Kind> kinds, std::span<const glm::dvec3> worlds,
                std::span<glm::vec3> normals, std::span<Material> materials) const;
  [[nodiscard]] glm::vec3 background(double y) const;
  [[nodiscard]] glm::vec3 ambient(const glm::vec3& normal) const;
  [[nodiscard]] glm::vec3 surface_color(const Material& material, const glm::vec3& normal,
                                        const glm::vec3& to_eye, float sun, float sky) const;
  [[nodiscard]] glm::vec3 floor_shadow(const glm::dvec3& world, float sun, float sky) const;

  const Seen& seen_;
  const Atlas& atlas_;
  const Camera& camera_;
  const Look& look_;
  RayGenerator rays_;
  VisibilityScene scene_{};
  glm::dvec3 up_, right_, back_;  // a right-handed frame of unit vectors; back_ level, to the eye
  glm::vec3 sun_;                 // unit vector towards it
  bool has_floor_ = false;
  double floor_height_ = 0;  // along up_
  glm::dvec3 floor_center_;  // under the object
  double floor_radius_ = 1;  // of the object
};

}  // namespace sdfgrid
