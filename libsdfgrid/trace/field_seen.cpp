#include "sdfgrid/trace/field_seen.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace sdfgrid {

namespace {

// At a kink, where a point of a box's face is to all digits, the gradient may vanish: beside it, it
// does not.
glm::vec3 normal_of(const Field& field, const glm::dvec3& p) {
  const glm::dvec3 beside = 1e-6 * (glm::length(p) + 1e-3) * glm::dvec3(0.55, 0.61, 0.57);
  for (const glm::dvec3& at : {p, p + beside, p - beside}) {
    const glm::dvec3 gradient = field.gradient(at).gradient;
    const double length = glm::length(gradient);
    if (length > 1e-9) return glm::vec3(gradient / length);
  }
  return glm::vec3(0.0F);
}

}  // namespace

SeenField::SeenField(const FieldTracer& tracer, std::vector<Material> materials,
                     const Material& other, double tolerance)
    : tracer_(tracer), materials_(std::move(materials)), other_(other), tolerance_(tolerance) {
  for (std::size_t i = 0; i < materials_.size(); ++i) materials_[i].index = static_cast<int>(i) + 1;
}

void SeenField::trace(std::span<const Ray> rays, std::span<float> depth) const {
  tracer_.trace(rays, tolerance_, depth, {});
}

void SeenField::describe(std::span<const glm::dvec3> points, std::span<glm::vec3> normals,
                         std::span<Material> materials) const {
  // Neighbours in a row are near each other: what is left of the program there is short. Among
  // many objects they need not be, and one point finds its own soon.
  constexpr std::size_t kLong = 256;  // instructions
  const std::size_t group = tracer_.field().size() > kLong ? 1 : 32;
  for (std::size_t first = 0; first < points.size(); first += group) {
    const std::size_t end = std::min(first + group, points.size());
    Box box;
    for (std::size_t i = first; i < end; ++i) box.add(points[i]);
    const glm::dvec3 slack(2e-6 * (glm::length(box.lo) + glm::length(box.hi) + 1e-3));
    const Field here = tracer_.field().pruned({box.lo - slack, box.hi + slack});
    for (std::size_t i = first; i < end; ++i) {
      normals[i] = normal_of(here, points[i]);
      const int tag = here.tag_at(points[i]);
      const bool known = tag >= 0 && tag < static_cast<int>(materials_.size());
      materials[i] = known ? materials_[static_cast<std::size_t>(tag)] : other_;
    }
  }
}

}  // namespace sdfgrid
