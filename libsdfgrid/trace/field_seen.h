// trace/field_seen.h: an analytic field with materials as what a picture shows.
#pragma once

#include <vector>

#include "sdfgrid/trace/field_trace.h"
#include "sdfgrid/trace/shade.h"

namespace sdfgrid {

class SeenField : public Seen {
 public:
  // Field::tag_at() is the place of a surface's material, whose index becomes that plus one;
  // `other` is that of surfaces without.
  // Keeps a reference to the tracer.
  SeenField(const FieldTracer& tracer, std::vector<Material> materials, const Material& other,
            double tolerance);

  void trace(std::span<const Ray> rays, std::span<float> depth) const override;
  void describe(std::span<const glm::dvec3> points, std::span<glm::vec3> normals,
                std::span<Material> materials) const override;

 private:
  const FieldTracer& tracer_;
  std::vector<Material> materials_;
  Material other_;
  double tolerance_;
};

}  // namespace sdfgrid
