// Repetition against the copies themselves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "field/pairs.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/field/field.h"

namespace sdfgrid {
namespace {

using Cell = std::vector<double>;

struct Repeated {
  const char* name;
  Cell cell;
  Field node;
};

std::vector<Repeated> tight_ones() {
  const Field ball = make_field("sphere", {{"radius", 0.29}});
  const Field aside =
      make_field("capsule", {{"from", {-0.2, -0.1, 0}}, {"to", {0.1, 0.2, 0.3}}, {"radius", 0.08}});
  const Field two = make_field("union", {},
                               {make_field("translate", {{"by", {0.15, 0.15, -0.1}}},
                                           {make_field("box", {{"size", {0.28, 0.28, 0.3}}})}),
                                make_field("translate", {{"by", {-0.2, -0.1, 0}}},
                                           {make_field("sphere", {{"radius", 0.05}})})});
  return {{"balls", {0.6, 0.6, 0.6}, ball},
          {"wall of balls", {0.6, 0, 0.6}, ball},
          {"row of balls", {0, 0.6, 0}, ball},
          {"capsules aside", {0.6, 0.6, 0}, aside},
          {"capsules close along z only", {2, 2, 0.78}, aside},
          {"two solids", {0.6, 0.6, 0.9}, two}};
}

Field repeated(const Repeated& of) { return make_field("repeat", {{"cell", of.cell}}, {of.node}); }

// All copies in the five nearest cells along each axis.
float nearest_copy(const Repeated& of, const glm::vec3& p) {
  float least = 1e9F;
  for (int i = 0; i < 125; ++i) {
    glm::vec3 q = p;
    for (int a = 0; a < 3; ++a) {
      const int cell = (a == 0 ? i / 25 : a == 1 ? i / 5 % 5 : i % 5) - 2;
      const auto edge = static_cast<float>(of.cell[a]);
      if (edge == 0 && cell != 0) q[a] = 1e6F;
      if (edge > 0) q[a] -= edge * (std::floor(p[a] / edge + 0.5F) + static_cast<float>(cell));
    }
    least = std::min(least, of.node(q));
  }
  return least;
}

TEST(Repeat, OfWhatIsCloseToItsWallsIsTheUnionOfTheCopies) {
  std::mt19937 random(41);
  std::uniform_real_distribution<float> at(-1.5F, 1.5F);
  for (const Repeated& of : tight_ones()) {
    SCOPED_TRACE(of.name);
    const Field field = repeated(of);
    const auto edge = [&](int a) { return of.cell[a] > 0 ? of.cell[a] : 1e9; };
    const double half = 0.5 * std::min({edge(0), edge(1), edge(2)});
    int equal = 0;
    for (int i = 0; i < 6000; ++i) {
      const glm::vec3 p(at(random), at(random), at(random));
      const float least = nearest_copy(of, p);
      const float value = field(p);
      ASSERT_LE(value, least + 1e-6F) << p.x << " " << p.y << " " << p.z;
      if (least > half) continue;
      ++equal;
      ASSERT_NEAR(value, least, 1e-6F) << p.x << " " << p.y << " " << p.z;
    }
    EXPECT_GT(equal, 500);
    EXPECT_LE(pair_excess(field, {glm::dvec3(-1.5), glm::dvec3(1.5)}), 2 * kRounding);
  }
}

// Beyond its cell such a value may be small, and another on the other side of the cell's middle.
TEST(Repeat, IsNoSteeperOfNodesWhoseValuesAreBounds) {
  const Field flat = make_field(
      "translate", {{"by", {0.05, 0, 0.1}}},
      {make_field("scale", {{"by", {1, 1, 0.2}}}, {make_field("sphere", {{"radius", 0.24}})})});
  const Field field = make_field("repeat", {{"cell", {0.6, 0.6, 0.6}}}, {flat});
  EXPECT_GT(field.size(), 8 * flat.size());
  EXPECT_LE(pair_excess(field, {glm::dvec3(-1), glm::dvec3(1)}), 2 * kRounding);
}

// As long as the copies that grow do not reach over half a cell.
TEST(Repeat, OffsetsReachAcrossTheWalls) {
  std::mt19937 random(42);
  std::uniform_real_distribution<float> at(-0.9F, 0.9F);
  for (const Repeated& of : tight_ones()) {
    SCOPED_TRACE(of.name);
    constexpr float kBy = 0.06F;  // more than the gaps
    constexpr int kPoints = 6000;
    const Field grown = make_field("offset", {{"by", kBy}}, {repeated(of)});
    int outside = 0;
    for (int i = 0; i < kPoints; ++i) {
      const glm::vec3 p(at(random), at(random), at(random));
      const float least = nearest_copy(of, p) - kBy;
      if (std::fabs(least) < 1e-5F) continue;
      outside += least > 0 ? 1 : 0;
      ASSERT_EQ(grown(p) < 0, least < 0) << p.x << " " << p.y << " " << p.z << ": " << least;
    }
    EXPECT_GT(outside, kPoints / 5);
    EXPECT_GT(kPoints - outside, kPoints / 100);
  }
}

TEST(Repeat, OfRoomyCellsAndOfLongProgramsIsOneCopy) {
  const Field ball = make_field("sphere", {{"radius", 0.3}});
  EXPECT_EQ(make_field("repeat", {{"cell", {2, 2, 2}}}, {ball}).size(), ball.size() + 2);
  std::vector<Field> many;
  many.reserve(200);
  for (int i = 0; i < 200; ++i) {
    many.push_back(make_field("translate", {{"by", {0.001 * i, 0, 0}}}, {ball}));
  }
  const Field long_one = make_field("union", {}, many);
  const Field rows = make_field("repeat", {{"cell", {0, 0.61, 0}}}, {long_one});
  EXPECT_LT(rows.size(), 2 * long_one.size());
  const Box box{glm::dvec3(-1), glm::dvec3(1)};
  const auto values = [&](Points& at) { at.evaluate(rows); };
  EXPECT_LE(pair_excess(values, box, 1, 2000), 2 * kRounding);
}

// Intervals alone say nothing of an orbit.
TEST(Repeat, TakesWhatOnlyItsBoundsProveToBeWithinTheCell) {
  const Field bulb = make_field("mandelbulb");
  EXPECT_GT(make_field("repeat", {{"cell", {2.5, 2.5, 2.5}}}, {bulb})({1.25F, 1.25F, 1.25F}), 0);
}

TEST(Repeat, OfWhatTouchesItsCellSaysSo) {
  const Field ball = make_field("sphere", {{"radius", 0.5}});
  try {
    (void)make_field("repeat", {{"cell", {1, 1, 1}}}, {ball});
    ADD_FAILURE() << "not refused";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("touches the walls of its cell along x"),
              std::string::npos)
        << e.what();
  }
}

}  // namespace
}  // namespace sdfgrid
