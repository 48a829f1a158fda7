#include "sdfgrid/scene/build.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "sdfgrid/core/error.h"
#include "sdfgrid/field/formula.h"
#include "sdfgrid/scene/files.h"
#include "sdfgrid/scene/sampled_files.h"
#include "sdfgrid/scene/words.h"

namespace sdfgrid {
namespace {

class SceneBuilder {
 public:
  SceneBuilder(const Scene& scene, const std::string& file, double time, const Job& job,
               const SceneReach& reach)
      : scene_(scene), file_(file), time_(time), job_(job), reach_(reach) {}

  SceneModel build() {
    for (const SceneMaterial& material : scene_.materials) {
      tags_[material.name] = model_.add_material(read_material(material), material.name);
    }
    read_camera();
    do {
      endless_.clear();
      std::vector<Field> nodes = fields(scene_.nodes);
      if (!nodes.empty()) model_.field = make_field("union", {}, nodes);
    } while (files_.widen(reach_));
    if (!endless_.empty()) model_.endless = endless_.front();
    return std::move(model_);
  }

 private:
  [[nodiscard]] double number(const SceneNumber& n) const {
    return n.formula.empty() ? n.value : parse_number(n.formula, time_);
  }
  [[nodiscard]] std::vector<double> numbers(const std::vector<SceneNumber>& from) const {
    std::vector<double> to(from.size());
    std::transform(from.begin(), from.end(), to.begin(),
                   [&](const SceneNumber& n) { return number(n); });
    return to;
  }
  [[nodiscard]] double one(const SceneValue& value, double lo, double hi) const {
    const std::vector<double> v = numbers(value.numbers);
    if (v.size() == 1 && v[0] >= lo && v[0] <= hi) return v[0];
    throw input_error(file_, text_of(value.place),
                      fmt::format("`{}` must be a number from {} to {}", value.name, lo, hi),
                      "give one");
  }
  [[nodiscard]] int whole(const SceneValue& value, int lo, int hi) const {
    const std::vector<double> v = numbers(value.numbers);
    if (v.size() == 1 && v[0] >= lo && v[0] <= hi && v[0] == std::floor(v[0])) {
      return static_cast<int>(v[0]);
    }
    const std::string given = v.size() == 1 ? fmt::format("{:g}", v[0]) : "a list";
    throw Error(ErrorKind::input, fmt::format("`{}` is {}; give a whole number from {} to {}",
                                              value.name, given, lo, hi));
  }
  [[nodiscard]] glm::dvec3 three(const SceneValue& value) const {
    const std::vector<double> v = numbers(value.numbers);
    if (v.size() == 1) return glm::dvec3(v[0]);
    if (v.size() == 3) return {v[0], v[1], v[2]};
    throw input_error(file_, text_of(value.place),
                      fmt::format("`{}` has {} numbers", value.name, v.size()), "give three");
  }

  [[nodiscard]] glm::vec3 color(const SceneValue& value) const {
    const glm::dvec3 v = three(value);
    if (v.x >= 0 && v.y >= 0 && v.z >= 0) return glm::vec3(v);
    throw input_error(file_, text_of(value.place),
                      fmt::format("`{}` must not be negative", value.name),
                      "give three numbers from 0 to 1");
  }

  [[nodiscard]] Material read_material(const SceneMaterial& from) const {
    Material to;
    for (const SceneValue& value : from.values) {
      if (value.name == "diffuse") to.diffuse = color(value);
      if (value.name == "specular") to.specular = static_cast<float>(one(value, 0, 1));
      if (value.name == "exponent") to.exponent = static_cast<float>(one(value, 1, 1e5));
    }
    return to;
  }

  void read_camera() {
    for (const SceneValue& value : scene_.camera) {
      if (value.name == "eye") model_.camera.eye = three(value);
      if (value.name == "target") model_.camera.target = three(value);
      if (value.name == "up") model_.camera.up = three(value);
      if (value.name == "fov") model_.camera.fov = one(value, 0.01, 179);
    }
    const SceneCamera& camera = model_.camera;
    if (camera.eye && camera.target && *camera.eye == *camera.target) {
      throw input_error(file_, text_of(scene_.camera.front().place),
                        "`camera` has `eye` and `target` at the same point", "move one of them");
    }
  }

  std::vector<Field> fields(const std::vector<SceneNode>& nodes) {
    std::vector<Field> made;
    made.reserve(nodes.size());
    for (const SceneNode& node : nodes) made.push_back(field(node));
    return made;
  }

  Field field(const SceneNode& node) {
    const std::size_t endless_before = endless_.size();
    const std::vector<Field> of = fields(node.of);
    try {
      Field made = shape(node, of);
      const int tag = node.material.empty() ? own_tag(node) : tags_.at(node.material);
      if (tag >= 0) made = made.tagged(tag);
      const auto placed = [&](const char* op, const std::vector<SceneNumber>& by) {
        if (!by.empty()) made = make_field(op, {{"by", numbers(by)}}, {made});
      };
      placed("scale", node.scale);
      placed("rotate", node.rotate);
      placed("translate", node.at);
      note_end(node, made.bounds(), endless_before);
      return made;
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::input) throw;
      const std::string name = node.name.empty() ? "" : fmt::format(" (`{}`)", node.name);
      throw input_error(file_, text_of(fault_of(node, e.what())) + name, e.what(), "");
    }
  }

  // What is in a node with an end has one; a node without is to blame if none in it is.
  void note_end(const SceneNode& node, const Box& box, std::size_t endless_before) {
    int axis = -1;
    for (int a = 0; a < 3; ++a) {
      if (!std::isfinite(box.lo[a]) || !std::isfinite(box.hi[a])) axis = a;
    }
    if (box.empty() || axis < 0) {
      endless_.resize(endless_before);
    } else if (endless_.size() == endless_before) {
      endless_.push_back({node.op, node.place.line, axis});
    }
  }

  static std::string text_of(const ScenePlace& place) {
    return fmt::format("line {}, column {}", place.line, place.column);
  }

  // Where a node is wrong: at the value that the message names, if it names one that is given.
  static ScenePlace fault_of(const SceneNode& node, const std::string& message) {
    for (const SceneValue& value : node.values) {
      const bool named = message.find("`" + value.name + "`") != std::string::npos;
      if (named && value.place.line > 0) return value.place;
    }
    return node.place;
  }

  Field shape(const SceneNode& node, const std::vector<Field>& of) {
    if (is_file(node)) return make_field(sampled(node).sampler);
    std::vector<Argument> arguments;
    for (const SceneValue& value : node.values) {
      if (value.name == "file") {
        add_file(node.op, beside(value.text), arguments);
      } else if (value.is_text) {
        arguments.emplace_back(value.name, value.text);
      } else {
        arguments.emplace_back(value.name, numbers(value.numbers));
      }
    }
    add_time(node.op, arguments);
    return make_field(node.op, arguments, of);
  }

  static bool is_file(const SceneNode& node) { return node.op == "grid" || node.op == "mesh"; }

  // What a grid says of its own look.
  int own_tag(const SceneNode& node) { return is_file(node) ? sampled(node).tag : -1; }

  // Formulas of position know the time of the frame, unless the node says another.
  void add_time(const std::string& op, std::vector<Argument>& arguments) const {
    const OpEntry* entry = find_op(op);
    if (entry == nullptr) return;
    const auto takes = [](const Parameter& p) { return std::string_view(p.name) == "t"; };
    const auto given = [](const Argument& a) { return a.name == "t"; };
    if (std::any_of(entry->parameters.begin(), entry->parameters.end(), takes) &&
        std::none_of(arguments.begin(), arguments.end(), given)) {
      arguments.emplace_back("t", time_);
    }
  }

  // A file that is named is relative to the scene.
  [[nodiscard]] std::string beside(const std::string& name) const {
    return (std::filesystem::path(file_).parent_path() / name).string();
  }

  // What an op's file holds, as the arguments that stand for it.
  void add_file(const std::string& op, const std::string& path,
                std::vector<Argument>& arguments) const {
    if (op == "points") {
      std::vector<double> numbers;
      for (const glm::dvec3& p : read_points(path, job_)) {
        numbers.insert(numbers.end(), {p.x, p.y, p.z});
      }
      arguments.emplace_back("points", std::move(numbers));
    } else {
      Heights heights = read_heights(path);
      arguments.emplace_back("width", heights.width);
      arguments.emplace_back("samples", std::move(heights.samples));
    }
  }

  const SampledFile& sampled(const SceneNode& node) {
    std::string name;
    int dim = node.op == "mesh" ? kMeshDim : 0;
    for (const SceneValue& value : node.values) {
      if (value.name == "file") name = value.text;
      if (value.name == "dim") dim = whole(value, 2, 4096);
    }
    if (name.empty()) throw Error(ErrorKind::input, node.op + ": `file` is missing");
    return files_.get(beside(name), name, dim, node.place.line);
  }

  const Scene& scene_;
  const std::string& file_;
  double time_;
  const Job& job_;
  SceneReach reach_;
  SceneModel model_;
  std::map<std::string, int> tags_;  // of the scene's own materials
  SampledFiles files_{file_, tags_, model_, job_};
  std::vector<EndlessNode> endless_;
};

}  // namespace

int SceneModel::add_material(const Material& material, const std::string& name) {
  materials.push_back(material);
  names.push_back(name);
  return static_cast<int>(materials.size()) - 1;
}

SceneModel build_scene(const Scene& scene, const std::string& file, double time, const Job& job,
                       const SceneReach& reach) {
  return SceneBuilder(scene, file, time, job, reach).build();
}

void check_has_end(const SceneModel& scene, const std::string& file) {
  if (!scene.endless) return;
  const auto& [op, line, axis] = *scene.endless;
  throw input_error(
      file, fmt::format("line {}", line),
      fmt::format("`{}` has no end along {}, nor has what stands around it", op, "xyz"[axis]),
      "intersect it with a box");
}

}  // namespace sdfgrid
