// Stroke files: what they say, what is refused, and brushes that are fields.
#include "sdfgrid/edit/stroke_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <random>

#include "edit/grids.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/sculptor.h"

namespace sdfgrid {
namespace {

using namespace sdfgrid::test;

TEST(StrokeFile, ReadsEveryWord) {
  const StrokeFile file = parse_strokes(R"(
sdfgrid-strokes: 1
strokes:
  - {op: union, brush: {sphere: {radius: 0.05}}, path: [[0,0,1], [0.2,0,1,0.5]], spacing: 0.3}
  - {op: difference, brush: {box: {size: [0.1,0.1,0.4]}}, path: [[0,1,0]], smooth: 0.02, mirror: [x]}
  - op: pinch
    name: a spot
    brush: {sphere: {radius: 1}}
    path: [[1, 2, 3]]
    strength: 0.25
    mirror: [{z: 0.5}, y]
)",
                                        "test");
  ASSERT_EQ(file.strokes.size(), 3U);
  EXPECT_TRUE(file.warnings.empty());
  const Stroke& a = file.strokes[0];
  EXPECT_EQ(a.op, StrokeOp::unite);
  EXPECT_EQ(a.brush.radius, 0.05);
  ASSERT_EQ(a.path.size(), 2U);
  EXPECT_EQ(a.path[0].pressure, 1);
  EXPECT_EQ(a.path[1].at, glm::dvec3(0.2, 0, 1));
  EXPECT_EQ(a.path[1].pressure, 0.5);
  EXPECT_EQ(a.spacing, 0.3);
  const Stroke& b = file.strokes[1];
  EXPECT_EQ(b.op, StrokeOp::subtract);
  ASSERT_NE(b.brush.shape, nullptr);
  EXPECT_TRUE(b.brush.shape->exact);
  EXPECT_EQ(b.smooth, 0.02);
  EXPECT_EQ(b.mirror[0].axis, 0);
  const Stroke& c = file.strokes[2];
  EXPECT_EQ(c.op, StrokeOp::pinch);
  EXPECT_EQ(c.strength, 0.25);
  EXPECT_EQ(c.mirror[0].axis, 2);
  EXPECT_EQ(c.mirror[0].at, 0.5);
  EXPECT_EQ(c.mirror[1].axis, 1);
}

TEST(StrokeFile, TheTextOfAStrokeMakesItAgain) {
  const StrokeFile file = parse_strokes(R"(
sdfgrid-strokes: 1
strokes:
  - op: union
    brush: {capsule: {from: [0, 0, -0.123456789012345], to: [0, 0, 1], radius: 0.1}}
    path: [[0.1, 0.2, 0.30000000000000004]]
)",
                                        "test");
  const Stroke& stroke = file.strokes[0];
  EXPECT_EQ(stroke.text.find('\n'), std::string::npos);
  const Stroke again = parse_stroke(stroke.text, "test");
  EXPECT_EQ(again.text, stroke.text);
  EXPECT_EQ(again.path[0].at, stroke.path[0].at);
  EXPECT_EQ(again.brush.shape->bounds.lo, stroke.brush.shape->bounds.lo);
}

void expect_refused(const std::string& text, const std::string& what) {
  try {
    (void)parse_strokes(text, "file.yaml");
    FAIL() << "not refused: " << what;
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::input);
    EXPECT_NE(std::string(e.what()).find(what), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("file.yaml"), std::string::npos) << e.what();
  }
}

TEST(StrokeFile, RefusesWithLineAndRemedy) {
  const std::string head = "sdfgrid-strokes: 1\nstrokes:\n  - ";
  expect_refused("", "no stroke file");
  expect_refused("sdfgrid-strokes: 2\nstrokes: []\n", "version");
  expect_refused("sdfgrid-strokes: 1\n", "no list of strokes");
  expect_refused("sdfgrid-strokes: 1\nstrokes: [\n", "line");
  expect_refused(head + "{op: union, path: [[0,0,0]]}", "no brush");
  expect_refused(head + "{op: carve, brush: {sphere: {radius: 1}}, path: [[0,0,0]]}", "line 3");
  expect_refused(head + "{op: union, brush: {sphere: {radius: big}}, path: [[0,0,0]]}", "number");
  expect_refused(head + "{op: union, brush: {spere: {radius: 1}}, path: [[0,0,0]]}", "spere");
  expect_refused(head + "{op: union, brush: {sphere: {radius: 1}}, path: [[0,0]]}", "2 numbers");
  expect_refused(head + "{op: union, brush: {sphere: {radius: 1}}, path: 3}", "path");
  expect_refused(head + "{op: union, brush: {plane: {normal: [0,0,1]}}, path: [[0,0,0]]}",
                 "no end");
  expect_refused(head + "{op: union, brush: {sphere: {radius: 1}}, path: [[0,0,0]], mirror: [w]}",
                 "axis");
}

// With the line, and what to write instead.
TEST(StrokeFile, RefusesBrokenValuesWithTheLine) {
  const std::string head = "sdfgrid-strokes: 1\nstrokes:\n  - ";
  const std::string ball = "brush: {sphere: {radius: 1}}";
  const auto refused = [&](const std::string& stroke, const std::string& what) {
    expect_refused(head + stroke, what);
    expect_refused(head + stroke, "line 3");
    expect_refused(head + stroke, ";");  // and the remedy behind it
  };
  refused("{op: union, brush: {sphere: 0.05}, path: [[0,0,0]]}", "no radius");
  refused("{op: union, brush: {sphere: [1, 2]}, path: [[0,0,0]]}", "no radius");
  refused("{op: union, brush: {box: 0.05}, path: [[0,0,0]]}", "parameters");
  refused("{op: union, brush: {[a]: {radius: 1}}, path: [[0,0,0]]}", "key");
  refused("{op: union, [1, 2]: 3, " + ball + ", path: [[0,0,0]]}", "key");
  refused("{op: union, " + ball + ", path: []}", "no points");
  refused("{op: union, " + ball + ", path: [[0,0,0,0]]}", "pressure");
  refused("{op: union, " + ball + ", path: [[0,0,0,1.5]]}", "pressure");
  refused("{op: union, " + ball + ", path: [[0,.nan,0]]}", "nan");
  refused("{op: union, brush: {sphere: {radius: 0}}, path: [[0,0,0]]}", "radius");
  refused("{op: union, brush: {sphere: {radius: -1}}, path: [[0,0,0]]}", "radius");
  refused("{op: union, brush: {sphere: {radius: .inf}}, path: [[0,0,0]]}", "radius");
  refused("{op: union, brush: {box: {size: [1, .nan, 1]}}, path: [[0,0,0]]}", "size");
  refused("{op: inflate, " + ball + ", path: [[0,0,0]], strength: 0}", "strength");
  refused("{op: inflate, " + ball + ", path: [[0,0,0]], strength: 2}", "strength");
  refused("{op: inflate, " + ball + ", path: [[0,0,0]], spacing: 0}", "spacing");
  refused("{op: union, " + ball + ", path: [[0,0,0]], smooth: -1}", "blend");
  refused("{op: union, " + ball + ", path: [[0,0,0]], mirror: [{x: .nan}]}", "mirror");
  refused("{op: union, " + ball + ", path: [[0,0,0]], mirror: [x, {x: 0}]}", "stands twice");
  refused("{op: union, op: difference, " + ball + ", path: [[0,0,0]]}", "'op' stands twice");
  refused("{op: union, brush: {box: {size: 1, size: 2}}, path: [[0,0,0]]}", "stands twice");
  refused("{op: union, brush: &a {union: [*a]}, path: [[0,0,0]]}", "deep");
  expect_refused("sdfgrid-strokes: 1\nstrokes: []\n---\na: 1\n", "second document");
  // The word that was meant.
  refused("{op: union, brush: {sphere: {raduis: 1}}, path: [[0,0,0]]}", "did you mean 'radius'?");
  refused("{op: unoin, " + ball + ", path: [[0,0,0]]}", "did you mean 'union'?");
  refused("{op: union, brush: {spere: {radius: 1}}, path: [[0,0,0]]}", "did you mean 'sphere'?");
  expect_refused("sdfgrid-strokes: 1\nstroks: []\n", "did you mean 'strokes'?");
  std::string laughs = "sdfgrid-strokes: 1\na0: &a0 [1, 1]\n";
  for (int i = 1; i < 40; ++i) laughs += fmt::format("a{0}: &a{0} [*a{1}, *a{1}]\n", i, i - 1);
  expect_refused(laughs + "strokes: []\n", "aliases");
}

TEST(StrokeFile, WordsWithoutEffectAreWarnings) {
  const auto warned = [](const std::string& stroke, const std::string& word,
                         const std::string& why) {
    const StrokeFile file =
        parse_strokes("sdfgrid-strokes: 1\nstrokes:\n  - {" + stroke + "}\n", "file.yaml");
    ASSERT_EQ(file.warnings.size(), 1U) << stroke;
    for (const std::string& part : {std::string("file.yaml: line 3"), "'" + word + "'", why}) {
      EXPECT_NE(file.warnings[0].text.find(part), std::string::npos) << file.warnings[0].text;
    }
  };
  const std::string ball = "brush: {sphere: {radius: 1}}, path: [[0,0,0]], ";
  const std::string box = "brush: {box: {size: 1}}, path: [[0,0,0]], ";
  warned("op: union, " + ball + "spcing: 2", "spcing", "did you mean 'spacing'?");
  warned("op: union, " + ball + "miror: [x]", "miror", "did you mean 'mirror'?");
  warned("op: union, brush: {sphere: {radius: 1, raduis: 3}}, path: [[0,0,0]]", "raduis",
         "did you mean 'radius'?");
  warned("op: union, " + box + "strength: 1", "strength", "clay");
  warned("op: difference, " + box + "material: 3", "material", "paint");
  warned("op: inflate, " + ball + "material: 3", "material", "paint");
  warned("op: inflate, " + ball + "smooth: 3", "smooth", "blend");
  warned("op: paint, material: 1, " + ball + "strength: 1", "strength", "clay");
  const StrokeFile good = parse_strokes(
      "sdfgrid-strokes: 1\nversion: 3\nstrokes:\n  - {op: inflate, " + ball +
          "strength: 1, spacing: 1}\n  - {op: union, " + box + "spacing: 1, smooth: 1}\n",
      "file.yaml");
  ASSERT_EQ(good.warnings.size(), 1U);
  EXPECT_NE(good.warnings[0].text.find("line 2: 'version'"), std::string::npos)
      << good.warnings[0].text;
}

// Puts another value, with all that it holds, in place of the one behind the next colon.
void replace_value(std::string& text, std::size_t at, const std::string& value) {
  const std::size_t begin = text.find(':', at);
  if (begin == std::string::npos) return;
  int depth = 0;
  std::size_t end = begin + 1;
  for (; end < text.size(); ++end) {
    const char c = text[end];
    if (depth == 0 && (c == ',' || c == '}' || c == ']' || c == '\n')) break;
    depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
  }
  text.replace(begin, end - begin, ": " + value);
}

// Whatever is in a file, it is strokes or an error that says what is wrong with it.
TEST(StrokeFile, FuzzedFilesAreRefusedOrRead) {
  const std::string text = R"(sdfgrid-strokes: 1
strokes:
  - {op: union, brush: {sphere: {radius: 0.05}}, path: [[0,0,1], [0.2,0,1,0.5]], spacing: 0.3}
  - {op: difference, brush: {box: {size: [0.1,0.1,0.4]}}, path: [[0,1,0]], smooth: 0.02, mirror: [x]}
  - {op: stamp, brush: {grid: {file: a.vdb}}, path: [[0,1,0]]}
  - {op: union, brush: {twist: {turns: 2, of: {box: {size: 1}}}}, path: [[0,1,0]], name: "a b"}
  - {op: paint, material: 3, brush: &b {union: [{sphere: {radius: 1}}, {torus: {major: 1}}]}, path: [[1,2,3]]}
  - {op: pinch, brush: *b, path: [[1, 2, 3]], strength: 0.25, mirror: [{z: 0.5}, y]}
)";
  const std::vector<std::string> pieces = {
      "{",  "}",    "[",      "]",    ":",      ",",      "*b",      "&b ",    "\n",
      "  ", "- ",   "~",      ".nan", "-.inf",  "1e300",  "-1",      "0",      "'",
      "\"", "#",    "op",     "of",   "sphere", "union",  "brush",   "mirror", "path",
      "? ", "!!x ", "<<: *b", "|\n",  "%",      "radius", "scene",   "grid",   "file",
      "\t", "\xff", "{}",     "[]",   "{1: 2}", "[{}]",   "{[a]: 1}"};
  std::mt19937 random(7);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  int read = 0;
  int refused = 0;
  for (int run = 0; run < 3000; ++run) {
    std::string fuzzed = text;
    for (std::size_t edits = 1 + below(3); edits > 0; --edits) {
      const std::size_t at = below(fuzzed.size());
      switch (below(5)) {
        case 0:
          fuzzed[at] = static_cast<char>(below(256));
          break;
        case 1:
          fuzzed.erase(at, 1 + below(12));
          break;
        case 2:
          fuzzed.insert(at, fuzzed.substr(below(fuzzed.size()), below(30)));
          break;
        case 3:
          replace_value(fuzzed, at, pieces[below(pieces.size())]);
          break;
        default:
          fuzzed.insert(at, pieces[below(pieces.size())]);
      }
    }
    try {
      for (const Stroke& stroke : parse_strokes(fuzzed, "file.yaml").strokes) {
        (void)parse_stroke(stroke.text, "again");
      }
      ++read;
    } catch (const Error& e) {
      ASSERT_EQ(e.kind(), ErrorKind::input) << e.what() << "\n" << fuzzed;
      ++refused;
    } catch (const std::exception& e) {
      FAIL() << e.what() << "\n" << fuzzed;
    }
  }
  EXPECT_GT(refused, 500);
  EXPECT_EQ(read + refused, 3000);
}

// A box taken out of a ball, against the closed form where its sides are near.
TEST(StrokeFile, FieldsAreBrushes) {
  const Grid grid = ball_grid(20);
  Sculptor sculptor(grid);
  (void)sculptor.apply(
      parse_stroke("{op: difference, brush: {box: {size: [1, 1, 8]}}, path: [[0.03, 0.04, 0]]}",
                   "test"),
      Job());
  for (int z = -12; z <= 12; ++z) {
    for (int x = -7; x <= 7; ++x) {
      const double truth = 5 - std::abs(x - 0.3);
      EXPECT_NEAR(grid.value({x, 0, z}) / 0.1, glm::clamp(truth, -3.0, 3.0), 1e-4) << x << " " << z;
    }
  }
}

// Two shapes in one brush: only a bound inside, measured anew after the stroke.
TEST(StrokeFile, BoundsOfDistancesBecomeDistances) {
  const Grid grid = ball_grid(10);
  Sculptor sculptor(grid);
  const StrokeReport report = sculptor.apply(
      parse_stroke("{op: union, brush: {union: [{sphere: {radius: 0.8}}, {capsule: {from: [0,0,0], "
                   "to: [0,0,1.5], radius: 0.6}}]}, path: [[0.9, 0, 0]]}",
                   "test"),
      Job());
  EXPECT_GT(report.remeasured, 0U);
  const TwoBalls balls{{0, 0, 0}, {9, 0, 0}, 10, 8};
  for (int x = -12; x <= 20; ++x) {
    const double truth = glm::clamp(balls.unite({x, 0, -1}), -3.0, 3.0);
    if (balls.to_crease({x, 0, -1}) < std::abs(truth) + 2) continue;
    EXPECT_NEAR(grid.value({x, 0, -1}) / 0.1, truth, 0.05) << x;
  }
}

// A bound that is an eighth of the distance at its ends: cut into a ball, it must not move the
// ball's surface further away than the band is wide.
TEST(StrokeFile, AShallowBoundLeavesTheSurfaceBesideTheBrushAlone) {
  const Grid grid = ball_grid(20);
  const Content before = content_of(grid, 24);
  Sculptor sculptor(grid);
  (void)sculptor.apply(
      parse_stroke("{op: difference, brush: {ellipsoid_bound: {radii: [0.2, 1.6, 0.8]}}, path: "
                   "[[0, 0, 2]]}",
                   "test"),
      Job());
  const Content after = content_of(grid, 24);
  const Field brush = make_field("ellipsoid", {{"radii", {2, 16, 8}}});  // exact, in voxels
  int beside = 0;
  std::size_t i = 0;
  for (int x = -24; x <= 24; ++x) {
    for (int y = -24; y <= 24; ++y) {
      for (int z = -24; z <= 24; ++z, ++i) {
        const float distance = brush({x, y, z - 20});
        if (distance < -0.1F) {
          ASSERT_GT(after[i].first, 0) << x << " " << y << " " << z;
        }
        if (distance < 3.5F || std::abs(before[i].first) > 0.1F) continue;
        ASSERT_EQ(after[i].first, before[i].first) << x << " " << y << " " << z;
        ++beside;
      }
    }
  }
  EXPECT_GT(beside, 5000);
}

// Where the surface crosses the lattice's edges along z: column x, y to the crossings' places.
std::map<std::pair<int, int>, std::vector<double>> crossings_of(const Grid& grid, int extent) {
  std::map<std::pair<int, int>, std::vector<double>> all;
  for (int x = -extent; x <= extent; ++x) {
    for (int y = -extent; y <= extent; ++y) {
      for (int z = -extent; z < extent; ++z) {
        const double a = grid.value({x, y, z});
        const double b = grid.value({x, y, z + 1});
        if ((a < 0) != (b < 0)) all[{x, y}].push_back(z + a / (a - b));
      }
    }
  }
  return all;
}

// A bound that lies wholly within the model, a third of a voxel below its surface, adds nothing.
TEST(StrokeFile, ABoundWithinTheModelLeavesItsSurfaceAlone) {
  for (const std::string brush :
       {"{formula: {f: 'x^2+y^2+z^2-0.0906', bounds: [[-1, -1, -1], [1, 1, 1]]}}",
        "{ellipsoid_bound: {radii: [0.28, 0.299, 0.301]}}",
        "{twist: {turns: 0.5, of: {sphere: {radius: 0.301}}}}",
        "{union: [{sphere: {radius: 0.301}}, {box: {size: 0.2}}]}"}) {
    const Grid grid = ball_grid(30.47, 0.01);
    const auto before = crossings_of(grid, 34);
    (void)Sculptor(grid).apply(
        parse_stroke("{op: union, brush: " + brush + ", path: [[0, 0, 0]]}", "test"), Job());
    const auto after = crossings_of(grid, 34);
    double worst = 0;
    for (const auto& [column, places] : before) {
      ASSERT_EQ(after.at(column).size(), places.size());
      for (std::size_t i = 0; i < places.size(); ++i) {
        worst = std::max(worst, std::abs(after.at(column)[i] - places[i]));
      }
    }
    EXPECT_EQ(worst, 0) << brush;
  }
}

}  // namespace
}  // namespace sdfgrid
