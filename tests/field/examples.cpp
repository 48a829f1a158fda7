#include "field/examples.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <stdexcept>

#include "field/file_leaves.h"
#include "sdfgrid/field/formula.h"

using sdfgrid::Argument;
using sdfgrid::Box;
using sdfgrid::Field;

namespace {

// A value of flow-style YAML: a scalar, a list or a map in order.
struct Value {
  std::string scalar;
  std::vector<Value> list;
  std::vector<std::pair<std::string, Value>> map;
  bool is_list = false;
};

class Reader {
 public:
  explicit Reader(const std::string& text) : text_(text) {}

  // The body of a map without its braces, to the end or a closing one.
  Value map() {
    Value v;
    do {
      const std::string key = scalar();
      expect(':');
      v.map.emplace_back(key, value());
    } while (take(','));
    return v;
  }
  void end() {
    skip();
    if (at_ != text_.size()) throw std::runtime_error("left over: " + text_.substr(at_));
  }

 private:
  void skip() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }
  bool take(char c) {
    skip();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!take(c)) throw std::runtime_error(std::string("no ") + c + ": " + text_.substr(at_));
  }
  std::string scalar() {
    skip();
    if (take('"')) {
      const std::size_t end = text_.find('"', at_);
      const std::string s = text_.substr(at_, end - at_);
      at_ = end + 1;
      return s;
    }
    const std::size_t end = text_.find_first_of(":,[]{}", at_);
    const std::string s = text_.substr(at_, end - at_);
    at_ = end == std::string::npos ? text_.size() : end;
    return s;
  }
  Value value() {
    if (take('{')) {
      if (take('}')) return {};
      Value v = map();
      expect('}');
      return v;
    }
    if (!take('[')) {
      Value v;
      v.scalar = scalar();
      return v;
    }
    Value v;
    v.is_list = true;
    do {
      v.list.push_back(value());
    } while (take(','));
    expect(']');
    return v;
  }

  const std::string& text_;
  std::size_t at_ = 0;
};

void numbers(const Value& v, std::vector<double>& out) {
  if (v.is_list) {
    for (const Value& each : v.list) numbers(each, out);
  } else {
    out.push_back(std::stod(v.scalar));
  }
}

ExampleNode node_of(const std::string& word, const Value& v);

ExampleNode node_of(const Value& v) {
  if (v.map.size() != 1) throw std::runtime_error("a node is one word");
  return node_of(v.map[0].first, v.map[0].second);
}

std::vector<ExampleNode> nodes_of(const Value& v) {
  std::vector<ExampleNode> of;
  if (!v.is_list) return {node_of(v)};
  for (const Value& each : v.list) of.push_back(node_of(each));
  return of;
}

bool is_number(const std::string& s) {
  char* end = nullptr;
  std::strtod(s.c_str(), &end);
  return !s.empty() && *end == 0;
}

ExampleNode node_of(const std::string& word, const Value& v) {
  if (v.is_list) return {word, {}, nodes_of(v)};
  ExampleNode node{word, {}, {}};
  for (const auto& [key, each] : v.map) {
    if (key == "of") {
      node.of = nodes_of(each);
    } else if (each.is_list || is_number(each.scalar)) {
      std::vector<double> list;
      numbers(each, list);
      node.arguments.emplace_back(key, list);
    } else {
      node.arguments.emplace_back(key, each.scalar);
    }
  }
  return node;
}

}  // namespace

ExampleNode read_node(const std::string& text) {
  Reader reader(text);
  const Value v = reader.map();
  reader.end();
  return node_of(v);
}

Field make_field(const ExampleNode& node) {
  std::vector<Field> of;
  for (const ExampleNode& each : node.of) of.push_back(make_field(each));
  return sdfgrid::make_field(node.word, node.arguments, of);
}

Field read_example(const std::string& text) { return make_field(read_node(text)); }

namespace {

// Forms of ops that their own examples do not show.
const char* const kForms[] = {
    "function: {f: \"0.6\", mode: revolve_z}",
    "function: {f: \"0.6 - 0.4*x\", mode: revolve_x}",
    "function: {f: \"0.3 + 0.5*x^2\", mode: revolve_z, from: -0.8}",
    "function: {f: \"1 - x^2\", mode: revolve_x}",
    "function: {f: \"0.5 - x*x + 0.2*x\", mode: extrude}",
    "function: {f: \"0.3*x\", mode: extrude, depth: 0.7}",
    "function: {f: \"0.5 + x + 0.01*x^2\", mode: revolve_z, from: 0}",
    "function: {f: \"0.3*exp(x)\", mode: revolve_x}",
    "function: {f: \"sqrt(1 - x^2)\", mode: revolve_z}",
    "function: {f: \"x^3 - 0.5*x\", mode: extrude, floor: -0.7}",
    "function: {f: \"0.2 + abs(x)\", mode: extrude, depth: 0.7}",
    "function: {f: \"0.4*sin(7*x)\", mode: revolve_x}",
    "function: {f: \"0.5 + 0.2*floor(3*x)\", mode: revolve_z}",
    "bezier: {points: [[-1, 0, 0], [-0.5, 2, 0.5], [0.5, -2, 0], [1, 0, 0.3]], radius: 0.1}",
    "bezier: {points: [[0, 0, 0], [0.5, 0.05, 0], [1.2, 0, 0]], radius: 0.2}",
    R"(points: {radius: 0.25, points: [[-0.52, 0.09, -0.26], [0.21, 0.25, -0.87], [-0.97, 0.67,
       -0.48], [-0.53, 0.99, -0.06], [0.67, -0.05, 0.28], [-0.70, 0.27, 0.74], [0.05, 0.48,
       0.34], [-0.87, 0.52, 0.18], [-0.40, -0.94, 0.73], [-0.05, 0.44, 0.76], [0.43, 0.84,
       -0.21], [0.60, -0.11, 0.87], [0.76, -0.81, -0.73], [-0.57, 0.93, -0.13], [0.25, -0.40,
       0.01], [-0.23, -0.30, 0.17], [0.17, 0.81, 0.36], [0.86, 0.71, 0.98], [0.34, -0.67,
       0.72], [0.93, 0.81, 0.14], [0.43, -0.58, 0.66], [0.15, -0.43, -0.87], [0.71, 0.98,
       -0.82], [0.60, -0.18, -0.70]]})",
    "complement: {of: {box: {size: [2, 1.4, 1]}}}",
    "shell: {thickness: 0.3, of: {torus: {major: 1, minor: 0.4}}}",
    "repeat: {cell: [1.3, 1.6, 0], of: {capsule: {from: [-0.2, 0.3, 0], to: [0.3, 0, 1], radius: "
    "0.2}}}",
    "gdf: {solid: dodecahedron, exponent: inf}",
    "gdf: {solid: tetrahedron, exponent: 3}",
    "gdf: {solid: cube, exponent: 1}",
    "gdf: {solid: octahedron, exponent: 200}",
    "gdf: {solid: icosahedron, exponent: 8}",
    "gdf: {solid: truncated_tetrahedron, exponent: 1000000}",
    "gdf: {solid: truncated_cube, exponent: 20}",
    "gdf: {solid: truncated_octahedron, exponent: 1.5}",
    "gdf: {solid: truncated_dodecahedron, exponent: 900}",
    "gdf: {solid: truncated_icosahedron, exponent: 1000000}",
    "metaballs: {points: [[-0.5, 0, 0], [0.5, 0.1, 0]], falloff: linear}",
    "metaballs: {points: [[-0.5, 0, 0], [0.5, 0.1, 0]], falloff: squared}",
    "metaballs: {points: [[-0.5, 0, 0], [0.5, 0.1, 0]], falloff: cubed}",
    "metaballs: {points: [[-0.5, 0, 0], [0.5, 0.1, 0]], falloff: gaussian}",
    "metaballs: {points: [[-0.5, 0, 0], [0.5, 0.1, 0]], falloff: quadratic}",
    "metaballs: {count: 9, seed: 4, radii: 0.7, size: 1}",
    "blend: {radii: 0.5, power: 1, of: [{box: {size: [2, 2, 0.4]}}, {sphere: {radius: 0.6}}]}",
    "pnorm_union: {p: 2, of: [{box: {size: [2, 2, 0.4]}}, {sphere: {radius: 0.6}}]}",
    "pnorm_intersection: {p: 3, of: [{box: {size: [1.7, 1.7, 1.7]}}, {sphere: {radius: 1}}]}",
    "pnorm_difference: {p: 3, of: [{box: {size: [1.6, 1.6, 1.6]}}, {sphere: {radius: 0.9}}]}",
    R"(texture_displace: {width: 3, samples: [0, 1, 0.2, 0.7, 0, 1], size: [1, 0.7], around: 0.8,
       amplitude: -0.2, of: {cylinder: {radius: 0.8, height: 1.5}}})",
};

Example form(const std::string& text) {
  const std::string word = text.substr(0, text.find(':'));
  const bool cubic = word == "bezier" && std::count(text.begin(), text.end(), '[') == 5;
  const sdfgrid::OpEntry* op = sdfgrid::find_op(word);
  const bool estimate = op->info->guarantee == sdfgrid::OpGuarantee::estimate ||
                        text.find("order: ") != std::string::npos;
  const ExampleNode node = read_node(text);
  return {op, node, make_field(node), text, word == "points" || cubic, estimate};
}

// A surface across the box that is made of the function's values.
std::string formula_calling(const sdfgrid::FormulaFunction& f) {
  const std::string name(f.name);
  const bool any = f.most > 2;
  const char* const two = any ? ", 0.5 + 0.4*y" : ", 1.5 + 0.4*y";
  const char* const middle = any ? ", 0.5" : ", 1.5";
  const double level = sdfgrid::parse_number(name + "(0.5" + (f.least > 1 ? middle : "") + ")");
  return name + "(0.5 + 0.4*x" + (f.least > 1 ? two : "") + ") + 0.5*z - " + std::to_string(level);
}

}  // namespace

std::vector<std::string> example_formulas() {
  std::vector<std::string> all;
  for (const sdfgrid::FormulaFunction& f : sdfgrid::formula_functions()) {
    all.push_back(formula_calling(f));
  }
  for (const char* text :
       {"x^2 + y^2 + z^2 - 0.7", "sqrt(x^2 + y^2 + z^2) - 0.8", "sqrt(4*x^2 + (y + z)^2) - 0.5",
        "(sqrt(x^2 + y^2) - 0.7)^2 + z^2 - 0.04", "abs(x)^2.5 + y^2 + z^2 - 0.8",
        "(x + 1.5)^1.5 - 2*y*z - 1.5", "max(x*y, min(abs(z) - 0.3, sin(3*x)))",
        "exp(-x^2) * cos(2*y) - z^3", "(x + 2)^y - 1 + z", "(x + 2)^-2 - 0.3 + z"}) {
    all.emplace_back(text);
  }
  return all;
}

const std::vector<Example>& examples() {
  static const std::vector<Example> all = [] {
    std::vector<Example> made;
    for (const sdfgrid::OpEntry& op : sdfgrid::op_list()) made.push_back(form(op.info->example));
    for (const char* text : kForms) made.push_back(form(text));
    for (const char* order : {"", ", order: 1", ", order: 2"}) {
      for (const std::string& f : example_formulas()) {
        made.push_back(
            form("formula: {f: \"" + f + "\", bounds: [[-1, -1, -1], [1, 1, 1]]" + order + "}"));
      }
    }
    for (Example& leaf : file_leaves()) made.push_back(std::move(leaf));
    return made;
  }();
  return all;
}

Box example_box(const Field& field) {
  Box box = field.bounds();
  for (int a = 0; a < 3; ++a) {
    box.lo[a] = std::fmax(box.lo[a], -4.0) - 0.7;
    box.hi[a] = std::fmin(box.hi[a], 4.0) + 0.7;
  }
  return box;
}
