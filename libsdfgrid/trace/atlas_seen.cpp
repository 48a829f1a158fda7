#include "sdfgrid/trace/atlas_seen.h"

#include <limits>

namespace sdfgrid {

Material paint_look(int material) {
  constexpr int kColors = 8;
  static const glm::vec3 diffuse[kColors] = {{0.76F, 0.74F, 0.69F},     // porcelain
                                             {0.60F, 0.10F, 0.05F},     // vermilion
                                             {0.05F, 0.13F, 0.36F},     // indigo
                                             {0.72F, 0.42F, 0.08F},     // gold
                                             {0.14F, 0.32F, 0.09F},     // moss
                                             {0.04F, 0.34F, 0.36F},     // teal
                                             {0.30F, 0.07F, 0.24F},     // plum
                                             {0.045F, 0.045F, 0.05F}};  // charcoal
  Material look;
  look.diffuse = diffuse[(material - 1) % kColors];
  look.index = material;
  return look;
}

Material paint_look(int material, const PaintLook& look) {
  return {look.diffuse, look.specular, look.exponent, material};
}

SeenAtlas::SeenAtlas(const Atlas& atlas, const Material& material, const Grid& painted)
    : atlas_(atlas), material_(material), painted_(painted) {
  for (const auto& [number, look] : paint_looks(painted)) {
    (number == 0 ? material_ : looks_[number]) = paint_look(number, look);
  }
}

void SeenAtlas::trace(std::span<const Ray> rays, std::span<float> depth) const {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto hit = trace_ray(atlas_, rays[i]);
    depth[i] = hit ? static_cast<float>(*hit) : std::numeric_limits<float>::infinity();
  }
}

void SeenAtlas::describe(std::span<const glm::dvec3> points, std::span<glm::vec3> normals,
                         std::span<Material> materials) const {
  for (std::size_t i = 0; i < points.size(); ++i) {
    normals[i] = normal_at(atlas_, points[i]);
    materials[i] = material_;
  }
  if (!painted_) return;
  const PaintReader paint(*painted_);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int material = paint.at(points[i]);
    const auto look = looks_.find(material);
    if (look != looks_.end()) {
      materials[i] = look->second;
    } else if (material > 0) {
      materials[i] = paint_look(material);
    }
  }
}

}  // namespace sdfgrid
