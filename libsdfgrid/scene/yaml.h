// scene/yaml.h: a YAML (or JSON) document as a flat tree with lines and columns (internal to
// scene/). yaml-cpp stands behind it, in yaml.cpp alone.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sdfgrid {

struct YamlNode {
  enum class Kind : std::uint8_t { null, scalar, list, map };
  Kind kind = Kind::null;
  bool quoted = false;  // a scalar between quotes
  int line = 0;         // both count from 1
  int column = 0;
  std::string text;                  // of a scalar
  std::vector<std::uint32_t> items;  // of a list; of a map key, value, key, value, ...
};

struct YamlTree {
  // The first is the root. An alias is one more reference to the node that it names.
  std::vector<YamlNode> nodes;
  [[nodiscard]] const YamlNode& root() const { return nodes.front(); }
};

inline constexpr int kMaxYamlDepth = 400;

// Throws Error{input} with line and column for what is not YAML, for more than one document, nodes
// nested deeper than kMaxYamlDepth, a key that stands twice in a map, and for aliases that contain
// themselves or multiply a document beyond measure. `file` is for the message.
[[nodiscard]] YamlTree parse_yaml(const std::string& text, const std::string& file);

}  // namespace sdfgrid
