// What is no scene: every refusal names the place, and nothing hostile does more than be refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "sdfgrid/core/error.h"
#include "sdfgrid/scene/build.h"
#include "sdfgrid/scene/scene.h"

namespace sdfgrid {
namespace {

// The message with which a text is refused, "" if it is not.
std::string refusal(const std::string& text) {
  try {
    const SceneFile file = parse_scene(text, "s.yaml");
    (void)build_scene(file.scene, "s.yaml", 0, Job());
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
    return error.what();
  }
  return "";
}

void expect_refused(const std::string& text, const std::string& place, const std::string& what) {
  const std::string message = refusal(text);
  EXPECT_TRUE(message.starts_with("s.yaml: " + place)) << message;
  EXPECT_NE(message.find(what), std::string::npos) << message;
}

TEST(SceneRefused, BrokenYaml) {
  expect_refused("sdfgrid: 1\nscene: [{sphere: {radius: 1}\n", "line 3, column 1", "flow");
  expect_refused("sdfgrid: 1\nscene:\n  - sphere: {radius: 1}\n - box: {}\n", "line 4, column 2",
                 "");
  expect_refused("", "line ", "empty");
  expect_refused("sdfgrid: 1\nscene: *nobody\n", "line 2, column 8", "anchor");
  expect_refused("sdfgrid: 1\nscene: {sphere: {}}\n---\nscene: {}\n", "", "more than one document");
}

TEST(SceneRefused, WhatIsNoScene) {
  expect_refused("[1, 2]", "line 1, column 1", "no scene");
  expect_refused("scene: {sphere: {}}\n", "line 1, column 1", "begin with `sdfgrid: 1`");
  expect_refused("sdfgrid: 0\nscene: {}\n", "line 1, column 10", "version");
  expect_refused("sdfgrid: 1\n", "line 1, column 1", "`scene`");
  expect_refused("sdfgrid: 1\nscene: ball\n", "line 2, column 8", "node");
}

TEST(SceneRefused, NodesThatAreNone) {
  expect_refused("sdfgrid: 1\nscene:\n  - sphere: {}\n    box: {}\n", "line 4, column 5",
                 "`sphere` and `box`");
  expect_refused("sdfgrid: 1\nscene:\n  - sphere: {}\n    sphere: {}\n", "line 4, column 5",
                 "twice");
  expect_refused("sdfgrid: 1\nscene: [{at: [1, 2, 3]}]\n", "line 2, column 9", "without a shape");
  expect_refused("sdfgrid: 1\nscene: [{sphere: 1}]\n", "line 2, column 18", "has names");
  expect_refused("sdfgrid: 1\nscene: [[{sphere: {}}]]\n", "line 2, column 9", "node");
}

TEST(SceneRefused, CamerasAndMaterials) {
  const std::string ball = "scene: {sphere: {}}\n";
  expect_refused("sdfgrid: 1\ncamera: {eye: [1, 2, 3], target: [1, 2, 3]}\n" + ball,
                 "line 2, column 15", "same point");
  expect_refused("sdfgrid: 1\nmaterials: {a: {diffuse: [0.5, -0.1, 1]}}\n" + ball,
                 "line 2, column 26", "`diffuse` must not be negative");
  expect_refused("sdfgrid: 1\nmaterials: {a: {specular: 2}}\n" + ball, "line 2, column 27",
                 "`specular`");
  expect_refused("sdfgrid: 1\ncamera: {fov: [1, 2]}\n" + ball, "line 2, column 15", "`fov`");
}

TEST(SceneRefused, Numbers) {
  expect_refused("sdfgrid: 1\nscene: [{sphere: {radius: {a: 1}}}]\n", "line 2, column 27",
                 "number");
  expect_refused("sdfgrid: 1\nscene: [{sphere: {radius: .nan}}]\n", "line 2, column 27", "");
  expect_refused("sdfgrid: 1\nscene: [{sphere: {radius: \"1 +\"}}]\n", "line 2, column 27", "^");
  expect_refused("sdfgrid: 1\nscene: [{sphere: {radius: 1e999}}]\n", "line 2, column 27", "finite");
  expect_refused("sdfgrid: 1\nscene: [{sphere: {radius: .inf}}]\n", "line 2, column 27", "finite");
  expect_refused("sdfgrid: 1\nscene: [{gdf: {exponent: -.inf}}]\n", "line 2, column 26", "");
  expect_refused("sdfgrid: 1\nscene: [{sphere: {}, at: [1, 2]}]\n", "line 2, column 26", "three");
  expect_refused("sdfgrid: 1\nscene: [{sphere: {radius: -1}}]\n", "line 2", "`radius` is -1");
  expect_refused("sdfgrid: 1\nscene:\n- union:\n  - name: bad\n    box: {size: [1, 2]}\n",
                 "line 5, column 17 (`bad`)", "give 3");
  expect_refused("sdfgrid: 1\nscene: [{grid: {file: nowhere.vdb}}]\n", "line 2", "nowhere.vdb");
  expect_refused("sdfgrid: 1\nscene: [{twist: {turns: 1, of: {plane: {}}}}]\n", "line 2", "twist");
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

TEST(SceneRefused, TwentyThousandNestedNodes) {
  constexpr int kMany = 20000;
  const std::string head = "sdfgrid: 1\nscene: ";
  EXPECT_NE(refusal(head + repeated("[", kMany)), "");
  EXPECT_NE(refusal(head + repeated("[", kMany) + repeated("]", kMany)), "");
  EXPECT_NE(
      refusal(head + repeated("{offset: {of: ", kMany) + "{sphere: {}}" + repeated("}}", kMany)),
      "");
  EXPECT_NE(refusal(head + "\n" + repeated("- ", kMany) + "1"), "");
  std::string block = "sdfgrid: 1\nscene:\n";
  for (int i = 0; i < 2000; ++i) block += repeated(" ", i + 1) + "union:\n";
  EXPECT_NE(refusal(block), "");
  expect_refused(head + repeated("{union: [", 101) + "{sphere: {}}" + repeated("]}", 101),
                 "line 2, column", "nested more than 100");
  EXPECT_EQ(refusal(head + repeated("{union: [", 99) + "{sphere: {}}" + repeated("]}", 99)), "");
}

TEST(SceneRefused, AliasBombs) {
  std::string bomb = "sdfgrid: 1\na0: &a0 {sphere: {}}\n";
  for (int i = 1; i < 30; ++i) {
    bomb += fmt::format("a{}: &a{} {{union: [{}]}}\n", i, i,
                        repeated(fmt::format("*a{}, ", i - 1), 10));
  }
  expect_refused(bomb + "scene: *a29\n", "line ", "aliases multiply");
  std::string chain = "sdfgrid: 1\na0: &a0 {sphere: {}}\n";
  for (int i = 1; i < 1900; ++i)
    chain += fmt::format("a{}: &a{} {{offset: {{of: *a{}}}}}\n", i, i, i - 1);
  EXPECT_NE(refusal(chain + "scene: *a1899\n"), "");
  expect_refused("sdfgrid: 1\nscene: &a {union: [*a, *a]}\n", "line 2, column ", "inside");
}

TEST(SceneRefused, FormulasThatAreHostile) {
  const auto radius = [](const std::string& text) {
    return "sdfgrid: 1\nscene: [{sphere: {radius: \"" + text + "\"}}]\n";
  };
  EXPECT_NE(refusal(radius(repeated("(", 100000) + "1" + repeated(")", 100000))), "");
  EXPECT_NE(refusal(radius(repeated("-", 100000) + "1")), "");
  EXPECT_NE(refusal(radius("1/0")), "");
  EXPECT_NE(refusal(radius("x")), "");
}

// What needs an end is told which node has none: the innermost, unless something ends it.
TEST(SceneRefused, NodesWithoutEndByLine) {
  const auto told = [](const std::string& nodes) -> std::string {
    const SceneFile file = parse_scene("sdfgrid: 1\nscene:\n" + nodes, "s.yaml");
    try {
      check_has_end(build_scene(file.scene, "s.yaml", 0, Job()), "s.yaml");
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(told("- sphere: {}\n- difference: [{box: {}}, {plane: {}}]\n"
                 "- intersection: [{repeat: {of: {sphere: {radius: 0.3}}}}, {box: {}}]\n"),
            "");
  const std::string plane = told("- sphere: {}\n- union:\n    - box: {}\n    - plane: {}\n");
  EXPECT_NE(plane.find("s.yaml: line 6: `plane` has no end along z"), std::string::npos) << plane;
  EXPECT_NE(plane.find("intersect it with a box"), std::string::npos) << plane;
  const std::string copies = told("- repeat: {cell: [1, 0, 0], of: {sphere: {radius: 0.3}}}\n");
  EXPECT_NE(copies.find("line 3: `repeat` has no end along x"), std::string::npos) << copies;
  const std::string rest = told("- complement:\n    of:\n      sphere: {}\n");
  EXPECT_NE(rest.find("line 3: `complement` has no end"), std::string::npos) << rest;
}

// Bytes changed, dropped and doubled: either a scene or a refusal.
TEST(SceneRefused, MutatedTexts) {
  const std::string good =
      "sdfgrid: 1\ncamera: {eye: [1, 2, 3]}\nmaterials: {a: {specular: 0.2}}\nscene:\n"
      "  - smooth_union: {k: 0.2, of: [{sphere: {radius: \"1+t\"}}, &b {box: {size: [1, 2, 3]}}]}\n"
      "    at: [1, 2, 3]\n    material: a\n  - *b\n";
  ASSERT_EQ(refusal(good), "");
  std::mt19937 random(11);
  int refused = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string text = good;
    for (unsigned changes = random() % 4 + 1; changes > 0; --changes) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[at] = static_cast<char>(random() % 256);
          break;
        case 1:
          text.erase(at, random() % 8);
          break;
        default:
          text.insert(at, text.substr(random() % text.size(), random() % 16));
      }
    }
    refused += refusal(text).empty() ? 0 : 1;
  }
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace sdfgrid
