// Every word of scene files, one after the other: what is written is saved as it was, what is
// mistyped is answered with the nearest right word, what is missing or of the wrong type is refused
// with line and column.
#include "sdfgrid/core/words.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <regex>
#include <string_view>

#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/convert_field.h"
#include "sdfgrid/scene/build.h"
#include "sdfgrid/scene/scene.h"
#include "sdfgrid/scene/words.h"

namespace sdfgrid {
namespace {

// All words of nodes, but those that are another way to write one.
std::vector<OpEntry> all_words() {
  std::vector<OpEntry> all(op_list().begin(), op_list().end());
  for (const OpEntry& word : scene_words()) {
    if (std::string_view(word.info->name) != "displace") all.push_back(word);
  }
  return all;
}

bool needs_nodes(const OpEntry& op) { return op.info->role != OpRole::leaf; }

std::string scene_of(const std::string& node) { return "sdfgrid: 1\nscene:\n  - " + node + "\n"; }

// The message with which a text is refused, "" if it is not.
std::string refusal(const std::string& text) {
  try {
    (void)build_scene(parse_scene(text, "s.yaml").scene, "s.yaml", 0, Job());
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
    return error.what();
  }
  return "";
}

void expect_place(const std::string& message, const std::string& text) {
  EXPECT_TRUE(std::regex_search(message, std::regex("^s\\.yaml: line [0-9]+, column [0-9]+")))
      << text << message;
}

// A value that the parameter may have, as it is written: numbers, some as formulas of t.
class ValueWriter {
 public:
  explicit ValueWriter(unsigned seed) : random_(seed) {}

  std::string value(const Parameter& p) {
    switch (p.kind) {
      case ParameterKind::text:
        return fmt::format("\"a \\\"text\\\" {}: #{}\"", p.name, pick(9));
      case ParameterKind::number:
      case ParameterKind::whole:
        return number();
      case ParameterKind::pair:
        return list(1 + pick(2));
      case ParameterKind::vector:
        return list(3);
      case ParameterKind::matrix:
        return "[" + list(3) + ", " + list(3) + ", " + list(3) + "]";
      case ParameterKind::numbers:
      case ParameterKind::points:
        break;
    }
    return list(3 * (1 + pick(3)));
  }
  std::string number() {
    const double v = std::uniform_real_distribution<double>(-9, 9)(random_);
    switch (pick(4)) {
      case 0:
        return fmt::format("\"{} + sin(2*pi*t)\"", v);
      case 1:
        return fmt::format("{}", std::floor(v));
      default:
        return fmt::format("{}", v);
    }
  }
  std::string list(int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += (i > 0 ? ", " : "[") + number();
    return text + "]";
  }
  int pick(int below) { return static_cast<int>(random_() % static_cast<unsigned>(below)); }

 private:
  std::mt19937 random_;
};

// Every parameter given or not, places, names and materials: load, save, load is identity.
TEST(SceneWords, SavedAndLoadedEveryOpIsTheSame) {
  unsigned seed = 0;
  for (const OpEntry& op : all_words()) {
    for (int round = 0; round < 20; ++round) {
      ValueWriter writer(++seed);
      std::string text = fmt::format(
          "sdfgrid: 1\nmaterials: {{a: {{specular: {}}}, \"b c\": {{}}}}\n", writer.number());
      text += fmt::format("scene:\n  - {}: {{", op.info->name);
      for (const Parameter& p : op.parameters) {
        if (writer.pick(3) > 0) text += fmt::format("{}: {}, ", p.name, writer.value(p));
      }
      if (needs_nodes(op)) text += "of: [{sphere: {radius: \"1+t\"}, name: inner}, {box: {}}]";
      text += "}\n";
      if (writer.pick(2) == 0) text += "    name: \"it's: {this} \\\"one\\\"\"\n";
      if (writer.pick(2) == 0) text += "    material: b c\n";
      if (writer.pick(2) == 0) text += "    at: " + writer.list(3) + "\n";
      // `rotate` and `scale` are ops, too, and a key stands but once.
      const std::string_view name = op.info->name;
      if (name != "rotate" && writer.pick(2) == 0) text += "    rotate: " + writer.list(3) + "\n";
      if (name != "scale" && writer.pick(2) == 0)
        text += "    scale: " + writer.list(writer.pick(2) == 0 ? 1 : 3) + "\n";
      const SceneFile first = parse_scene(text, "a");
      EXPECT_TRUE(first.warnings.empty()) << text << first.warnings.front();
      const std::string saved = scene_text(first.scene);
      const SceneFile second = parse_scene(saved, "b");
      EXPECT_TRUE(second.warnings.empty()) << saved << second.warnings.front();
      ASSERT_EQ(second.scene, first.scene) << text << saved;
      ASSERT_EQ(scene_text(second.scene), saved);
    }
  }
}

// Whether the message proposes a word that is as near to the mistyped one as any.
void expect_nearest(const std::string& message, const std::string& typo,
                    const std::vector<std::string>& words) {
  std::size_t least = 99;
  for (const std::string& word : words) least = std::min(least, edit_distance(typo, word));
  std::smatch match;
  ASSERT_TRUE(std::regex_search(message, match, std::regex("did you mean `([^`]+)`"))) << message;
  EXPECT_EQ(edit_distance(typo, match.str(1)), least) << message;
  EXPECT_NE(std::find(words.begin(), words.end(), match.str(1)), words.end()) << message;
}

// With a letter too few, one too many, and two swapped.
std::vector<std::string> typos(const std::string& word) {
  std::string swapped = word;
  std::swap(swapped[1], swapped[2]);
  return {word.substr(0, 1) + word.substr(2), word + word.back(), swapped};
}

TEST(SceneWords, AMistypedParameterIsAnsweredWithTheNearestRightOne) {
  std::size_t count = 0;
  for (const OpEntry& op : all_words()) {
    std::vector<std::string> words;
    for (const Parameter& p : op.parameters) words.emplace_back(p.name);
    if (needs_nodes(op)) words.emplace_back("of");
    for (const Parameter& p : op.parameters) {
      if (std::string_view(p.name).size() < 3) continue;
      for (const std::string& typo : typos(p.name)) {
        if (std::find(words.begin(), words.end(), typo) != words.end()) continue;
        const std::string text = scene_of(fmt::format("{}: {{{}: 1}}", op.info->name, typo));
        const SceneFile file = parse_scene(text, "s.yaml");
        ASSERT_EQ(file.warnings.size(), 1U) << text;
        EXPECT_TRUE(file.warnings[0].starts_with("s.yaml: line 3: ")) << file.warnings[0];
        EXPECT_NE(file.warnings[0].find("`" + typo + "`"), std::string::npos) << file.warnings[0];
        expect_nearest(file.warnings[0], typo, words);
        ++count;
      }
    }
  }
  EXPECT_GT(count, 150U);
}

TEST(SceneWords, AMistypedOpIsAnsweredWithTheNearestRightOne) {
  std::vector<std::string> words = node_words();
  for (const char* placing : {"at", "rotate", "scale", "material", "name"}) {
    words.emplace_back(placing);
  }
  for (const OpEntry& op : all_words()) {
    for (const std::string& typo : typos(op.info->name)) {
      if (std::find(words.begin(), words.end(), typo) != words.end()) continue;
      const SceneFile file = parse_scene(scene_of(typo + ": {}"), "s.yaml");
      ASSERT_EQ(file.warnings.size(), 1U) << typo;
      EXPECT_TRUE(file.warnings[0].starts_with("s.yaml: line 3: ")) << file.warnings[0];
      expect_nearest(file.warnings[0], typo, words);
    }
  }
}

TEST(SceneWords, AMissingParameterIsRefusedWithItsPlace) {
  std::size_t count = 0;
  for (const OpEntry& op : all_words()) {
    for (const Parameter& p : op.parameters) {
      if (!std::isnan(p.fallback[0])) continue;
      std::string text = std::string(op.info->name) + ": {";
      if (needs_nodes(op)) text += "of: [{sphere: {}}, {box: {}}]";
      text = scene_of(text + "}");
      const std::string message = refusal(text);
      expect_place(message, text);
      EXPECT_NE(message.find(op.info->name), std::string::npos) << message;
      ++count;
    }
  }
  EXPECT_GT(count, 5U);
}

// Of another kind, of another count, or beyond its range.
TEST(SceneWords, AParameterOfTheWrongTypeIsRefusedWithItsPlace) {
  for (const OpEntry& op : all_words()) {
    for (const Parameter& p : op.parameters) {
      std::vector<std::string> wrong = {"{a: 1}", "{}"};
      if (p.kind == ParameterKind::text) {
        wrong.insert(wrong.end(), {"[1, 2]", "[[a]]"});
      } else {
        wrong.insert(wrong.end(), {"nonsense", "\"1 +\"", ".nan", "~", "[1, {a: 2}]", "[1, x]"});
      }
      if (p.kind == ParameterKind::number || p.kind == ParameterKind::whole) {
        wrong.emplace_back("[1, 2]");
        wrong.emplace_back("[]");
        if (p.lo > -1e9) wrong.push_back(fmt::format("{}", p.lo - 1));
        if (p.hi < 1e9) wrong.push_back(fmt::format("{}", p.hi + 1));
        if (p.kind == ParameterKind::whole) wrong.push_back(fmt::format("{}", p.lo + 0.5));
      }
      if (p.kind == ParameterKind::vector) wrong.emplace_back("[1, 2]");
      if (p.kind == ParameterKind::matrix) wrong.emplace_back("[1, 2, 3]");
      for (const std::string& value : wrong) {
        std::string text = fmt::format("{}: {{{}: {}", op.info->name, p.name, value);
        if (needs_nodes(op)) text += ", of: [{sphere: {}}, {box: {}}]";
        text = scene_of(text + "}");
        const std::string message = refusal(text);
        EXPECT_NE(message, "") << text;
        if (!message.empty()) expect_place(message, text);
      }
    }
  }
}

// Whatever is shrunk to nothing: found by intervals, without a search of space, and the op is
// named. (Intervals prove nothing of some estimates, so that space is searched.)
TEST(SceneWords, AnOffsetThatLeavesNothingIsFoundAtOnce) {
  FieldConvertOptions options;
  for (const OpEntry& op : op_list()) {
    options.dim = op.info->guarantee == OpGuarantee::estimate ? 32 : 4000;
    const std::string text = fmt::format(
        "sdfgrid: 1\nscene: {{intersection: [{{offset: {{by: -60, of: {{{}}}}}}}, "
        "{{box: {{size: [9, 9, 9]}}}}]}}\n",
        op.info->example);
    const Field field = build_scene(parse_scene(text, "s.yaml").scene, "s.yaml", 0, Job()).field;
    try {
      (void)convert_field(field, options, Job());
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find("no point is inside"), std::string::npos) << message;
      EXPECT_NE(message.find("`offset`"), std::string::npos) << message;
    }
  }
}

TEST(SceneWords, EmptySolidsAreToldWhatMayEmptyThem) {
  const auto message = [](const std::string& nodes) {
    const std::string text = "sdfgrid: 1\nscene: " + nodes + "\n";
    const Field field = build_scene(parse_scene(text, "s.yaml").scene, "s.yaml", 0, Job()).field;
    try {
      (void)convert_field(field, {}, Job());
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message("[]").find("give it a shape"), std::string::npos) << message("[]");
  EXPECT_EQ(message("[]").find("intersection"), std::string::npos) << message("[]");
  const std::string difference =
      message("{difference: [{sphere: {radius: 1}}, {sphere: {radius: 2}}]}");
  EXPECT_NE(difference.find("`difference`"), std::string::npos) << difference;
  EXPECT_EQ(difference.find("intersection"), std::string::npos) << difference;
  EXPECT_EQ(message("{sphere: {radius: 1}}"), "");
  EXPECT_EQ(message("{difference: [{sphere: {radius: 1}}, {sphere: {radius: 0.999}}]}"), "");
}

}  // namespace
}  // namespace sdfgrid
