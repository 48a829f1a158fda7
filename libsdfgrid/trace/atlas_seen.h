// trace/atlas_seen.h: the surface of a grid's atlas, painted or of one material, as what a picture
// shows.
#pragma once

#include <optional>

#include "sdfgrid/grid/grid.h"
#include "sdfgrid/trace/shade.h"

namespace sdfgrid {

// The look of a painted material, 1 and up; they repeat after eight. Its index is the material's.
[[nodiscard]] Material paint_look(int material);

class SeenAtlas : public Seen {
 public:
  // `material` is that of what is not painted. Keeps references to both.
  SeenAtlas(const Atlas& atlas, const Material& material) : atlas_(atlas), material_(material) {}
  // With the paint of the atlas's grid.
  SeenAtlas(const Atlas& atlas, const Material& material, const Grid& painted)
      : atlas_(atlas), material_(material), painted_(painted) {}

  void trace(std::span<const Ray> rays, std::span<float> depth) const override;
  void describe(std::span<const glm::dvec3> points, std::span<glm::vec3> normals,
                std::span<Material> materials) const override;

 private:
  const Atlas& atlas_;
  const Material& material_;
  std::optional<Grid> painted_;
};

}  // namespace sdfgrid
