// Making fields by name, and what is refused.
#include "sdfgrid/field/field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "sdfgrid/core/error.h"

namespace {

using sdfgrid::Error;
using sdfgrid::Field;
using sdfgrid::make_field;

std::string refusal(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), sdfgrid::ErrorKind::input);
    return error.what();
  }
  return "";
}

TEST(Field, EmptySpaceIsFarFromEverything) {
  EXPECT_EQ(Field()(glm::vec3(1)), 1e9F);
  EXPECT_TRUE(Field().bounds().empty());
}

TEST(Field, ValuesOfSomeSolids) {
  EXPECT_FLOAT_EQ(make_field("sphere", {{"radius", 2}})(glm::vec3(3, 4, 0)), 3);
  EXPECT_FLOAT_EQ(make_field("box", {{"size", {2, 4, 6}}})(glm::vec3(1.5, 0, 0)), 0.5);
  const Field moved = make_field("translate", {{"by", {1, 2, 3}}}, {make_field("sphere")});
  EXPECT_FLOAT_EQ(moved(glm::vec3(1, 2, 5)), 1);
  const Field turned =
      make_field("rotate", {{"by", {0, 0, 90}}}, {make_field("box", {{"size", {4, 1, 1}}})});
  EXPECT_FLOAT_EQ(turned(glm::vec3(0, 3, 0)), 1);
  EXPECT_FLOAT_EQ(make_field("infinite_cone", {{"angle", 45}})(glm::vec3(0, 0, 2)), 2);
}

TEST(Field, BoundsAreTight) {
  const Field f = make_field(
      "union", {},
      {make_field("sphere"), make_field("translate", {{"by", {3, 0, 0}}}, {make_field("torus")})});
  EXPECT_NEAR(f.bounds().lo.x, -1, 1e-4);
  EXPECT_NEAR(f.bounds().hi.x, 4.25, 1e-4);
  EXPECT_NEAR(f.bounds(0.5).hi.x, 4.75, 1e-4);
  EXPECT_NEAR(make_field("cone").bounds().hi.x, 1, 1e-4);
  EXPECT_NEAR(make_field("cone").bounds().lo.z, -1, 1e-4);
  EXPECT_NEAR(make_field("plane").bounds().hi.z, 0, 1e-6);
  EXPECT_EQ(make_field("plane").bounds().lo.z, -INFINITY);
}

TEST(Field, ManyNodesAreShallow) {
  std::vector<Field> balls;
  for (int i = 0; i < 1000; ++i) {
    balls.push_back(make_field("translate", {{"by", {i * 3.0, 0, 0}}}, {make_field("sphere")}));
  }
  const Field all = make_field("union", {}, balls);
  EXPECT_EQ(all.size(), 1999U);  // a moved leaf is one instruction
  EXPECT_FLOAT_EQ(all(glm::vec3(300, 3, 0)), 2);
  EXPECT_FLOAT_EQ(make_field("difference", {}, balls)(glm::vec3(0, 0, 0)), -1);
  EXPECT_EQ(all.pruned({glm::dvec3(299, -1, -1), glm::dvec3(301, 1, 1)}).size(), 1U);
}

TEST(Field, TheSurfaceThatIsHitBringsItsMark) {
  const Field box = make_field("box", {{"size", {2, 2, 2}}}).tagged(3);
  const Field ball = make_field("sphere", {{"radius", 1.2}}).tagged(5);
  const Field cut = make_field("difference", {}, {box, ball}).tagged(9);
  EXPECT_EQ(cut.tag_at(glm::dvec3(1, 0.9, 0.9)), 3);
  EXPECT_EQ(cut.tag_at(glm::dvec3(0.69, 0.69, 0.69)), 5);
  EXPECT_EQ(make_field("union", {}, {box, ball}).tag_at(glm::dvec3(1.2, 0, 0)), 5);
  EXPECT_EQ(make_field("sphere").tag_at(glm::dvec3(1, 0, 0)), -1);
}

TEST(Field, RefusesWithOpAndRemedy) {
  EXPECT_EQ(refusal([] { (void)make_field("spere"); }), "there is no op `spere`");
  EXPECT_EQ(refusal([] {
              (void)make_field("sphere", {{"size", 1}});
            }),
            "sphere: there is no parameter `size`; it has `radius`");
  EXPECT_EQ(refusal([] {
              (void)make_field("sphere", {{"radius", -1}});
            }),
            "sphere: `radius` is -1; give a value from 1e-06 to 1e+09");
  EXPECT_EQ(refusal([] {
              (void)make_field("box", {{"size", {1, 2}}});
            }),
            "box: `size` has 2 numbers; give 3");
  EXPECT_EQ(refusal([] {
              (void)make_field("sphere", {{"radius", NAN}});
            }),
            "sphere: `radius` is not a finite number");
  EXPECT_NE(refusal([] { (void)make_field("union"); }), "");
  EXPECT_NE(refusal([] { (void)make_field("plane", {{"normal", {0, 0, 0}}}); }), "");
  EXPECT_NE(refusal([] {
              (void)make_field("linear", {{"matrix", {1, 0, 0, 1, 0, 0, 0, 0, 1}}},
                               {make_field("sphere")});
            }),
            "");
  EXPECT_NE(refusal([] {
              (void)make_field("repeat", {{"cell", {1, 1, 1}}}, {make_field("sphere")});
            }),
            "");
  EXPECT_NE(refusal([] {
              (void)make_field("hyperize", {{"exponents", {0.5, 1, 1}}}, {make_field("sphere")});
            }),
            "");
}

TEST(Field, RefusesDeepNesting) {
  const auto nest = [](const char* op, int levels,
                       const std::vector<sdfgrid::Argument>& arguments = {}) {
    Field f = make_field("sphere");
    for (int i = 0; i < levels; ++i) f = make_field(op, arguments, {f});
    return f;
  };
  EXPECT_EQ(refusal([&] { (void)nest("offset", 300); }), "");
  EXPECT_NE(refusal([&] { (void)nest("offset", 20000); }), "");
  EXPECT_NE(refusal([&] { (void)nest("rotate", 20000, {{"by", {1, 0, 0}}}); }), "");
  EXPECT_EQ(nest("rotate", 20000).size(), 1U);  // by nothing
}

}  // namespace
