// scene/build.h: what a scene shows at a time: a field, the materials of its surfaces, a camera.
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/scene/scene.h"
#include "sdfgrid/trace/shade.h"

namespace sdfgrid {

// What the file says of the camera; the rest is for whoever makes the picture.
struct SceneCamera {
  std::optional<glm::dvec3> eye, target, up;
  std::optional<double> fov;  // degrees, across the picture's height
};

// A node whose solid has no end along an axis, nor anything that stands around it.
struct EndlessNode {
  std::string op;
  int line = 0;
  int axis = 0;
};

struct SceneModel {
  Field field;  // tag_at() gives the index of a surface's material, or -1
  std::vector<Material> materials;
  std::vector<std::string> names;  // of the materials: in the file, or of a grid's paint
  SceneCamera camera;
  bool has_grids = false;              // or meshes, whose fields are cut off at the end of a band
  std::optional<EndlessNode> endless;  // the first one
  std::vector<std::string> warnings;   // of the meshes that were converted
};

// The scene at `time`. Files that it names are relative to the folder of `file`, which is also its
// name in messages. Throws Error{input} with the node's line for parameters out of range, fields
// without a bound (with the op's name and the remedy), files that cannot be read.
[[nodiscard]] SceneModel build_scene(const Scene& scene, const std::string& file, double time,
                                     const Job& job);

// For what needs a scene with an end. Throws Error{input} that names the node, its line in `file`
// and the remedy.
void check_has_end(const SceneModel& scene, const std::string& file);

}  // namespace sdfgrid
