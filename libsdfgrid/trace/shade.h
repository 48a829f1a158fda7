// trace/shade.h: from first hits to colours. Linear light throughout: one key light (the sun) with
// a soft shadow, a sky above and a glow from below that the object itself occludes, Phong's
// reflection, a plain studio background with a floor that shows nothing but the object's shadow.
// Silhouettes and creases, and only they, are sampled more than once a pixel.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/atlas.h"
#include "sdfgrid/trace/camera.h"
#include "sdfgrid/trace/far_field.h"
#include "sdfgrid/trace/trace.h"

namespace sdfgrid {

// Phong (1975), with diffuse + specular at most 1 for a material that does not glow.
struct Material {
  glm::vec3 diffuse{0.62F, 0.51F, 0.41F};
  float specular = 0.12F;
  float exponent = 28;
  int index = 0;  // what tells it from others: pixels between two of them are smoothed, too
};

// Light, in the units of the picture: 1 is a display's white.
struct Lighting {
  glm::vec3 sun{1.08F, 1.00F, 0.88F};  // irradiance on a surface facing it, over pi
  double sun_turn = -52;   // degrees about `up` from the camera's side, + is to the right
  double sun_height = 48;  // degrees above the horizon
  double sun_radius = 7;   // degrees; larger is softer
  glm::vec3 sky{0.40F, 0.44F, 0.50F};    // the same from straight above
  glm::vec3 glow{0.17F, 0.155F, 0.14F};  // and from straight below
};

struct Look {
  Material material;
  Lighting lighting;
  glm::vec3 background_top{0.62F, 0.66F, 0.71F};
  glm::vec3 background_bottom{0.80F, 0.80F, 0.79F};
  bool floor = true;  // whether the object's shadow falls on a plane under its lowest point
  int samples = 8;    // rays for a pixel with a silhouette or a crease in it; 1 for no antialiasing
};

// Row by row from the upper left corner.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<glm::vec3> color;   // linear light
  std::vector<glm::vec3> normal;  // at pixel centres; 0 where nothing is hit
  std::vector<int> material;      // Material::index there; 0 where nothing is hit
  std::size_t refined = 0;        // pixels that took more samples
};

// What surrounds a point of the surface, beyond what the atlas knows; make it once for an atlas.
// make_surroundings() throws Error{failed} if the atlas has more than 2.9 million bricks (8.6 GB).
struct Surroundings {
  FarField far;
  std::vector<glm::vec3> points;  // surface_points()
};
[[nodiscard]] Surroundings make_surroundings(const Atlas& atlas, const Job& job);

// What is seen, where that is not the surface of the atlas itself: a field of which the atlas is a
// coarse copy. Then the atlas tells only where light gets to. Called from many threads.
class Seen {
 public:
  Seen() = default;
  Seen(const Seen&) = delete;
  Seen& operator=(const Seen&) = delete;
  virtual ~Seen() = default;
  // Distance to the first hit of each ray, +inf if there is none.
  virtual void trace(std::span<const Ray> rays, std::span<float> depth) const = 0;
  // Outward unit normals and materials at points of the surface.
  virtual void describe(std::span<const glm::dvec3> points, std::span<glm::vec3> normals,
                        std::span<Material> materials) const = 0;
};

// Shades the hits that trace_primary(atlas, camera) found. The floor lies square to camera.up.
// Throws Error{usage} if look.samples is not in [1, 256] or the hits are not of the camera's size.
[[nodiscard]] Picture shade(const Atlas& atlas, const Surroundings& surroundings,
                            const Camera& camera, const HitBuffer& hits, const Look& look,
                            const Job& job);
// The same for the hits of something else.
[[nodiscard]] Picture shade(const Seen& seen, const Atlas& atlas, const Surroundings& surroundings,
                            const Camera& camera, const HitBuffer& hits, const Look& look,
                            const Job& job);

}  // namespace sdfgrid
