// From a scene to a document; declared in scene.h. Nodes stand in block style, one a line and
// those under it deeper, what they take in flow style beside them.
#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <span>

#include "sdfgrid/core/atomic_file.h"
#include "sdfgrid/scene/scene.h"

namespace sdfgrid {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      out += fmt::format("\\x{:02x}", byte);
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string text_of(const SceneNumber& number) {
  if (!number.formula.empty()) return quoted(number.formula);
  return std::isinf(number.value) ? ".inf" : fmt::format("{}", number.value);
}

// One number stands alone.
std::string text_of(const std::vector<SceneNumber>& numbers) {
  if (numbers.size() == 1) return text_of(numbers[0]);
  std::string out = "[";
  for (const SceneNumber& number : numbers) {
    out += (out.size() > 1 ? ", " : "") + text_of(number);
  }
  return out + "]";
}

std::string text_of(const std::vector<SceneValue>& values) {
  std::string out = "{";
  for (const SceneValue& value : values) {
    out += fmt::format("{}{}: {}", out.size() > 1 ? ", " : "", value.name,
                       value.is_text ? quoted(value.text) : text_of(value.numbers));
  }
  return out + "}";
}

void write_nodes(const std::vector<SceneNode>& nodes, const std::string& indent, std::string& out);

void write_node(const SceneNode& node, const std::string& indent, std::string& out) {
  auto to = std::back_inserter(out);
  if (node.of.empty()) {
    fmt::format_to(to, "{}- {}: {}\n", indent, node.op, text_of(node.values));
  } else {
    fmt::format_to(to, "{}- {}:\n", indent, node.op);
    for (const SceneValue& value : node.values) {
      fmt::format_to(to, "{}    {}: {}\n", indent, value.name,
                     value.is_text ? quoted(value.text) : text_of(value.numbers));
    }
    fmt::format_to(to, "{}    of:\n", indent);
    write_nodes(node.of, indent + "      ", out);
  }
  const auto line = [&](const char* name, const std::string& value) {
    if (!value.empty()) fmt::format_to(to, "{}  {}: {}\n", indent, name, value);
  };
  const auto numbers = [](const std::vector<SceneNumber>& n) {
    return n.empty() ? std::string() : text_of(n);
  };
  line("name", node.name.empty() ? "" : quoted(node.name));
  line("material", node.material.empty() ? "" : quoted(node.material));
  line("at", numbers(node.at));
  line("rotate", numbers(node.rotate));
  line("scale", numbers(node.scale));
}

void write_nodes(const std::vector<SceneNode>& nodes, const std::string& indent, std::string& out) {
  for (const SceneNode& node : nodes) write_node(node, indent, out);
}

}  // namespace

std::string scene_text(const Scene& scene) {
  std::string out = fmt::format("sdfgrid: {}\n", scene.version);
  auto to = std::back_inserter(out);
  if (!scene.camera.empty()) fmt::format_to(to, "camera: {}\n", text_of(scene.camera));
  if (!scene.materials.empty()) out += "materials:\n";
  for (const SceneMaterial& material : scene.materials) {
    fmt::format_to(to, "  {}: {}\n", quoted(material.name), text_of(material.values));
  }
  out += scene.nodes.empty() ? "scene: []\n" : "scene:\n";
  write_nodes(scene.nodes, "  ", out);
  return out;
}

void write_scene(const Scene& scene, const std::string& path) {
  const std::string text = scene_text(scene);
  write_bytes_atomically(path, std::as_bytes(std::span(text)));
}

}  // namespace sdfgrid
