#include "sdfgrid/scene/yaml.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>
// After yaml.h, which it needs.
#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <string_view>

#include "sdfgrid/core/error.h"

namespace sdfgrid {
namespace {

// What aliases may make of a document, counted in nodes as a reader without aliases would see them.
constexpr double kMostExpanded = 2e6;

// Builds the tree from the parser's events. YAML::Load would lose what is an alias, and takes five
// times the memory.
class Builder : public YAML::EventHandler {
 public:
  explicit Builder(const std::string& file) : file_(file) {}

  YamlTree take(const YAML::Mark& mark) {
    if (tree_.nodes.empty()) refuse(mark, "the document is empty", "give it a `scene`");
    if (expanded_[0] > kMostExpanded && expanded_[0] > 2.0 * double(tree_.nodes.size())) {
      refuse(
          mark,
          fmt::format("its aliases multiply {} nodes to {:.3g}", tree_.nodes.size(), expanded_[0]),
          "write fewer copies");
    }
    if (height_[0] > kMaxYamlDepth) refuse(mark, too_deep(), "use fewer aliases of aliases");
    return std::move(tree_);
  }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    attach(add(YamlNode::Kind::null, mark, anchor));
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const std::uint32_t node = anchors_.at(anchor);
    if (std::find(open_.begin(), open_.end(), node) != open_.end()) {
      refuse(mark, "an alias stands inside of what it names", "name something else");
    }
    attach(node);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    const std::uint32_t node = add(YamlNode::Kind::scalar, mark, anchor);
    tree_.nodes[node].text = value;
    tree_.nodes[node].quoted = tag == "!";
    attach(node);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(YamlNode::Kind::list, mark, anchor);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(YamlNode::Kind::map, mark, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapEnd() override {
    check_keys(tree_.nodes[open_.back()]);
    close();
  }

  [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& problem,
                           const std::string& remedy) const {
    refuse(mark.line + 1, mark.column + 1, problem, remedy);
  }
  [[noreturn]] void refuse(int line, int column, const std::string& problem,
                           const std::string& remedy) const {
    throw input_error(file_, fmt::format("line {}, column {}", line, column), problem, remedy);
  }

 private:
  static std::string too_deep() {
    return fmt::format("it is nested more than {} levels deep", kMaxYamlDepth);
  }

  std::uint32_t add(YamlNode::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor) {
    const auto index = static_cast<std::uint32_t>(tree_.nodes.size());
    YamlNode& node = tree_.nodes.emplace_back();
    node.kind = kind;
    node.line = mark.line + 1;
    node.column = mark.column + 1;
    expanded_.push_back(1);
    height_.push_back(1);
    if (anchor != YAML::NullAnchor) anchors_[anchor] = index;
    return index;
  }

  // The node is complete: part of the innermost open one.
  void attach(std::uint32_t node) {
    if (open_.empty()) return;
    tree_.nodes[open_.back()].items.push_back(node);
    expanded_[open_.back()] += expanded_[node];
    height_[open_.back()] = std::max(height_[open_.back()], height_[node] + 1);
  }

  void open(YamlNode::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (open_.size() >= kMaxYamlDepth) {
      refuse(mark, too_deep(), "flatten lists of unions");
    }
    open_.push_back(add(kind, mark, anchor));
  }

  void close() {
    const std::uint32_t node = open_.back();
    open_.pop_back();
    attach(node);
  }

  void check_keys(const YamlNode& map) const {
    std::set<std::string_view> seen;
    for (std::size_t i = 0; i < map.items.size(); i += 2) {
      const YamlNode& key = tree_.nodes[map.items[i]];
      if (key.kind != YamlNode::Kind::scalar) {
        refuse(key.line, key.column, "a key must be a word", "check the braces");
      }
      if (!seen.insert(key.text).second) {
        refuse(key.line, key.column, fmt::format("the key `{}` stands twice", key.text),
               "make a list of two nodes, or drop one");
      }
    }
  }

  const std::string& file_;
  YamlTree tree_;
  std::vector<double> expanded_;     // of each node, itself and all below, aliases followed
  std::vector<int> height_;          // the same of levels
  std::vector<std::uint32_t> open_;  // lists and maps that have begun
  std::map<YAML::anchor_t, std::uint32_t> anchors_;
};

}  // namespace

YamlTree parse_yaml(const std::string& text, const std::string& file) {
  Builder builder(file);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    parser.HandleNextDocument(builder);
    YamlTree tree = builder.take(YAML::Mark());
    Builder second(file);
    if (parser.HandleNextDocument(second)) {
      throw input_error(file, "", "it holds more than one document", "keep one");
    }
    return tree;
  } catch (const YAML::Exception& e) {
    builder.refuse(e.mark, e.msg, "correct the YAML there");
  }
}

}  // namespace sdfgrid
