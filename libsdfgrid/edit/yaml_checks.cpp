#include "sdfgrid/edit/yaml_checks.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/stroke_words.h"

namespace sdfgrid {

std::string place_of(const YAML::Node& node) {
  return node.Mark().is_null() ? "" : fmt::format("line {}", node.Mark().line + 1);
}

void YamlChecks::refuse(const YAML::Node& at, const std::string& problem,
                        const std::string& remedy) const {
  throw input_error(source_, place_of(at), problem, remedy);
}

void YamlChecks::warn(const YAML::Node& at, StrokeWarning::Kind kind, const std::string& text) {
  warnings_.push_back({kind, fmt::format("{}: {}: {}", source_, place_of(at), text)});
}

void YamlChecks::check_structure(const YAML::Node& root, std::size_t length) const {
  constexpr std::size_t kCopies = 16;  // of all that is written, by aliases
  std::size_t left = kCopies * (length + 64);
  check_node(root, 0, left);
}

void YamlChecks::check_node(const YAML::Node& node, int depth, std::size_t& left) const {
  constexpr int kDeepest = 100;
  if (depth > kDeepest) {
    refuse(node, fmt::format("it is nested more than {} levels deep", kDeepest),
           "write it flatter, and no alias within what it names");
  }
  if (left-- == 0) refuse(node, "its aliases multiply the file beyond measure", "use fewer");
  if (node.IsSequence()) {
    for (const YAML::Node& item : node) check_node(item, depth + 1, left);
  }
  if (!node.IsMap()) return;
  std::set<std::string> seen;
  for (const auto& item : node) {
    if (!item.first.IsScalar()) {
      refuse(item.first.Mark().is_null() ? node : item.first, "a key must be a word",
             "check the braces");
    }
    if (!seen.insert(item.first.Scalar()).second) {
      refuse(item.first, fmt::format("'{}' stands twice", item.first.Scalar()), "leave one out");
    }
    check_node(item.second, depth + 1, left);
  }
}

void YamlChecks::warn_of_others(const YAML::Node& map, const char* of,
                                const std::vector<std::string>& words) {
  for (const auto& item : map) {
    const std::string& word = item.first.Scalar();
    if (std::find(words.begin(), words.end(), word) != words.end()) continue;
    warn(item.first, StrokeWarning::Kind::unknown_word,
         fmt::format("'{}' is no word of {} and was left out; {}there are {}", word, of,
                     meant(word, words), joined(words)));
  }
}

double YamlChecks::number(const YAML::Node& node, const char* what) const {
  double value = 0;
  try {
    value = node.as<double>();
  } catch (const YAML::Exception&) {
    refuse(node, fmt::format("{} is not a number", what), "write it as in 0.25");
  }
  if (std::isfinite(value)) return value;
  refuse(node, fmt::format("{} is {:g}", what, value), "write a finite number, as in 0.25");
}

double YamlChecks::above_zero(const YAML::Node& node, const char* what) const {
  const double value = number(node, what);
  if (value > 0) return value;
  refuse(node, fmt::format("{} must be above zero; it is {:g}", what, value),
         "write it as in 0.25");
}

double YamlChecks::share(const YAML::Node& node, const char* what) const {
  const double value = number(node, what);
  if (value > 0 && value <= 1) return value;
  refuse(node, fmt::format("{} must be above 0 and at most 1; it is {:g}", what, value),
         "write it as in 0.5");
}

std::vector<double> YamlChecks::numbers(const YAML::Node& node, const char* what) const {
  std::vector<double> all;
  if (!node.IsSequence()) return {number(node, what)};
  for (const YAML::Node& item : node) all.push_back(number(item, what));
  return all;
}

}  // namespace sdfgrid
