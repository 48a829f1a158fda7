// scene/paint_scene.h: a scene's materials as the paint of a grid that was made of it.
#pragma once

#include <map>
#include <string>

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/scene/build.h"

namespace sdfgrid {

struct ScenePaint {
  std::map<int, std::string> materials;  // that the grid is painted with: number and name
  int too_many = 0;                      // materials for which there was no number
};

// Paints the samples of `grid`, which was made of the scene's field, with the material of the
// surface that decides the field there, and says in the grid what each looks like
// (grid/paint.h). A material called "7" is number 7, the others take the numbers that are free in
// the order of the scene. If all surfaces have one material there is no paint: the grid says only
// how it looks. Nothing is said of surfaces without a material.
ScenePaint paint_scene(const SceneModel& scene, Grid& grid, const Job& job);

// Whether surfaces of the scene may differ in their materials.
[[nodiscard]] bool has_several_materials(const SceneModel& scene);

}  // namespace sdfgrid
