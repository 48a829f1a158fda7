// edit/yaml_checks.h: what every part of a stroke file is checked for, with its line in the
// message. Internal to edit/.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sdfgrid/edit/stroke_file.h"

namespace YAML {  // NOLINT(readability-identifier-naming): theirs
class Node;
}  // namespace YAML

namespace sdfgrid {

// Knows what to call the file. Refusals are Error{input}.
class YamlChecks {
 public:
  explicit YamlChecks(std::string source) : source_(std::move(source)) {}

  // Refuses what no part of a file may hold: keys that are no words or stand twice, aliases that
  // contain themselves or multiply the `length` bytes of text beyond measure, and nodes too deep in
  // each other. To be called first.
  void check_structure(const YAML::Node& root, std::size_t length) const;
  // Warns of the keys of a map which are none of `words`.
  void warn_of_others(const YAML::Node& map, const char* of, const std::vector<std::string>& words);
  void warn(const YAML::Node& at, StrokeWarning::Kind kind, const std::string& text);
  [[noreturn]] void refuse(const YAML::Node& at, const std::string& problem,
                           const std::string& remedy) const;

  // Finite numbers; `what` begins the message.
  [[nodiscard]] double number(const YAML::Node& node, const char* what) const;
  [[nodiscard]] double above_zero(const YAML::Node& node, const char* what) const;
  [[nodiscard]] double share(const YAML::Node& node, const char* what) const;  // in (0, 1]
  // Of a list, or the one that stands in place of it.
  [[nodiscard]] std::vector<double> numbers(const YAML::Node& node, const char* what) const;

  [[nodiscard]] const std::vector<StrokeWarning>& warnings() const { return warnings_; }

 private:
  void check_node(const YAML::Node& node, int depth, std::size_t& left) const;

  std::string source_;
  std::vector<StrokeWarning> warnings_;
};

// "line 12", or "" where that is not known.
[[nodiscard]] std::string place_of(const YAML::Node& node);

}  // namespace sdfgrid
