#include "sdfgrid/scene/build.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "sdfgrid/core/error.h"
#include "sdfgrid/field/formula.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/grid/paint.h"
#include "sdfgrid/mesh/read.h"
#include "sdfgrid/scene/files.h"
#include "sdfgrid/scene/words.h"
#include "sdfgrid/trace/atlas_seen.h"
#include "sdfgrid/trace/grid_sampler.h"

namespace sdfgrid {
namespace {

class SceneBuilder {
 public:
  SceneBuilder(const Scene& scene, const std::string& file, double time, const Job& job)
      : scene_(scene), file_(file), time_(time), job_(job) {}

  SceneModel build() {
    for (const SceneMaterial& material : scene_.materials) {
      tags_[material.name] = add_material(read_material(material), material.name);
    }
    read_camera();
    do {
      endless_.clear();
      std::vector<Field> nodes = fields(scene_.nodes);
      if (!nodes.empty()) model_.field = make_field("union", {}, nodes);
    } while (widen_bands());
    if (!endless_.empty()) model_.endless = endless_.front();
    return std::move(model_);
  }

 private:
  // A file as a leaf.
  struct Sampled {
    std::shared_ptr<const Sampler> sampler;
    std::string path;
    int dim = 0;       // of a mesh; 0 for a grid
    double width = 3;  // of a mesh's band, voxels
    int tag = -1;      // of what is not painted, if the grid says how that looks
  };

  // Where offsets, blends and such look beyond the band of a mesh, drops its grid and asks for a
  // wider one; returns whether it did. Throws Error{input} for a grid.
  bool widen_bands() {
    bool any = false;
    for (const SamplerUse& use : model_.field.sampler_uses()) {
      const double inside = use.sampler->reach_inside();
      const double outside = use.sampler->reach_outside();
      if (-use.lo <= inside && use.hi <= outside) continue;
      const double times = std::max(-use.lo / inside, use.hi / outside);
      const auto found = std::find_if(samplers_.begin(), samplers_.end(), [&](const auto& known) {
        return known.second.sampler.get() == use.sampler;
      });
      Sampled& sampled = found->second;
      if (sampled.dim == 0) {
        throw input_error(
            file_, "",
            fmt::format("an offset, shell, blend or displacement looks {:.4g} inwards and {:.4g} "
                        "outwards of the surface of {}, whose distances end at {:.4g} and {:.4g}",
                        std::fabs(use.lo), use.hi, sampled.path, inside, outside),
            fmt::format("convert its mesh again, with a band {:.1f} times as wide (--width)",
                        std::ceil(10.5 * times) / 10));
      }
      sampled.width = std::ceil(1.05 * sampled.width * times) + 1;
      sampled.sampler.reset();
      any = true;
    }
    return any;
  }

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
    throw input_error(file_, "",
                      fmt::format("`{}` must be a number from {} to {}", value.name, lo, hi),
                      "give one");
  }
  [[nodiscard]] glm::dvec3 three(const SceneValue& value) const {
    const std::vector<double> v = numbers(value.numbers);
    if (v.size() == 1) return glm::dvec3(v[0]);
    if (v.size() == 3) return {v[0], v[1], v[2]};
    throw input_error(file_, "", fmt::format("`{}` has {} numbers", value.name, v.size()),
                      "give three");
  }

  [[nodiscard]] glm::vec3 color(const SceneValue& value) const {
    const glm::dvec3 v = three(value);
    if (v.x >= 0 && v.y >= 0 && v.z >= 0) return glm::vec3(v);
    throw input_error(file_, "", fmt::format("`{}` must not be negative", value.name),
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
      throw input_error(file_, "", "`camera` has `eye` and `target` at the same point",
                        "move one of them");
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
      throw input_error(file_, fmt::format("line {}{}", node.place.line, name), e.what(), "");
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

  // One a file, however often it is named.
  const Sampled& sampled(const SceneNode& node) {
    const bool mesh = node.op == "mesh";
    std::string name;
    int dim = kMeshDim;
    for (const SceneValue& value : node.values) {
      if (value.name == "file") name = value.text;
      if (value.name == "dim") dim = static_cast<int>(one(value, 2, 4096));
    }
    if (name.empty()) throw Error(ErrorKind::input, node.op + ": `file` is missing");
    const std::string path = beside(name);
    Sampled& known = samplers_[fmt::format("{} {}", mesh ? dim : 0, path)];
    if (known.sampler != nullptr) return known;
    known.path = path;
    known.dim = mesh ? dim : 0;
    const Grid grid = mesh ? convert(known) : read_grid(path);
    std::map<int, int> tags = paint_tags(grid);
    known.tag = tags.contains(0) ? tags[0] : -1;
    tags.erase(0);
    known.sampler = make_sampler(grid, job_, tags);
    model_.has_grids = true;
    return known;
  }

  int add_material(const Material& material, const std::string& name) {
    model_.materials.push_back(material);
    model_.names.push_back(name);
    return static_cast<int>(model_.materials.size()) - 1;
  }

  // The materials that a grid is painted with: the scene's of that number, or else as a grid alone
  // shows them. 0, what is not painted, is among them if the grid says how that looks.
  std::map<int, int> paint_tags(const Grid& grid) {
    const std::map<int, PaintLook> looks = paint_looks(grid);
    std::map<int, int> tags;
    if (looks.contains(0)) tags[0] = tag_of(looks.at(0));
    for (const auto& [material, count] : paint_counts(grid)) {
      const std::string number = std::to_string(material);
      const auto named = tags_.find(number);
      const auto look = looks.find(material);
      if (named != tags_.end()) {
        tags[material] = named->second;
      } else if (look != looks.end()) {
        tags[material] = tag_of(look->second);
      } else {
        const Material shown = paint_look(material);
        tags[material] = tag_of({shown.diffuse, shown.specular, shown.exponent, number});
      }
    }
    return tags;
  }

  // Grids that say the same share it.
  int tag_of(const PaintLook& look) {
    for (const auto& [known, tag] : looks_) {
      if (known == look) return tag;
    }
    return looks_.emplace_back(look, add_material(paint_look(0, look), look.name)).second;
  }

  void warn(const std::string& text) {
    std::vector<std::string>& all = model_.warnings;
    if (std::find(all.begin(), all.end(), text) == all.end()) all.push_back(text);
  }

  Grid convert(const Sampled& from) {
    const MeshFile mesh = read_mesh(from.path, job_);
    for (const std::string& warning : mesh.warnings) warn(warning);
    ConvertOptions options;
    options.dim = from.dim;
    options.band = {from.width, from.width};
    Conversion made = convert_mesh(mesh.soup, options, job_);
    for (const std::string& warning : made.warnings) warn(warning);
    return made.grid;
  }

  const Scene& scene_;
  const std::string& file_;
  double time_;
  const Job& job_;
  SceneModel model_;
  std::map<std::string, int> tags_;               // of the scene's own materials
  std::vector<std::pair<PaintLook, int>> looks_;  // of grids, with their tags
  std::map<std::string, Sampled> samplers_;       // by dim and path
  std::vector<EndlessNode> endless_;
};

}  // namespace

SceneModel build_scene(const Scene& scene, const std::string& file, double time, const Job& job) {
  return SceneBuilder(scene, file, time, job).build();
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
