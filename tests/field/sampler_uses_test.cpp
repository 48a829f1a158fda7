// Which values of a grid or mesh below other ops matter: beyond them it may be cut off.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <random>

#include "sdfgrid/field/field.h"

namespace sdfgrid {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Ball {
  glm::dvec3 center;
  double radius;
};
const Ball kBalls[] = {{{-0.4, 0, 0}, 0.8}, {{0.5, 0.1, 0}, 0.7}};

// A ball whose values end at `lo` and `hi`, as those of a grid do at the end of its band.
class CutBall : public Sampler {
 public:
  explicit CutBall(const Ball& ball, double lo = -kInfinity, double hi = kInfinity)
      : ball_(ball), lo_(lo), hi_(hi) {}
  void evaluate(int n, const float* x, const float* y, const float* z, float* out) const override {
    for (int i = 0; i < n; ++i) out[i] = static_cast<float>(value({x[i], y[i], z[i]}));
  }
  [[nodiscard]] Box hull() const override {
    return {ball_.center - ball_.radius, ball_.center + ball_.radius};
  }
  [[nodiscard]] double value(const glm::dvec3& p) const override {
    const double cut = std::clamp(glm::distance(p, ball_.center) - ball_.radius, lo_, hi_);
    const double beyond = glm::distance(p, glm::clamp(p, hull().lo, hull().hi));
    return beyond > 0 ? std::max(cut, beyond) : cut;
  }
  [[nodiscard]] double step() const override { return 1e-4; }

 private:
  Ball ball_;
  double lo_, hi_;
};

using Balls = std::vector<std::shared_ptr<const Sampler>>;

Balls whole_balls() {
  return {std::make_shared<CutBall>(kBalls[0]), std::make_shared<CutBall>(kBalls[1])};
}

SamplerUse use_of(const Field& field) {
  const std::vector<SamplerUse> uses = field.sampler_uses();
  EXPECT_EQ(uses.size(), 1U);
  return uses.at(0);
}

Field offset(double by, const Field& of) { return make_field("offset", {{"by", by}}, {of}); }

// A ball whose values beyond its surface are half the distance to that.
class FlatBall : public CutBall {
 public:
  explicit FlatBall(const Ball& ball) : CutBall(ball) {}
  void evaluate(int n, const float* x, const float* y, const float* z, float* out) const override {
    for (int i = 0; i < n; ++i) out[i] = static_cast<float>(value({x[i], y[i], z[i]}));
  }
  [[nodiscard]] Box bounds(double level) const override {
    return CutBall::bounds(level > 0 ? 2 * level : level);
  }
  [[nodiscard]] double value(const glm::dvec3& p) const override {
    return value_at(CutBall::value(p));
  }
  [[nodiscard]] double value_at(double distance) const override {
    return distance > 0 ? 0.5 * distance : distance;
  }
};

// However files are joined, moved and joined again, offsets outwards are as wide as they say.
TEST(Offsets, OfUnionsOfFilesAreExactHoweverTheseAreMoved) {
  const Ball ball{glm::dvec3(0), 0.3};
  const Field file = make_field(std::make_shared<FlatBall>(ball));
  const auto at = [](double x, double y, const Field& of) {
    return make_field("translate", {{"by", {x, y, 0}}}, {of});
  };
  const Field pair = make_field("union", {}, {at(-1, 0, file), at(1, 0, file)});
  const Field larger = make_field("scale", {{"by", {2, 2, 2}}}, {pair});
  const Field turned = make_field("rotate", {{"by", {0, 0, 90}}}, {larger});
  const Field group = make_field("union", {}, {at(3, 1, turned), at(0, 1, make_field("sphere"))});
  std::vector<Field> many = {at(0, 5, group)};
  std::vector<Ball> balls = {{{3, 4, 0}, 0.6}, {{3, 8, 0}, 0.6}, {{0, 6, 0}, 1}};
  const Field other = make_field("sphere", {{"radius", ball.radius}});
  for (int i = 0; i < 20; ++i) {
    const int row = i / 5;
    balls.push_back({{i % 5 * 1.5 - 3, row * 1.5 - 3, 0}, ball.radius});
    many.push_back(at(balls.back().center.x, balls.back().center.y, i % 3 == 0 ? other : file));
  }
  constexpr double kBy = 0.25;
  const Field grown = offset(kBy, at(0.5, 0, make_field("union", {}, many)));
  std::mt19937 random(33);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int i = 0; i < 40000; ++i) {
    const glm::vec3 p(5 * unit(random), 3 + 7 * unit(random), unit(random));
    double least = kInfinity;
    for (const Ball& b : balls) {
      const glm::dvec3 center = b.center + glm::dvec3(0.5, 0, 0);
      least = std::min(least, glm::distance(glm::dvec3(p), center) - b.radius);
    }
    if (std::fabs(least - kBy) < 1e-3) continue;
    ASSERT_EQ(grown(p) < 0, least < kBy) << p.x << " " << p.y << " " << p.z << ": " << least;
  }
}

TEST(SamplerUses, DifferencesTurnTheSignHoweverDeepTheyAreNested) {
  for (const char* op : {"difference", "smooth_difference"}) {
    Field field = make_field(whole_balls()[0]);
    for (int depth = 1; depth <= 6; ++depth) {
      field = make_field(op, {}, {make_field("box"), field});
      const SamplerUse use = use_of(offset(0.5, field));
      const double inside = depth % 2 == 1 ? use.lo : -use.hi;
      const double outside = depth % 2 == 1 ? use.hi : -use.lo;
      EXPECT_LE(inside, -0.5) << op << " " << depth;
      EXPECT_GE(outside, -0.25) << op << " " << depth;  // the width of two blends
    }
  }
}

TEST(SamplerUses, BlendsOfOneListAskForTwoAtMost) {
  Field field = make_field(whole_balls()[0]);
  for (int depth = 1; depth <= 6; ++depth) {
    field = make_field("smooth_union", {{"k", 0.1}}, {make_field("box"), field});
    EXPECT_NEAR(use_of(field).hi, 0.1 * std::min(depth, 2), 1e-6);
  }
}

// Every op, of two balls, with and without an offset around it: is what it makes of them the same
// where they are cut off beyond what it asks for?
class OpOfTwoBalls : public testing::TestWithParam<const OpEntry*> {};

std::vector<Argument> arguments_of(const OpInfo& op) {
  const std::string_view name = op.name;
  if (name == "formula_displace") {
    return {{"f", "0.2 * sin(3*x) * cos(2*y) - 0.1"}, {"largest", 0.25}};
  }
  if (name == "texture_displace") {
    return {{"width", 2.0}, {"samples", {0, 1, 1, 0.3}}, {"size", {2, 2}}, {"amplitude", -0.2}};
  }
  if (name == "noise_displace") return {{"amplitude", 0.2}};
  if (name == "repeat") return {{"cell", {6, 6, 6}}};
  if (name == "twist") return {{"turns", 0.1}};
  if (name == "mirror") return {{"planes", {0, 1, 1}}};
  if (name == "scale") return {{"by", {1, 0.5, 2}}};
  if (name == "linear") return {{"matrix", {1, 0.5, 0, 0, 1, 0, 0, 0, 0.7}}};
  if (name == "blend") return {{"radii", {0.5, 0.4}}};
  if (name == "hyperize") return {{"exponents", {1.5, 1, 1}}};
  return {};
}

TEST_P(OpOfTwoBalls, AskForAllThatMatters) {
  const OpInfo& op = *GetParam()->info;
  const auto made_of = [&](const Balls& balls, double by) {
    std::vector<Field> nodes = {make_field(balls[0]), make_field(balls[1])};
    if (op.role != OpRole::combination) nodes = {make_field("union", {}, nodes)};
    const Field made = make_field(op.name, arguments_of(op), nodes);
    return by == 0 ? made : offset(by, made);
  };
  constexpr double kMore = 0.01;  // so that the sign is known
  std::mt19937 random(31);
  std::uniform_real_distribution<float> at(-1.8F, 1.8F);
  int beside = 0;
  for (const double by : {0.0, 0.3, -0.1}) {
    const Balls balls = whole_balls();
    const Field whole = made_of(balls, by);
    Balls cut(2);
    for (const SamplerUse& use : whole.sampler_uses()) {
      const int i = use.sampler == balls[0].get() ? 0 : 1;
      cut[i] = std::make_shared<CutBall>(kBalls[i], use.lo - kMore, use.hi + kMore);
    }
    const Field same = made_of(cut, by);
    for (int i = 0; i < 20000; ++i) {
      const glm::vec3 p(at(random), at(random), at(random));
      const float value = whole(p);
      // Blends that fade for ever, as far as they are asked for.
      if (std::fabs(value) < 0.012F) {
        ++beside;
        ASSERT_LT(std::fabs(same(p)), 0.03F) << by << ": " << p.x << " " << p.y << " " << p.z;
      } else {
        ASSERT_EQ(same(p) < 0, value < 0)
            << by << ": " << p.x << " " << p.y << " " << p.z << ": " << value << " " << same(p);
      }
    }
  }
  EXPECT_GT(beside, 20);
}

std::vector<const OpEntry*> ops_of_nodes() {
  std::vector<const OpEntry*> found;
  for (const OpEntry& op : op_list()) {
    if (op.info->role != OpRole::leaf) found.push_back(&op);
  }
  return found;
}

std::string name_of(const testing::TestParamInfo<const OpEntry*>& of) {
  return of.param->info->name;
}
INSTANTIATE_TEST_SUITE_P(SamplerUses, OpOfTwoBalls, testing::ValuesIn(ops_of_nodes()), name_of);

}  // namespace
}  // namespace sdfgrid
