#include "sdfgrid/edit/stroke_file.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/field_brush.h"
#include "sdfgrid/edit/stroke_words.h"
#include "sdfgrid/edit/yaml_checks.h"
#include "sdfgrid/grid/paint.h"

namespace sdfgrid {
namespace {

// Reads one file's strokes; knows what to call it in messages.
class Reader : public YamlChecks {
 public:
  Reader(std::string source, StampSource stamps)
      : YamlChecks(std::move(source)), stamps_(std::move(stamps)) {}

  Stroke stroke(const YAML::Node& node);

 private:
  void op(const YAML::Node& node, Stroke& stroke) const;
  Brush brush(const YAML::Node& node);
  Field field(const YAML::Node& node, bool& exact);
  Stamp stamp(const YAML::Node& node) const;
  template <class Make>
  auto made_of(const YAML::Node& node, const Make& make) const;
  Argument argument(const std::string& name, const YAML::Node& node) const;
  int material(const YAML::Node& node) const;
  std::vector<PathPoint> path(const YAML::Node& node) const;
  std::vector<MirrorPlane> mirror(const YAML::Node& node) const;
  MirrorPlane plane(const YAML::Node& word, double at) const;

  StampSource stamps_;
  std::vector<Stamp> used_;  // of the stroke that is read
};

void Reader::op(const YAML::Node& node, Stroke& stroke) const {
  const std::string given = node.IsScalar() ? node.Scalar() : "";
  for (int i = 0; i <= static_cast<int>(StrokeOp::paint); ++i) {
    stroke.op = static_cast<StrokeOp>(i);
    if (given == stroke_op_word(stroke.op)) return;
  }
  stroke.op = StrokeOp::unite;
  stroke.at_points = given == kStampWord;
  if (stroke.at_points) return;
  const std::vector<std::string> words = words_of_op();
  refuse(node, fmt::format("no stroke does '{}'", given),
         fmt::format("{}use one of {}", meant(given, words), joined(words)));
}

Argument Reader::argument(const std::string& name, const YAML::Node& node) const {
  if (node.IsSequence()) {
    std::vector<double> values;
    for (const YAML::Node& item : node) {
      const std::vector<double> more = numbers(item, name.c_str());
      values.insert(values.end(), more.begin(), more.end());
    }
    return {name, values};
  }
  if (!node.IsScalar()) {
    refuse(node, fmt::format("'{}' has no value", name), "give it a number, a list or a text");
  }
  try {
    (void)node.as<double>();
  } catch (const YAML::Exception&) {
    return {name, node.Scalar()};
  }
  return {name, number(node, name.c_str())};
}

bool is_stamp(const YAML::Node& node) {
  return node.IsMap() && node.size() == 1 && (node["grid"] || node["scene"]);
}

// {grid: {file: NAME}} or {scene: {file: NAME}}.
Stamp Reader::stamp(const YAML::Node& node) const {
  Stamp stamp;
  const auto kind = node.begin()->first.as<std::string>();
  stamp.kind = kind == "grid" ? Stamp::Kind::grid : Stamp::Kind::scene;
  const YAML::Node body = node.begin()->second;
  const YAML::Node file = body.IsMap() ? body["file"] : YAML::Node();
  if (!file || !file.IsScalar() || body.size() != 1) {
    refuse(node, fmt::format("a {} has a file and nothing else", kind),
           fmt::format("as in {{{}: {{file: name.{}}}}}; turn, move and scale it by {{rotate: "
                       "{{by: [0, 90, 0], of: ...}}}} and the like",
                       kind, kind == "grid" ? "vdb" : "yaml"));
  }
  if (stamps_.maker == nullptr) refuse(node, "stamps cannot be read here", "use another brush");
  stamp.file = (std::filesystem::path(stamps_.folder) / file.Scalar()).string();
  stamp.kept = stamps_.kept;
  return stamp;
}

// What `make` makes of a stamp; if the stamp is refused, with the stroke's place, too.
template <class Make>
auto Reader::made_of(const YAML::Node& node, const Make& make) const {
  try {
    return make();
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::input) throw;
    refuse(node, fmt::format("the stamp '{}' cannot be used", used_.back().file), e.what());
  }
}

// {OP: {PARAMETER: VALUE, ..., of: NODE or [NODE, ...]}} or {OP: [NODE, ...]}.
Field Reader::field(const YAML::Node& node, bool& exact) {
  if (!node.IsMap() || node.size() != 1) {
    refuse(node, "a brush is one op with its parameters", "as in {sphere: {radius: 0.05}}");
  }
  if (is_stamp(node)) {
    exact = false;
    used_.push_back(stamp(node));
    return made_of(node, [&] { return stamps_.maker->field(used_.back()); });
  }
  const auto word = node.begin()->first.as<std::string>();
  const YAML::Node body = node.begin()->second;
  const OpEntry* entry = find_op(word);
  if (entry == nullptr) {
    refuse(node, fmt::format("no brush is called '{}'", word),
           meant(word, words_of_brush()) +
               "use sphere, box, capsule, torus, cylinder, cone, union, ... (docs/sculpting.md)");
  }
  if (entry->info->guarantee != OpGuarantee::exact || entry->info->role == OpRole::combination) {
    exact = false;
  }
  std::vector<Argument> arguments;
  std::vector<Field> of;
  const auto add_nodes = [&](const YAML::Node& nodes) {
    if (nodes.IsSequence()) {
      for (const YAML::Node& item : nodes) of.push_back(field(item, exact));
    } else {
      of.push_back(field(nodes, exact));
    }
  };
  if (body.IsSequence()) {
    add_nodes(body);
  } else if (body.IsScalar()) {
    refuse(body, fmt::format("{} has parameters, not one value", word),
           "as in {sphere: {radius: 0.05}}");
  } else if (body.IsMap()) {
    for (const auto& item : body) {
      const auto name = item.first.as<std::string>();
      if (name == "of") {
        add_nodes(item.second);
      } else {
        arguments.push_back(argument(name, item.second));
      }
    }
  }
  try {
    return make_field(word, arguments, of);
  } catch (const Error& e) {
    refuse(node, e.what(), "see docs/sculpting.md");
  }
}

// A ball is swept exactly along its path, so it does not become a field; nor does a grid alone,
// whose samples say more.
Brush Reader::brush(const YAML::Node& node) {
  Brush brush;
  if (node.IsMap() && node.size() == 1 && node["sphere"]) {
    const YAML::Node body = node["sphere"];
    if (!body.IsMap() || !body["radius"]) {
      const bool other = body.IsMap() && body.size() > 0;
      refuse(node, "the sphere has no radius",
             (other ? meant(body.begin()->first.Scalar(), {"radius"}) : "") +
                 "write it as in {sphere: {radius: 0.05}}");
    }
    brush.radius = above_zero(body["radius"], "the radius");
    warn_of_others(body, "a sphere", {"radius"});
    return brush;
  }
  if (is_stamp(node)) {
    used_ = {stamp(node)};
    brush.shape = made_of(node, [&] { return stamps_.maker->brush(used_.front()); });
    return brush;
  }
  bool exact = true;
  const Field made = field(node, exact);
  try {
    brush.shape = make_brush(made, exact);
  } catch (const Error& e) {
    refuse(node, e.what(), "give the brush another shape");
  }
  return brush;
}

int Reader::material(const YAML::Node& node) const {
  const double value = number(node, "material");
  if (value == std::floor(value) && value >= 0 && value <= kMostMaterial) {
    return static_cast<int>(value);
  }
  refuse(node, fmt::format("there is no material {:g}", value),
         fmt::format("use a whole number from 0 (no paint) to {}", kMostMaterial));
}

std::vector<PathPoint> Reader::path(const YAML::Node& node) const {
  std::vector<PathPoint> path;
  if (!node.IsSequence()) refuse(node, "the path is no list", "as in [[0, 0, 1], [0.2, 0, 1]]");
  for (const YAML::Node& item : node) {
    const std::vector<double> values = numbers(item, "a number of the path");
    if (values.size() != 3 && values.size() != 4) {
      refuse(item, fmt::format("a point of the path has {} numbers", values.size()),
             "give x, y, z and, if you like, the pressure");
    }
    path.push_back({{values[0], values[1], values[2]},
                    values.size() == 4 ? share(item[3], "the pressure") : 1.0});
  }
  if (path.empty()) refuse(node, "the path has no points", "give it one, as in [[0, 0, 1]]");
  return path;
}

MirrorPlane Reader::plane(const YAML::Node& word, double at) const {
  const std::string axis = word.IsScalar() ? word.Scalar() : "";
  if (axis != "x" && axis != "y" && axis != "z") {
    refuse(word, fmt::format("'{}' is no axis to mirror", axis), "use x, y or z");
  }
  return {axis[0] - 'x', at};
}

// [x, {z: 0.5}]: the planes x = 0 and z = 0.5.
std::vector<MirrorPlane> Reader::mirror(const YAML::Node& node) const {
  std::vector<MirrorPlane> planes;
  if (!node.IsSequence()) refuse(node, "mirror is no list", "as in [x] or [{x: 0.5}]");
  for (const YAML::Node& item : node) {
    const bool placed = item.IsMap() && item.size() == 1;
    const MirrorPlane next =
        placed ? plane(item.begin()->first, number(item.begin()->second, "the mirror's place"))
               : plane(item, 0);
    for (const MirrorPlane& before : planes) {
      if (before.axis != next.axis || before.at != next.at) continue;
      refuse(item, fmt::format("the mirror {} = {:g} stands twice", "xyz"[next.axis], next.at),
             "leave one out");
    }
    planes.push_back(next);
  }
  return planes;
}

std::string text_of(const YAML::Node& node) {
  YAML::Emitter out;
  out.SetMapFormat(YAML::Flow);
  out.SetSeqFormat(YAML::Flow);
  YAML::Node flow = YAML::Clone(node);
  flow.SetStyle(YAML::EmitterStyle::Flow);
  out << flow;
  std::string text = out.c_str();
  // The emitter breaks long lines; a record of a journal is one.
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

Stroke Reader::stroke(const YAML::Node& node) {
  if (!node.IsMap()) refuse(node, "a stroke is a map", "as in {op: union, brush: ..., path: ...}");
  for (const char* needed : {"op", "brush", "path"}) {
    if (!node[needed]) refuse(node, fmt::format("the stroke has no {}", needed), "add it");
  }
  warn_of_others(node, "a stroke", words_of_stroke());
  Stroke s;
  used_.clear();
  for (const auto& item : node) {
    const auto word = item.first.as<std::string>();
    const YAML::Node& value = item.second;
    if (word == "op") {
      op(value, s);
    } else if (word == "brush") {
      s.brush = brush(value);
    } else if (word == "path") {
      s.path = path(value);
    } else if (word == "spacing") {
      s.spacing = above_zero(value, "the spacing");
    } else if (word == "smooth") {
      s.smooth = number(value, "the width of the blend");
      if (s.smooth < 0) refuse(value, "the width of the blend is negative", "0 is a sharp edge");
    } else if (word == "strength") {
      s.strength = share(value, "the strength");
    } else if (word == "material") {
      s.material = material(value);
    } else if (word == "mirror") {
      s.mirror = mirror(value);
    }
  }
  for (const auto& item : node) {
    const std::string why = why_unused(s, item.first.Scalar());
    if (why.empty()) continue;
    warn(item.first, StrokeWarning::Kind::no_effect,
         fmt::format("'{}' does nothing here: {}", item.first.Scalar(), why));
  }
  if (s.op == StrokeOp::paint && !node["material"]) {
    refuse(node, "paint has no material", "add it, as in material: 2; 0 takes paint away");
  }
  if (s.at_points && used_.empty()) {
    refuse(node["brush"], "a stamp's brush is a grid or a scene", "as in {grid: {file: name.vdb}}");
  }
  s.stamps = used_;
  s.text = text_of(node);
  s.line = node.Mark().is_null() ? 0 : node.Mark().line + 1;
  return s;
}

// In the order in which a Reader finds them.
void rename_stamps(YAML::Node node, const std::vector<std::string>& files, std::size_t& next) {
  if (is_stamp(node)) {
    node.begin()->second["file"] = files.at(next++);
  } else if (node.IsSequence()) {
    for (const YAML::Node& item : node) rename_stamps(item, files, next);
  } else if (node.IsMap()) {
    for (const auto& item : node) rename_stamps(item.second, files, next);
  }
}

YAML::Node load(const std::string& text, const std::string& source) {
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1) {
      throw input_error(source, place_of(documents[1]), "a second document begins here",
                        "write one, without '---' between");
    }
    return documents.empty() ? YAML::Node() : documents[0];
  } catch (const YAML::Exception& e) {
    throw input_error(source, e.mark.is_null() ? "" : fmt::format("line {}", e.mark.line + 1),
                      e.msg, "mend the YAML there");
  }
}

}  // namespace

StrokeFile parse_strokes(const std::string& text, const std::string& source,
                         const StampSource& stamps) {
  const YAML::Node root = load(text, source);
  Reader reader(source, stamps);
  reader.check_structure(root, text.size());
  if (!root.IsMap() || !root["sdfgrid-strokes"]) {
    throw input_error(source, "line 1", "this is no stroke file",
                      "begin it with 'sdfgrid-strokes: 1'");
  }
  if (root["sdfgrid-strokes"].Scalar() != "1") {
    throw input_error(source, place_of(root["sdfgrid-strokes"]),
                      "it is of a version that this program does not know", "use version 1");
  }
  reader.warn_of_others(root, "a stroke file", {"sdfgrid-strokes", "strokes"});
  const YAML::Node strokes = root["strokes"];
  if (!strokes || !strokes.IsSequence()) {
    const std::string there =
        reader.warnings().empty() ? "" : " (" + reader.warnings()[0].text + ")";
    throw input_error(source, strokes ? place_of(strokes) : "line 1",
                      "it has no list of strokes" + there, "add 'strokes:' and a list");
  }
  StrokeFile file;
  for (const YAML::Node& node : strokes) file.strokes.push_back(reader.stroke(node));
  file.warnings = reader.warnings();
  return file;
}

StrokeFile read_strokes(const std::string& path, StampMaker* stamps) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw input_error(path, "", "it cannot be read", "check the path");
  std::stringstream text;
  text << in.rdbuf();
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return parse_strokes(text.str(), path, {stamps, folder, false});
}

Stroke parse_stroke(const std::string& text, const std::string& source, const StampSource& stamps) {
  const YAML::Node node = load(text, source);
  Reader reader(source, stamps);
  reader.check_structure(node, text.size());
  return reader.stroke(node);
}

std::string with_stamp_files(const std::string& text, const std::vector<std::string>& files) {
  YAML::Node node = load(text, "stroke");
  std::size_t next = 0;
  rename_stamps(node["brush"], files, next);
  return text_of(node);
}

}  // namespace sdfgrid
