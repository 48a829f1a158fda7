// What scene files mean, and that saving keeps it.
#include "sdfgrid/scene/scene.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "app/process.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/sculptor.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/grid/convert_field.h"
#include "sdfgrid/image/image.h"
#include "sdfgrid/mesh/read.h"
#include "sdfgrid/scene/build.h"
#include "sdfgrid/trace/atlas_seen.h"

namespace sdfgrid {
namespace {

const char* const kScene = R"yaml(# a comment
sdfgrid: 1
camera: {eye: [3, 2, 4], target: [0, 0, 0], fov: 40}
materials: {clay: {diffuse: [0.8, 0.6, 0.5], specular: 0.3, exponent: 64}, tin: {specular: 0.5}}
scene:
  - difference:
      - box: {size: [2, 2, 2]}
        material: clay
      - smooth_union:
          k: 0.2
          of: [{sphere: {radius: 1.2}}, {capsule: {from: [0,-2,0], to: [0,2,0], radius: 0.4}}]
        material: tin
  - torus: {major: "1 + t", minor: 0.25}
    name: "ring: \"the\" one"
    at: [0, "cos(2*pi*t)", 4]
    rotate: [0, 45, 0]
    scale: 2
)yaml";

SceneModel build(const std::string& text, double time = 0) {
  const SceneFile file = parse_scene(text, "test.yaml");
  EXPECT_TRUE(file.warnings.empty()) << file.warnings.front();
  return build_scene(file.scene, "test.yaml", time, Job());
}

// Values at some thousand points that are the same for all.
std::vector<float> values(const Field& field) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> at(-6, 6);
  std::vector<float> out;
  for (int i = 0; i < 2000; ++i) {
    const float x = at(random);
    const float y = at(random);
    out.push_back(field({x, y, at(random)}));
  }
  return out;
}

TEST(Scene, IsTheFieldThatItsWordsSay) {
  const SceneModel model = build(kScene, 0.25);
  const Field box = make_field("box", {{"size", {2, 2, 2}}});
  const Field tool = make_field(
      "smooth_union", {{"k", 0.2}},
      {make_field("sphere", {{"radius", 1.2}}),
       make_field("capsule", {{"from", {0, -2, 0}}, {"to", {0, 2, 0}}, {"radius", 0.4}})});
  Field ring = make_field("torus", {{"major", 1.25}, {"minor", 0.25}});
  ring = make_field("scale", {{"by", {2, 2, 2}}}, {ring});
  ring = make_field("rotate", {{"by", {0, 45, 0}}}, {ring});
  ring = make_field("translate", {{"by", {0, std::cos(std::acos(0.0)), 4}}}, {ring});
  const Field all = make_field("union", {}, {make_field("difference", {}, {box, tool}), ring});
  EXPECT_EQ(values(model.field), values(all));
  EXPECT_EQ(*model.camera.eye, glm::dvec3(3, 2, 4));
  EXPECT_FALSE(model.camera.up.has_value());
  EXPECT_EQ(*model.camera.fov, 40);
}

TEST(Scene, TheSurfaceThatIsHitBringsItsMaterial) {
  const SceneModel model = build(kScene);
  ASSERT_EQ(model.materials.size(), 2U);
  EXPECT_EQ(model.materials[0].diffuse, glm::vec3(0.8F, 0.6F, 0.5F));
  EXPECT_EQ(model.materials[0].exponent, 64);
  EXPECT_EQ(model.materials[1].diffuse, Material().diffuse);
  EXPECT_EQ(model.field.tag_at({1, 0.95, 0.95}), 0);
  EXPECT_EQ(model.field.tag_at({0.7, 0.7, 0.7}), 1);  // where the tool has cut
  EXPECT_EQ(model.field.tag_at({2.5, 1, 4}), -1);     // the ring has none
}

TEST(Scene, InnerMaterialsWinOverOuterOnes) {
  const SceneModel model = build(R"(
sdfgrid: 1
materials: {a: {}, b: {}}
scene:
  union: [{sphere: {}, material: b}, {sphere: {}, at: [5, 0, 0]}]
  material: a
)");
  EXPECT_EQ(model.field.tag_at({1, 0, 0}), 1);
  EXPECT_EQ(model.field.tag_at({6, 0, 0}), 0);
}

TEST(Scene, EveryOpHasItsWord) {
  for (const OpEntry& op : op_list()) {
    const std::string text = std::string("sdfgrid: 1\nscene: [{") + op.info->example + "}]";
    const SceneFile file = parse_scene(text, "example");
    EXPECT_TRUE(file.warnings.empty()) << file.warnings.front();
    ASSERT_EQ(file.scene.nodes.size(), 1U);
    const Field field = build_scene(file.scene, "example", 0, Job()).field;
    for (const float v : values(field)) ASSERT_TRUE(std::isfinite(v)) << op.info->name;
    const SceneFile again = parse_scene(scene_text(file.scene), "again");
    EXPECT_EQ(again.scene, file.scene) << scene_text(file.scene);
  }
}

TEST(Scene, SavedAndLoadedItIsTheSame) {
  const SceneFile first = parse_scene(kScene, "a");
  const std::string saved = scene_text(first.scene);
  const SceneFile second = parse_scene(saved, "b");
  EXPECT_TRUE(second.warnings.empty()) << second.warnings.front();
  EXPECT_EQ(second.scene, first.scene) << saved;
  EXPECT_EQ(scene_text(second.scene), saved);
  EXPECT_EQ(values(build(saved, 0.1).field), values(build(kScene, 0.1).field));
  Scene other = second.scene;
  other.nodes[0].of[0].values[0].numbers[0].value += 1e-15;
  EXPECT_NE(other, first.scene);
}

TEST(Scene, NumbersAndTextsSurviveSaving) {
  Scene scene;
  SceneNode node;
  node.op = "grid";
  node.values = {{"file", {}, "a \"b\"\\c\n\t: {é} #d.vdb", true}};
  node.at = {{0.1 + 0.2, ""}, {-1e-300, ""}, {1e300, ""}};
  node.name = "no";
  scene.nodes = {node};
  EXPECT_EQ(parse_scene(scene_text(scene), "x").scene, scene) << scene_text(scene);
  EXPECT_EQ(parse_scene(scene_text(Scene()), "x").scene, Scene());
}

TEST(Scene, InfinityIsAnExponent) {
  const std::string text = "sdfgrid: 1\nscene: {gdf: {solid: cube, exponent: .inf, radius: 0.5}}\n";
  const SceneFile file = parse_scene(text, "a");
  EXPECT_EQ(parse_scene(scene_text(file.scene), "b").scene, file.scene) << scene_text(file.scene);
  // A cube within its faces.
  EXPECT_NEAR(build(text).field({0.9F, 0.2F, -0.1F}), 0.4, 1e-5);
}

TEST(Scene, JsonIsYaml) {
  const SceneModel model = build(
      "{\n\t\"scene\": [{\"sphere\": {\"radius\": 2}, \"at\": [1, 0, 0]}],\n\t\"sdfgrid\": 1\n}\n");
  EXPECT_FLOAT_EQ(model.field({4, 0, 0}), 1);
}

TEST(Scene, AliasesAreCopies) {
  const SceneModel model =
      build("sdfgrid: 1\nscene: [{sphere: &size {radius: 2}}, {sphere: *size, at: [9, 0, 0]}]\n");
  EXPECT_FLOAT_EQ(model.field({12, 0, 0}), 1);
}

TEST(Scene, RotateAndScaleAreOpsToo) {
  const SceneModel model = build(
      "sdfgrid: 1\nscene: {rotate: {by: [0, 0, 90], of: {box: {size: [4, 1, 1]}}}, scale: 2}\n");
  EXPECT_FLOAT_EQ(model.field({0, 5, 0}), 1);
}

TEST(Scene, WordsItDoesNotKnowAreLeftOutWithAWarning) {
  const SceneFile file = parse_scene(R"(sdfgrid: 1
camra: {eye: [1, 2, 3]}
materials: {clay: {difuse: [1, 0, 0]}}
scene:
  - spere: {radius: 9}
  - sphere: {radus: 9}
    material: clya
    att: [1, 2, 3]
  - box: {size: [1, 1, 1]}
)",
                                     "s.yaml");
  const std::vector<std::string> expected = {
      "s.yaml: line 2: a scene knows no `camra`; did you mean `camera`? left out",
      "s.yaml: line 3: material `clay` knows no `difuse`; did you mean `diffuse`? left out",
      "s.yaml: line 5: a node knows no `spere`; did you mean `sphere`? left out",
      "s.yaml: line 6: `sphere` knows no `radus`; did you mean `radius`? left out",
      "s.yaml: line 7: the list of materials knows no `clya`; did you mean `clay`? left out",
      "s.yaml: line 8: a node knows no `att`; did you mean `at`? left out"};
  EXPECT_EQ(file.warnings, expected);
  EXPECT_EQ(file.scene.nodes.size(), 2U);
}

TEST(Scene, NewerFormatsAreReadAsFarAsTheyAreKnown) {
  const SceneFile file = parse_scene("sdfgrid: 2\nlights: {}\nscene: {sphere: {}}\n", "s");
  EXPECT_EQ(file.warnings.size(), 2U);
  EXPECT_EQ(file.scene.nodes.size(), 1U);
}

// A saved scene does not claim to be of an older format than the words that it was read with.
TEST(Scene, NewerFormatsAreSavedAsSuch) {
  for (const char* version : {"1", "2", "2.5", "1000000"}) {
    const std::string head = fmt::format("sdfgrid: {}\n", version);
    const Scene scene = parse_scene(head + "scene: {sphere: {}}\n", "s").scene;
    const std::string saved = scene_text(scene);
    EXPECT_EQ(saved.substr(0, head.size()), head);
    EXPECT_EQ(parse_scene(saved, "again").scene, scene);
  }
  EXPECT_EQ(scene_text(Scene()).substr(0, 11), "sdfgrid: 1\n");
  EXPECT_NE(parse_scene("sdfgrid: 2\nscene: []\n", "s").scene, Scene());
}

// What is left out may not turn the rest into another solid.
TEST(Scene, NodesThatNeedAnUnknownOneAreLeftOutWithIt) {
  const auto nodes = [](const std::string& scene) {
    return parse_scene("sdfgrid: 1\nscene: " + scene + "\n", "s").scene.nodes;
  };
  EXPECT_TRUE(nodes("{difference: [{spere: {}}, {box: {}}]}").empty());
  EXPECT_TRUE(nodes("{morph: {of: [{sphere: {}}, {bocks: {}}]}}").empty());
  EXPECT_EQ(nodes("{difference: [{box: {}}, {spere: {}}]}").size(), 1U);
  EXPECT_EQ(nodes("{union: [{spere: {}}, {box: {}}]}").size(), 1U);
}

TEST(Scene, FilesAreRelativeToIt) {
  const test::Folder folder;
  const std::string mesh = folder.write("cube.off", test::cube_off());
  ConvertOptions options;
  options.dim = 32;
  write_grid(convert_mesh(read_mesh(mesh, Job()).soup, options, Job()).grid,
             folder.path("cube.vdb"));
  const std::string path = folder.write("s.yaml", R"(
sdfgrid: 1
scene:
  - difference: [{grid: {file: cube.vdb}}, {sphere: {radius: 0.3}, at: [1, 1, 1]}]
  - mesh: {file: cube.off, dim: 32}
    at: [5, 0, 0]
)");
  const SceneFile file = read_scene(path);
  const Field field = build_scene(file.scene, path, 0, Job()).field;
  EXPECT_NEAR(field({1.04F, 0.5F, 0.5F}), 0.04, 0.02);
  EXPECT_LT(field({0.97F, 0.5F, 0.5F}), 0);
  EXPECT_GT(field({0.95F, 0.95F, 0.95F}), 0);
  EXPECT_LT(field({5.97F, 0.5F, 0.5F}), 0);
  // Nowhere more than the distance, nowhere steeper than 1.
  std::mt19937 random(3);
  std::uniform_real_distribution<float> at(-1, 2);
  glm::vec3 last(0);
  for (int i = 0; i < 20000; ++i) {
    const glm::vec3 p(at(random), at(random), at(random));
    const glm::vec3 q = (i & 1) != 0 ? last : p + 0.02F * (last - p);
    const glm::vec3 d = p - q;
    ASSERT_LE(std::fabs(field(p) - field(q)), std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z) + 1e-5);
    last = p;
  }
}

// The materials of painted parts: the scene's of that number, else those that a grid alone shows;
// what is not painted has its node's.
TEST(Scene, AGridBringsItsPaint) {
  const test::Folder folder;
  FieldConvertOptions options;
  options.dim = 40;
  const Grid grid = convert_field(make_field("sphere"), options, Job()).grid;
  Sculptor sculptor(grid);
  for (const int material : {3, 7}) {
    Stroke stroke;
    stroke.op = StrokeOp::paint;
    stroke.material = material;
    stroke.brush.radius = 0.4;
    stroke.path = {{material == 3 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)}};
    (void)sculptor.apply(stroke, Job());
  }
  write_grid(grid, folder.path("ball.vdb"));
  const std::string path = folder.write("s.yaml", R"(
sdfgrid: 1
materials: {clay: {}, "7": {diffuse: [0.1, 0.2, 0.3]}}
scene:
  difference:
    - grid: {file: ball.vdb}
      material: clay
      at: [5, 0, 0]
      scale: 2
    - {sphere: {radius: 0.5}, at: [7, 0, 0]}
)");
  const SceneModel model = build_scene(read_scene(path).scene, path, 0, Job());
  ASSERT_EQ(model.materials.size(), 3U);
  EXPECT_EQ(model.materials[1].diffuse, glm::vec3(0.1F, 0.2F, 0.3F));
  EXPECT_EQ(model.materials[2].diffuse, paint_look(3).diffuse);
  const double x = 2 * std::cos(0.3);
  const double y = 2 * std::sin(0.3);
  EXPECT_EQ(model.field.tag_at({5 + x, y, 0}), 2);  // painted with 3
  EXPECT_EQ(model.field.tag_at({5 + y, x, 0}), 1);  // and with 7
  EXPECT_EQ(model.field.tag_at({5, 0, 2}), 0);      // not at all
  EXPECT_EQ(model.field.tag_at({6.5, 0, 0}), -1);   // cut by the ball, which has no material
  EXPECT_EQ(model.field.pruned({glm::dvec3(5 + x, y, -0.1), glm::dvec3(5 + x, y, 0.1)})
                .tag_at({5 + x, y, 0}),
            2);
}

// A picture in a file is its grey values as they are stored, whatever its channels.
TEST(Scene, TexturesArePictures) {
  const test::Folder folder;
  Image grey{4, 3, {"Y"}, {}};
  for (int i = 0; i < 12; ++i) grey.pixels.push_back(static_cast<float>(i * 5 % 12) / 12.0F);
  Image coloured{4, 3, {"R", "G", "B", "A"}, {}};
  std::string samples;
  for (const float v : grey.pixels) {
    for (const float share : {0.5F, 1.0F, 1.5F}) coloured.pixels.push_back(v * share);
    coloured.pixels.push_back(1);
    samples += fmt::format("{}{}", samples.empty() ? "" : ", ", v);
  }
  write_image(folder.path("grey.exr"), grey);
  write_image(folder.path("coloured.exr"), coloured);
  const auto field = [&](const std::string& texture) {
    const std::string path =
        folder.write("s.yaml", "sdfgrid: 1\nscene: {texture_displace: {" + texture +
                                   ", amplitude: 0.2, of: {box: {size: [3, 3, 1]}}}}\n");
    return build_scene(read_scene(path).scene, path, 0, Job()).field;
  };
  const auto expected = values(field("width: 4, samples: [" + samples + "]"));
  EXPECT_EQ(values(field("file: grey.exr")), expected);
  const auto same = values(field("file: coloured.exr"));
  for (std::size_t i = 0; i < same.size(); ++i) ASSERT_NEAR(same[i], expected[i], 1e-6);
  // 8 bits and sRGB: the code value counts. Dithered, so within one of 255.
  Image half{2, 2, {"R", "G", "B"}, std::vector<float>(12, linear_from_srgb(0.5F))};
  write_image(folder.path("half.png"), half);
  const Field flat = field("file: half.png");
  EXPECT_NEAR(flat({0, 0, 0.6F}), 0, 1e-3);
  EXPECT_THROW((void)field("file: nowhere.png"), Error);
  EXPECT_THROW((void)field("size: 2"), Error);
}

// In numbers, and in formulas of position unless they are told another time.
TEST(Scene, TimeIsThatOfTheFrame) {
  const auto at = [](const std::string& node, double time) {
    return build("sdfgrid: 1\nscene: {" + node + "}\n", time).field;
  };
  const std::string ball = "formula: {f: \"x^2+y^2+z^2-(1+t)^2\", bounds: [[-3,-3,-3],[3,3,3]]}";
  EXPECT_LT(at(ball, 0.5)({1.49F, 0, 0}), 0);
  EXPECT_GT(at(ball, 0.5)({1.51F, 0, 0}), 0);
  EXPECT_GT(at(ball, 0)({1.01F, 0, 0}), 0);
  const std::string own = "function: {f: \"0.5+t\", t: 0.25}";
  EXPECT_FLOAT_EQ(at(own, 9)({1, 0, 0}), 0.25F);
  const std::string waves = "formula_displace: {f: \"t/10\", of: {sphere: {radius: 1}}}";
  EXPECT_GT(at(waves, 0)({1.05F, 0, 0}), 0);
  EXPECT_LT(at(waves, 1)({1.05F, 0, 0}), 0);
  EXPECT_FLOAT_EQ(at("sphere: {radius: \"1+t\"}", 2)({4, 0, 0}), 1);
}

TEST(Scene, PointsAreReadFromFiles) {
  const test::Folder folder;
  (void)folder.write("p.xyz", "# three\n0 0 0\n1.5, 0, 0\n\n  -1e0\t2 3 # last\n");
  const auto field = [&](const std::string& file) {
    const std::string path =
        folder.write("s.yaml", "sdfgrid: 1\nscene: {points: {file: " + file + ", radius: 0.25}}\n");
    return build_scene(read_scene(path).scene, path, 0, Job()).field;
  };
  const Field listed =
      make_field("points", {{"points", {0, 0, 0, 1.5, 0, 0, -1, 2, 3}}, {"radius", 0.25}});
  EXPECT_EQ(values(field("p.xyz")), values(listed));
  (void)folder.write("bad.xyz", "0 0 0\n1 2 x\n");
  try {
    (void)field("bad.xyz");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("bad.xyz: line 2"), std::string::npos) << error.what();
  }
  (void)folder.write("empty.xyz", "# nothing\n");
  EXPECT_THROW((void)field("empty.xyz"), Error);
}

TEST(Scene, DisplaceIsAnotherWayToWriteIt) {
  const auto read = [](const std::string& node) {
    const SceneFile file = parse_scene("sdfgrid: 1\nscene: {" + node + "}\n", "s.yaml");
    EXPECT_TRUE(file.warnings.empty()) << file.warnings.front();
    return file.scene;
  };
  EXPECT_EQ(read("displace: {by: {noise: {amplitude: 0.1, seed: 2}}, of: {sphere: {}}}"),
            read("noise_displace: {amplitude: 0.1, seed: 2, of: {sphere: {}}}"));
  EXPECT_EQ(read("displace: {by: {formula: {f: \"0.1*x\"}}, of: {sphere: {}}}"),
            read("formula_displace: {f: \"0.1*x\", of: {sphere: {}}}"));
  EXPECT_EQ(read("displace: {by: {texture: {file: a.png}}, of: {sphere: {}}}"),
            read("texture_displace: {file: a.png, of: {sphere: {}}}"));
  EXPECT_THROW(read("displace: {by: {nois: {}}, of: {sphere: {}}}"), Error);
  EXPECT_THROW(read("displace: {of: {sphere: {}}}"), Error);
  EXPECT_THROW(read("displace: 3"), Error);
}

TEST(Scene, WhatTakesTwoNodesTakesNoThird) {
  for (const char* op : {"blend", "morph", "spatial_morph", "partition"}) {
    const std::string three = "{of: [{sphere: {}}, {box: {}}, {torus: {}}]}";
    const SceneFile file =
        parse_scene(fmt::format("sdfgrid: 1\nscene: {{{}: {}}}\n", op, three), "s.yaml");
    try {
      (void)build_scene(file.scene, "s.yaml", 0, Job());
      FAIL() << op;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("give two, or nest it"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace sdfgrid
