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

// Up to which values, world units and both positive, the scene's field is to say how far away the
// surface is, for who looks at more than the surface itself.
struct SceneReach {
  double inside = 0;
  double outside = 0;
};

// A grid of a scene whose distances end before the reach that was asked for.
struct ShortBand {
  std::string file;
  int line = 0;      // of a node that names it
  double share = 0;  // of that reach, within which the scene's field is right
  double width = 0;  // voxels of the band that its mesh would have to be converted with
};

struct SceneModel {
  Field field;  // tag_at() gives the index of a surface's material, or -1
  std::vector<Material> materials;
  std::vector<std::string> names;  // of the materials: in the file, or of a grid's paint
  SceneCamera camera;
  bool has_grids = false;              // or meshes, whose fields are cut off at the end of a band
  std::optional<EndlessNode> endless;  // the first one
  std::vector<ShortBand> short_bands;
  std::vector<std::string> warnings;  // of the meshes that were converted

  // Returns its tag.
  int add_material(const Material& material, const std::string& name);
};

// The scene at `time`. Files that it names are relative to the folder of `file`, which is also its
// name in messages. Meshes are converted with bands as wide as the scene and `reach` need. Throws
// Error{input} with the node's line for parameters out of range, fields without a bound (with the
// op's name and the remedy), files that cannot be read or are of another kind, and grids whose band
// the scene itself needs wider.
[[nodiscard]] SceneModel build_scene(const Scene& scene, const std::string& file, double time,
                                     const Job& job, const SceneReach& reach = {});

// For what needs a scene with an end. Throws Error{input} that names the node, its line in `file`
// and the remedy.
void check_has_end(const SceneModel& scene, const std::string& file);

}  // namespace sdfgrid
