// From a document to a scene; declared in scene.h.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/words.h"
#include "sdfgrid/field/formula.h"
#include "sdfgrid/scene/scene.h"
#include "sdfgrid/scene/words.h"
#include "sdfgrid/scene/yaml.h"

namespace sdfgrid {
namespace {

using Kind = YamlNode::Kind;
using Names = std::vector<std::string>;

const Names kTopWords = {"sdfgrid", "camera", "materials", "scene"};
const NodeWord kCameraWords = {{"eye", "target", "up", "fov"}, {}, true, {}};
const NodeWord kMaterialWords = {{"diffuse", "specular", "exponent"}, {}, true, {}};
constexpr std::string_view kDisplace = "displace";
// Ops that are nothing without their first node, or without any of them.
const Names kOfFirst = {"difference", "smooth_difference"};
const Names kOfAll = {"morph", "spatial_morph", "partition", "blend"};
const Names kPlacing = {"at", "rotate", "scale", "material", "name"};

bool contains(const Names& names, const std::string& word) {
  return std::find(names.begin(), names.end(), word) != names.end();
}

struct Warning {
  int line;
  std::string text;
};

class SceneReader {
 public:
  SceneReader(const std::string& text, const std::string& file)
      : file_(file), tree_(parse_yaml(text, file)) {}

  SceneFile read() {
    const YamlNode& root = tree_.root();
    if (root.kind != Kind::map) {
      refuse(root, "it is no scene", "begin with `sdfgrid: 1` and give it a `scene`");
    }
    read_version(root);
    // Materials first, wherever they stand: nodes name them.
    if (const YamlNode* materials = find(root, "materials")) read_materials(*materials);
    for_keys(root, [&](const YamlNode& key, const YamlNode& value) {
      if (key.text == "camera") {
        result_.scene.camera = read_values(value, "the camera", kCameraWords);
      } else if (key.text == "scene") {
        result_.scene.nodes = read_nodes(value);
      } else if (!contains(kTopWords, key.text)) {
        unknown(key, "a scene", kTopWords);
      }
    });
    if (find(root, "scene") == nullptr) refuse(root, "it has no `scene`", "give it one");
    std::stable_sort(warnings_.begin(), warnings_.end(),
                     [](const Warning& a, const Warning& b) { return a.line < b.line; });
    for (Warning& warning : warnings_) result_.warnings.push_back(std::move(warning.text));
    return std::move(result_);
  }

 private:
  [[noreturn]] void refuse(const YamlNode& at, const std::string& problem,
                           const std::string& remedy) const {
    throw input_error(file_, fmt::format("line {}, column {}", at.line, at.column), problem,
                      remedy);
  }
  void warn(const YamlNode& at, const std::string& text) {
    warnings_.push_back({at.line, fmt::format("{}: line {}: {}", file_, at.line, text)});
  }
  void unknown(const YamlNode& key, const std::string& of, const Names& words) {
    const std::string near = nearest_word(key.text, words);
    warn(key, fmt::format("{} knows no `{}`; {}left out", of, key.text,
                          near.empty() ? "" : fmt::format("did you mean `{}`? ", near)));
  }

  [[nodiscard]] const YamlNode& node(std::uint32_t index) const { return tree_.nodes[index]; }
  [[nodiscard]] const YamlNode* find(const YamlNode& map, std::string_view name) const {
    for (std::size_t i = 0; i + 1 < map.items.size(); i += 2) {
      if (node(map.items[i]).text == name) return &node(map.items[i + 1]);
    }
    return nullptr;
  }
  template <class Visit>
  void for_keys(const YamlNode& map, const Visit& visit) {
    for (std::size_t i = 0; i + 1 < map.items.size(); i += 2) {
      visit(node(map.items[i]), node(map.items[i + 1]));
    }
  }

  void read_version(const YamlNode& root) {
    const YamlNode* version = find(root, "sdfgrid");
    if (version == nullptr) {
      refuse(root, "it does not say that it is a scene", "begin with `sdfgrid: 1`");
    }
    char* end = nullptr;
    const double number = std::strtod(version->text.c_str(), &end);
    if (version->text.empty() || *end != 0 || !(number >= 1 && std::isfinite(number))) {
      refuse(*version, "the format's version is no number from 1 on", "write `sdfgrid: 1`");
    }
    result_.scene.version = number;
    if (number > kSceneVersion) {
      warn(*version, fmt::format("it is of version {} of the format, this program knows {}: what "
                                 "is new is left out",
                                 version->text, kSceneVersion));
    }
  }

  // Infinity, as YAML writes it, only where it is one of a parameter's values.
  SceneNumber read_number(const YamlNode& at, bool endless) const {
    if (at.kind != Kind::scalar || at.text.empty()) {
      refuse(at, "here must stand a number", "give one, or a formula of t in quotes");
    }
    const bool infinite = at.text == ".inf" || at.text == ".Inf" || at.text == ".INF";
    if (infinite && endless) return {std::numeric_limits<double>::infinity(), ""};
    if (infinite) refuse(at, "a number must be finite", "give a finite one");
    char* end = nullptr;
    const double value = std::strtod(at.text.c_str(), &end);
    if (*end == 0) {
      if (!std::isfinite(value)) refuse(at, "a number must be finite", "give a finite one");
      return {value, ""};
    }
    try {
      (void)parse_number(at.text);
    } catch (const Error& e) {
      refuse(at, e.what(), "");
    }
    return {0, at.text};
  }

  // Of lists in lists too: points, planes, matrices.
  void read_numbers(const YamlNode& at, bool endless, std::vector<SceneNumber>& numbers) const {
    if (at.kind != Kind::list) {
      numbers.push_back(read_number(at, endless));
      return;
    }
    for (const std::uint32_t item : at.items) read_numbers(node(item), endless, numbers);
  }

  std::vector<SceneNumber> read_triple(const YamlNode& at, const std::string& name,
                                       bool one_will_do) const {
    std::vector<SceneNumber> numbers;
    read_numbers(at, false, numbers);
    if (numbers.size() != 3 && !(one_will_do && numbers.size() == 1)) {
      refuse(at, fmt::format("`{}` has {} numbers", name, numbers.size()),
             one_will_do ? "give one or three" : "give three");
    }
    return numbers;
  }

  void add_value(const YamlNode& key, const YamlNode& value, const NodeWord& word,
                 std::vector<SceneValue>& values) {
    SceneValue v;
    v.name = key.text;
    v.place = {value.line, value.column};
    v.is_text = contains(word.texts, key.text);
    if (!v.is_text) {
      read_numbers(value, contains(word.endless, key.text), v.numbers);
    } else if (value.kind == Kind::scalar) {
      v.text = value.text;
    } else {
      refuse(value, fmt::format("`{}` must be a word or a text", key.text), "give one");
    }
    values.push_back(std::move(v));
  }

  std::vector<SceneValue> read_values(const YamlNode& map, const std::string& of,
                                      const NodeWord& word) {
    std::vector<SceneValue> values;
    if (map.kind == Kind::null) return values;
    if (map.kind != Kind::map) {
      refuse(map, of + " is given by words with values", "as in {fov: 40}");
    }
    for_keys(map, [&](const YamlNode& key, const YamlNode& value) {
      if (contains(word.numbers, key.text) || contains(word.texts, key.text)) {
        add_value(key, value, word, values);
      } else {
        Names words = word.numbers;
        words.insert(words.end(), word.texts.begin(), word.texts.end());
        unknown(key, of, words);
      }
    });
    return values;
  }

  void read_materials(const YamlNode& at) {
    if (at.kind == Kind::null) return;
    if (at.kind != Kind::map) refuse(at, "materials have names", "as in {clay: {specular: 0.3}}");
    for_keys(at, [&](const YamlNode& key, const YamlNode& value) {
      result_.scene.materials.push_back(
          {key.text, read_values(value, fmt::format("material `{}`", key.text), kMaterialWords)});
      material_names_.push_back(key.text);
    });
  }

  // Which nodes of a list were left out, as none knows their words.
  struct Missing {
    bool any = false;
    bool first = false;
  };

  std::vector<SceneNode> read_nodes(const YamlNode& at) {
    Missing missing;
    return read_nodes(at, missing);
  }
  std::vector<SceneNode> read_nodes(const YamlNode& at, Missing& missing) {
    std::vector<SceneNode> nodes;
    if (at.kind == Kind::null) return nodes;
    if (at.kind == Kind::map) {
      add_node(at, nodes);
    } else if (at.kind == Kind::list) {
      for (const std::uint32_t item : at.items) {
        if (node(item).kind == Kind::null) continue;
        if (node(item).kind != Kind::map) {
          refuse(node(item), "here must stand a node", "as in {sphere: {radius: 1}}");
        }
        const std::size_t before = nodes.size();
        add_node(node(item), nodes);
        if (nodes.size() > before) continue;
        missing.any = true;
        missing.first = missing.first || before == 0;
      }
    } else {
      refuse(at, "here must stand a node or a list of them", "as in {sphere: {radius: 1}}");
    }
    return nodes;
  }

  // `rotate` and `scale` are ops too: then they have a node.
  [[nodiscard]] bool places(const YamlNode& key, const YamlNode& value) const {
    return contains(kPlacing, key.text) &&
           !(value.kind == Kind::map && find(value, "of") != nullptr);
  }

  void add_node(const YamlNode& at, std::vector<SceneNode>& nodes) {
    if (++depth_ > kMaxSceneNesting) {
      refuse(at, fmt::format("nodes are nested more than {} deep", kMaxSceneNesting),
             "flatten lists of unions, join moves");
    }
    SceneNode made;
    made.place = {at.line, at.column};
    const YamlNode* op = nullptr;
    const YamlNode* content = nullptr;
    const std::size_t before = warnings_.size();
    NodeWord word;
    for_keys(at, [&](const YamlNode& key, const YamlNode& value) {
      if (places(key, value)) {
        place_node(key, value, made);
      } else if (key.text != kDisplace && !find_node_word(key.text, word)) {
        Names words = node_words();
        words.insert(words.end(), kPlacing.begin(), kPlacing.end());
        unknown(key, "a node", words);
      } else if (op != nullptr) {
        refuse(key,
               fmt::format("a node is one word, but here stand `{}` and `{}`", op->text, key.text),
               "make a list of two nodes");
      } else {
        op = &key;
        content = &value;
      }
    });
    if (op != nullptr) {
      made.op = op->text == kDisplace ? displacement(*op, *content) : op->text;
      Missing missing;
      read_content(*content, made, missing);
      // Without these the node would be another solid, not less of it.
      const bool lost = contains(kOfAll, made.op) ? missing.any : missing.first;
      if (lost && (contains(kOfAll, made.op) || contains(kOfFirst, made.op))) {
        warn(*op, fmt::format("`{}` is left out with its node", made.op));
      } else {
        nodes.push_back(std::move(made));
      }
    } else if (warnings_.size() == before) {
      refuse(at, "a node without a shape", "name one, as in {sphere: {radius: 1}}");
    }
    --depth_;
  }

  void place_node(const YamlNode& key, const YamlNode& value, SceneNode& made) {
    if (key.text == "at") {
      made.at = read_triple(value, key.text, false);
    } else if (key.text == "rotate") {
      made.rotate = read_triple(value, key.text, false);
    } else if (key.text == "scale") {
      made.scale = read_triple(value, key.text, true);
    } else if (value.kind != Kind::scalar) {
      refuse(value, fmt::format("`{}` must be a word", key.text), "give one");
    } else if (key.text == "name") {
      made.name = value.text;
    } else if (contains(material_names_, value.text)) {
      made.material = value.text;
    } else {
      unknown(value, "the list of materials", material_names_);
    }
  }

  // What stands after the word of a node.
  void read_content(const YamlNode& at, SceneNode& made, Missing& missing) {
    NodeWord word;
    (void)find_node_word(made.op, word);
    if (at.kind == Kind::null) return;
    if (at.kind == Kind::list && !word.leaf) {
      made.of = read_nodes(at, missing);
      return;
    }
    if (at.kind != Kind::map) {
      refuse(at, fmt::format("what `{}` takes has names", made.op),
             word.leaf ? "as in {sphere: {radius: 1}}" : "give a list of nodes, or {of: ...}");
    }
    for_keys(at, [&](const YamlNode& key, const YamlNode& value) {
      if (key.text == "of" && !word.leaf) {
        made.of = read_nodes(value, missing);
      } else if (key.text == "by" && value.kind == Kind::map && made.op.ends_with("_displace")) {
        read_displacement(value, word, made);
      } else if (contains(word.numbers, key.text) || contains(word.texts, key.text)) {
        add_value(key, value, word, made.values);
      } else {
        Names words = word.numbers;
        words.insert(words.end(), word.texts.begin(), word.texts.end());
        if (!word.leaf) words.emplace_back("of");
        unknown(key, fmt::format("`{}`", made.op), words);
      }
    });
  }

  // `displace: {by: {noise: {amplitude: 0.1}}, of: ...}` is another way to write `noise_displace:
  // {amplitude: 0.1, of: ...}`; so are formula and texture.
  std::string displacement(const YamlNode& at, const YamlNode& content) const {
    const YamlNode* by = content.kind == Kind::map ? find(content, "by") : nullptr;
    if (by != nullptr && by->kind == Kind::map && by->items.size() == 2) {
      const std::string word = node(by->items[0]).text + "_displace";
      NodeWord known;
      if (find_node_word(word, known)) return word;
    }
    refuse(by != nullptr ? *by : at, "`displace` does not say by what",
           "as in {displace: {by: {noise: {amplitude: 0.1}}, of: {sphere: {}}}}");
  }
  void read_displacement(const YamlNode& by, const NodeWord& word, SceneNode& made) {
    const auto more = read_values(node(by.items[1]), fmt::format("`{}`", made.op), word);
    made.values.insert(made.values.end(), more.begin(), more.end());
  }

  const std::string& file_;
  YamlTree tree_;
  Names material_names_;
  int depth_ = 0;  // of nodes around the one that is read
  std::vector<Warning> warnings_;
  SceneFile result_;
};

std::string read_text(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    throw input_error(path, "", "no such file", "check the path");
  }
  if (std::filesystem::file_size(path, ignored) > kMaxSceneBytes) {
    throw input_error(path, "", "it is larger than any scene",
                      "put large data into grids, meshes or point files");
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) throw input_error(path, "", "it cannot be read", "check its permissions");
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

SceneFile parse_scene(const std::string& text, const std::string& file) {
  return SceneReader(text, file).read();
}

SceneFile read_scene(const std::string& path) { return parse_scene(read_text(path), path); }

const std::vector<std::string>& scene_extensions() {
  static const std::vector<std::string> extensions = {".yaml", ".yml", ".json"};
  return extensions;
}

}  // namespace sdfgrid
