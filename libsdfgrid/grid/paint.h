// grid/paint.h: paint: a material index for each sample near the surface of a grid, 0 for what is
// not painted. It stands in a grid of its own beside the distances, in memory and in the file
// (`material`, 32-bit integers, active where painted); a grid without paint has none.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <string>

#include "sdfgrid/grid/grid.h"

namespace sdfgrid {

inline constexpr const char* kPaintName = "material";
inline constexpr int kMostMaterial = 255;

[[nodiscard]] bool has_paint(const Grid& grid);

// How many samples each material has that is painted; empty for a grid without paint.
[[nodiscard]] std::map<int, std::size_t> paint_counts(const Grid& grid);

// What a material of a grid looks like, in its metadata `sdfgrid:material-N`: its colour, how much
// it shines and how sharply (trace/shade.h, Material), and what it is called.
struct PaintLook {
  glm::vec3 diffuse{0.0F};
  float specular = 0;
  float exponent = 1;
  std::string name;
  bool operator==(const PaintLook&) const = default;
};
// Of `material`, 0 for what is not painted.
void set_paint_look(Grid& grid, int material, const PaintLook& look);
// Those that the grid says; what cannot be understood is left out.
[[nodiscard]] std::map<int, PaintLook> paint_looks(const Grid& grid);

// Looks materials up. One object serves one thread, and none beside one who paints.
class PaintReader {
 public:
  explicit PaintReader(const Grid& grid);
  PaintReader(const PaintReader&) = delete;
  PaintReader& operator=(const PaintReader&) = delete;
  ~PaintReader();

  // The material at a world point: of the eight samples around it that which has most trilinear
  // weight, of equals the least.
  [[nodiscard]] int at(const glm::dvec3& world) const;

 private:
  struct Access;
  Grid grid_;
  std::unique_ptr<Access> access_;  // null for a grid without paint
};

}  // namespace sdfgrid
