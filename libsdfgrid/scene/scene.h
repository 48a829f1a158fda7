// scene/scene.h: a scene as its file says it: nodes of ops with places and materials, a camera, a
// time. Files are YAML or JSON (docs/shapes.md has the words); build.h makes fields of scenes.
//
// A scene keeps formulas as they were written and knows no defaults, so that it can be saved as it
// was loaded. Scenes are values; two are equal if they say the same, wherever it stands.
#pragma once

#include <string>
#include <vector>

namespace sdfgrid {

// A number of a scene: a value, or a formula of t (the time of the frame), then not empty.
struct SceneNumber {
  double value = 0;
  std::string formula;
  bool operator==(const SceneNumber&) const = default;
};

// Where something stands in the file, for messages; not part of what a scene says.
struct ScenePlace {
  int line = 0;  // both count from 1
  int column = 0;
  bool operator==(const ScenePlace&) const { return true; }
};

// A named value: numbers, or a text where `is_text`.
struct SceneValue {
  std::string name;
  std::vector<SceneNumber> numbers;
  std::string text;
  bool is_text = false;
  ScenePlace place{};  // of the value itself
  bool operator==(const SceneValue&) const = default;
};

struct SceneNode {
  std::string op;                  // a word of op_list(), `grid` or `mesh`
  std::vector<SceneValue> values;  // its parameters that are given
  std::vector<SceneNode> of;
  std::vector<SceneNumber> at;      // three, or none
  std::vector<SceneNumber> rotate;  // three, degrees about x, then y, then z, or none
  std::vector<SceneNumber> scale;   // one or three, or none
  std::string material;             // its name, "" for that of the node around it
  std::string name;
  ScenePlace place;
  bool operator==(const SceneNode&) const = default;
};

struct SceneMaterial {
  std::string name;
  std::vector<SceneValue> values;  // diffuse, specular, exponent
  bool operator==(const SceneMaterial&) const = default;
};

// The format that this library knows whole.
inline constexpr double kSceneVersion = 1;

struct Scene {
  // Of the format, as the file says. What is read of a newer one is what this library knows of it;
  // it is saved as of the newer one still, so that its words keep the meaning that they have there.
  double version = kSceneVersion;
  std::vector<SceneValue> camera;  // eye, target, up, fov: those that are given
  std::vector<SceneMaterial> materials;
  std::vector<SceneNode> nodes;  // their union
};

[[nodiscard]] inline bool operator==(const Scene& a, const Scene& b) {
  return a.version == b.version && a.camera == b.camera && a.materials == b.materials &&
         a.nodes == b.nodes;
}

struct SceneFile {
  Scene scene;
  std::vector<std::string> warnings;  // of words that were not understood and left out
};

// Throws Error{input} with line and column for what is no scene: broken YAML or JSON, aliases
// that multiply it beyond measure, nodes nested too deep, numbers and words in wrong places.
[[nodiscard]] SceneFile read_scene(const std::string& path);
// The same from a text; `file` is its name in messages.
[[nodiscard]] SceneFile parse_scene(const std::string& text, const std::string& file);
inline constexpr std::size_t kMaxSceneBytes = 256U << 20U;
inline constexpr int kMaxSceneNesting = 100;  // of nodes

// A scene as YAML; parse_scene() makes an equal scene of it.
[[nodiscard]] std::string scene_text(const Scene& scene);
// Writes it; the file appears whole or not at all. Throws Error{failed}.
void write_scene(const Scene& scene, const std::string& path);

// The extensions that scene files have, lower case with the dot.
[[nodiscard]] const std::vector<std::string>& scene_extensions();

}  // namespace sdfgrid
