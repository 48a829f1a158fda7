#include "sdfgrid/edit/stroke_file.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/field_brush.h"

namespace sdfgrid {
namespace {

std::string place_of(const YAML::Node& node) {
  return node.Mark().is_null() ? "" : fmt::format("line {}", node.Mark().line + 1);
}

// Reads one file's strokes; knows what to call it in messages.
class Reader {
 public:
  explicit Reader(std::string source) : source_(std::move(source)) {}

  Stroke stroke(const YAML::Node& node);
  std::vector<std::string> warnings;

  [[noreturn]] void refuse(const YAML::Node& node, const std::string& problem,
                           const std::string& remedy) const {
    throw input_error(source_, place_of(node), problem, remedy);
  }

 private:
  double number(const YAML::Node& node, const char* what) const;
  std::vector<double> numbers(const YAML::Node& node, const char* what) const;
  StrokeOp op(const YAML::Node& node) const;
  Brush brush(const YAML::Node& node) const;
  Field field(const YAML::Node& node, bool& exact) const;
  Argument argument(const std::string& name, const YAML::Node& node) const;
  std::vector<PathPoint> path(const YAML::Node& node) const;
  std::vector<MirrorPlane> mirror(const YAML::Node& node) const;
  MirrorPlane plane(const YAML::Node& word, double at) const;

  std::string source_;
};

double Reader::number(const YAML::Node& node, const char* what) const {
  try {
    return node.as<double>();
  } catch (const YAML::Exception&) {
    refuse(node, fmt::format("{} is not a number", what), "write it as in 0.25");
  }
}

std::vector<double> Reader::numbers(const YAML::Node& node, const char* what) const {
  std::vector<double> all;
  if (!node.IsSequence()) return {number(node, what)};
  for (const YAML::Node& item : node) all.push_back(number(item, what));
  return all;
}

StrokeOp Reader::op(const YAML::Node& node) const {
  std::string words;
  for (int i = 0; i <= static_cast<int>(StrokeOp::pinch); ++i) {
    const auto candidate = static_cast<StrokeOp>(i);
    if (node.IsScalar() && node.Scalar() == stroke_op_word(candidate)) return candidate;
    words += fmt::format("{}{}", i == 0 ? "" : ", ", stroke_op_word(candidate));
  }
  const std::string given = node.IsScalar() ? node.Scalar() : "";
  refuse(node, fmt::format("no stroke does '{}'", given), "use one of " + words);
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
  try {
    return {name, node.as<double>()};
  } catch (const YAML::Exception&) {
    return {name, node.Scalar()};
  }
}

// {OP: {PARAMETER: VALUE, ..., of: NODE or [NODE, ...]}} or {OP: [NODE, ...]}.
Field Reader::field(const YAML::Node& node, bool& exact) const {
  if (!node.IsMap() || node.size() != 1) {
    refuse(node, "a brush is one op with its parameters", "as in {sphere: {radius: 0.05}}");
  }
  const auto word = node.begin()->first.as<std::string>();
  const YAML::Node body = node.begin()->second;
  const OpEntry* entry = find_op(word);
  if (entry == nullptr) {
    refuse(node, fmt::format("no brush is called '{}'", word),
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

// A ball is swept exactly along its path, so it does not become a field.
Brush Reader::brush(const YAML::Node& node) const {
  Brush brush;
  if (node.IsMap() && node.size() == 1 && node["sphere"]) {
    const YAML::Node radius = node["sphere"]["radius"];
    if (!radius) refuse(node, "the sphere has no radius", "as in {sphere: {radius: 0.05}}");
    brush.radius = number(radius, "radius");
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

std::vector<PathPoint> Reader::path(const YAML::Node& node) const {
  std::vector<PathPoint> path;
  if (!node.IsSequence()) refuse(node, "the path is no list", "as in [[0, 0, 1], [0.2, 0, 1]]");
  for (const YAML::Node& item : node) {
    const std::vector<double> values = numbers(item, "a coordinate");
    if (values.size() != 3 && values.size() != 4) {
      refuse(item, fmt::format("a point of the path has {} numbers", values.size()),
             "give x, y, z and, if you like, the pressure");
    }
    path.push_back({{values[0], values[1], values[2]}, values.size() == 4 ? values[3] : 1.0});
  }
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
    if (item.IsMap() && item.size() == 1) {
      planes.push_back(
          plane(item.begin()->first, number(item.begin()->second, "the mirror's place")));
    } else {
      planes.push_back(plane(item, 0));
    }
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
  Stroke s;
  for (const auto& item : node) {
    const auto word = item.first.as<std::string>();
    const YAML::Node& value = item.second;
    if (word == "op") {
      s.op = op(value);
    } else if (word == "brush") {
      s.brush = brush(value);
    } else if (word == "path") {
      s.path = path(value);
    } else if (word == "spacing") {
      s.spacing = number(value, "spacing");
    } else if (word == "smooth") {
      s.smooth = number(value, "smooth");
    } else if (word == "strength") {
      s.strength = number(value, "strength");
    } else if (word == "mirror") {
      s.mirror = mirror(value);
    } else if (word != "name") {
      warnings.push_back(fmt::format(
          "{}: {}: '{}' is no word of a stroke and was left out; there are op, brush, path, "
          "spacing, smooth, strength, mirror and name",
          source_, place_of(item.first), word));
    }
  }
  s.text = text_of(node);
  return s;
}

YAML::Node load(const std::string& text, const std::string& source) {
  try {
    return YAML::Load(text);
  } catch (const YAML::Exception& e) {
    throw input_error(source, e.mark.is_null() ? "" : fmt::format("line {}", e.mark.line + 1),
                      e.msg, "mend the YAML there");
  }
}

}  // namespace

StrokeFile parse_strokes(const std::string& text, const std::string& source) {
  const YAML::Node root = load(text, source);
  if (!root.IsMap() || !root["sdfgrid-strokes"]) {
    throw input_error(source, "line 1", "this is no stroke file",
                      "begin it with 'sdfgrid-strokes: 1'");
  }
  if (root["sdfgrid-strokes"].Scalar() != "1") {
    throw input_error(source, place_of(root["sdfgrid-strokes"]),
                      "it is of a version that this program does not know", "use version 1");
  }
  const YAML::Node strokes = root["strokes"];
  if (!strokes || !strokes.IsSequence()) {
    throw input_error(source, "", "it has no list of strokes", "add 'strokes:' and a list");
  }
  Reader reader(source);
  StrokeFile file;
  for (const YAML::Node& node : strokes) file.strokes.push_back(reader.stroke(node));
  file.warnings = reader.warnings;
  return file;
}

StrokeFile read_strokes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw input_error(path, "", "it cannot be read", "check the path");
  std::stringstream text;
  text << in.rdbuf();
  return parse_strokes(text.str(), path);
}

Stroke parse_stroke(const std::string& text, const std::string& source) {
  return Reader(source).stroke(load(text, source));
}

}  // namespace sdfgrid
