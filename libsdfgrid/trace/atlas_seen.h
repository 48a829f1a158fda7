// trace/atlas_seen.h: the surface of a grid's atlas, painted or of one material, as what a picture
// shows.
#pragma once

#include <map>
#include <optional>

#include "sdfgrid/grid/grid.h"
#include "sdfgrid/grid/paint.h"
#include "sdfgrid/trace/shade.h"

namespace sdfgrid {

// The look of a painted material, 1 and up, where the grid does not say it; they repeat after
// eight. Its index is the material's.
[[nodiscard]] Material paint_look(int material);
// The look that a grid says.
[[nodiscard]] Material paint_look(int material, const PaintLook& look);

class SeenAtlas : public Seen {
 public:
  // `material` is that of what is not painted. Keeps a reference to the atlas.
  SeenAtlas(const Atlas& atlas, const Material& material) : atlas_(atlas), material_(material) {}
  // With the paint of the atlas's grid, and the looks that it says.
  SeenAtlas(const Atlas& atlas, const Material& material, const Grid& painted);

  void trace(std::span<const Ray> rays, std::span<float> depth) const override;
  void describe(std::span<const glm::dvec3> points, std::span<glm::vec3> normals,
                std::span<Material> materials) const override;

 private:
  const Atlas& atlas_;
  Material material_;
  std::optional<Grid> painted_;
  std::map<int, Material> looks_;  // of materials, where the grid says it
};

}  // namespace sdfgrid
