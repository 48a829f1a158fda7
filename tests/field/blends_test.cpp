// Smooth combinations against their definitions in double precision: few and many nodes, in any
// order, with parameters at the ends of their ranges.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <random>

#include "field/pairs.h"
#include "sdfgrid/field/field.h"

namespace {

using sdfgrid::Argument;
using sdfgrid::Box;
using sdfgrid::Field;
using sdfgrid::make_field;

struct Family {
  std::string name;  // of its ops, before "_union" and the like
  Argument width;
};
std::vector<Family> families() {
  return {{"smooth", {"k", 0.3}}, {"exponential", {"k", 0.1}}, {"pnorm", {"p", 3.0}}};
}

Field complement(const Field& f) { return make_field("complement", {}, {f}); }

Field moved_ball(const glm::dvec3& at, double radius) {
  return make_field("translate", {{"by", {at.x, at.y, at.z}}},
                    {make_field("sphere", {{"radius", radius}})});
}

std::vector<Field> balls(int count, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Field> made;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 at(unit(random), unit(random), unit(random));
    made.push_back(moved_ball(at, 1.2 + 0.7 * unit(random)));
  }
  return made;
}

const Box kAround{glm::dvec3(-3), glm::dvec3(3)};

// The values of a field and of each of its nodes at the same points.
struct Readings {
  Points whole;
  std::vector<Points> nodes;

  Readings(const Field& f, const std::vector<Field>& of, std::size_t n, std::uint32_t seed)
      : whole([&] {
          std::mt19937 random(seed);
          return random_points(n, kAround, random);
        }()),
        nodes(of.size(), whole) {
    whole.evaluate(f);
    for (std::size_t i = 0; i < of.size(); ++i) nodes[i].evaluate(of[i]);
  }
  [[nodiscard]] std::vector<double> at(std::size_t point) const {
    std::vector<double> values;
    for (const Points& node : nodes) values.push_back(double(node.value[point]));
    return values;
  }
};

using Join = std::function<double(const std::vector<double>&, double)>;

double least_of(const std::vector<double>& d, double) {
  return *std::min_element(d.begin(), d.end());
}
double exponential_of(const std::vector<double>& d, double k) {
  const double least = least_of(d, k);
  double sum = 0;
  for (const double v : d) sum += std::exp((least - v) / k);
  return least - k * std::log(sum);
}
double pnorm_of(const std::vector<double>& d, double p) {
  const double least = least_of(d, p);
  if (!(least > 0)) return least;
  double sum = 0;
  for (const double v : d) sum += std::pow(least / v, p);
  return least * std::pow(sum, -1 / p);
}

// The union, intersection and difference that a family makes of the nodes are `join` of them, of
// their complements, and of all but the first with the complement of that.
void expect_joined(const std::string& family, const Argument& width, const Join& join,
                   const std::vector<Field>& of, double within) {
  const double by = std::get<std::vector<double>>(width.value)[0];
  for (const std::string what : {"_union", "_intersection", "_difference"}) {
    SCOPED_TRACE(family + what);
    const Readings read(make_field(family + what, {width}, of), of, 3000, 4);
    for (std::size_t i = 0; i < read.whole.x.size(); ++i) {
      std::vector<double> d = read.at(i);
      if (what == "_intersection") {
        for (double& v : d) v = -v;
      } else if (what == "_difference") {
        d[0] = -d[0];
      }
      const double joined = join(d, by);
      ASSERT_NEAR(double(read.whole.value[i]), what == "_union" ? joined : -joined, within);
    }
  }
}

TEST(Blends, IntersectionsAndDifferencesAreUnionsOfComplements) {
  std::mt19937 random(3);
  const std::vector<Field> of = balls(2, random);
  for (const Family& family : families()) {
    SCOPED_TRACE(family.name);
    const std::vector<Argument> width = {family.width};
    const auto pairs = {std::pair(make_field(family.name + "_intersection", width, of),
                                  complement(make_field(family.name + "_union", width,
                                                        {complement(of[0]), complement(of[1])}))),
                        std::pair(make_field(family.name + "_difference", width, of),
                                  complement(make_field(family.name + "_union", width,
                                                        {complement(of[0]), of[1]})))};
    for (const auto& [op, by_union] : pairs) {
      Points a = random_points(5000, kAround, random);
      Points b = a;
      a.evaluate(op);
      b.evaluate(by_union);
      for (std::size_t i = 0; i < a.x.size(); ++i) {
        ASSERT_EQ(std::bit_cast<std::uint32_t>(a.value[i]),
                  std::bit_cast<std::uint32_t>(b.value[i]));
      }
    }
  }
}

TEST(Blends, OfManyNodesAreWhatTheirFormulasSay) {
  std::mt19937 random(5);
  for (const int count : {2, 3, 15, 16, 100}) {
    SCOPED_TRACE(count);
    const std::vector<Field> of = balls(count, random);
    for (const double k : {0.02, 0.3, 5.0}) {
      expect_joined("exponential", {"k", k}, exponential_of, of, 2e-6 * (3 + 8 * k));
    }
    for (const double p : {1.0, 3.0, 64.0}) {
      expect_joined("pnorm", {"p", p}, pnorm_of, of, 2e-5);
    }
  }
}

// Nothing overflows at the ends of what parameters may be: narrow blends are the sharp ops, and
// wide ones below them by k times the logarithm of how many nodes there are.
TEST(Blends, HaveTheRightLimits) {
  std::mt19937 random(6);
  const std::vector<Field> of = balls(100, random);
  expect_joined("exponential", {"k", 1e-6}, least_of, of, 1e-5);
  expect_joined("smooth", {"k", 1e-6}, least_of, of, 1e-5);
  const double wide = 1e9;
  const Field all = make_field("exponential_union", {{"k", wide}}, of);
  EXPECT_NEAR(all(glm::vec3(0)) / wide, -std::log(100.0), 1e-5);
  const Field common = make_field("exponential_intersection", {{"k", wide}}, of);
  EXPECT_NEAR(common(glm::vec3(0)) / wide, std::log(100.0), 1e-5);
}

// Empty space is 1e9 away, and what has no end may be as deep.
TEST(Blends, TakeNodesThatAreFarAway) {
  const Field ball = make_field("sphere");
  const Field nothing;
  const Field far = moved_ball({1e8, 0, 0}, 1);
  for (const Family& family : families()) {
    SCOPED_TRACE(family.name);
    for (const Field& other : {nothing, far}) {
      const auto of = [&](const std::string& what, const std::vector<Field>& nodes) {
        return double(make_field(family.name + what, {family.width}, nodes)(glm::vec3(1.5F, 0, 0)));
      };
      EXPECT_EQ(of("_union", {ball, other}), 0.5);
      EXPECT_EQ(of("_union", {other, other, ball, other}), 0.5);
      EXPECT_EQ(of("_difference", {ball, other}), 0.5);
      EXPECT_EQ(of("_intersection", {ball, complement(other)}), 0.5);
      EXPECT_GT(of("_intersection", {ball, other}), 9e7);
      EXPECT_GT(of("_difference", {ball, complement(other)}), 9e7);
      EXPECT_LE(of("_union", {other, other}), 1.1e9);
      EXPECT_GE(of("_union", {other, other}), 7e7);
    }
  }
}

TEST(Blends, OfEqualNodesDifferByWhatTheyTakeOff) {
  const Field ball = make_field("sphere");
  const glm::vec3 p(1.5F, 0, 0);
  const std::vector<Field> twice = {ball, ball};
  EXPECT_NEAR(make_field("smooth_union", {{"k", 0.2}}, twice)(p), 0.5 - 0.05, 1e-6);
  EXPECT_NEAR(make_field("smooth_intersection", {{"k", 0.2}}, twice)(p), 0.5 + 0.05, 1e-6);
  const double both = 0.2 * std::log(2.0);
  EXPECT_NEAR(make_field("exponential_union", {{"k", 0.2}}, twice)(p), 0.5 - both, 1e-6);
  EXPECT_NEAR(make_field("exponential_intersection", {{"k", 0.2}}, twice)(p), 0.5 + both, 1e-6);
  EXPECT_NEAR(make_field("pnorm_union", {{"p", 2}}, twice)(p), 0.5 / std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(make_field("pnorm_intersection", {{"p", 2}}, twice)(p), 0.5, 1e-6);
  const glm::vec3 q(0.5F, 0, 0);
  EXPECT_NEAR(make_field("pnorm_intersection", {{"p", 2}}, twice)(q), -0.5 / std::sqrt(2.0), 1e-6);
}

// What the documentation says of the order of nodes: exponential and p-norm ones do not know it, a
// polynomial one of three does.
TEST(Blends, KnowTheOrderOfNodesOrNot) {
  std::mt19937 random(7);
  const std::vector<Field> of = balls(5, random);
  for (const Family& family : families()) {
    SCOPED_TRACE(family.name);
    double most = 0;
    for (const std::string what : {"_union", "_intersection", "_difference"}) {
      std::vector<Field> turned = of;
      // The first of a difference is what others are taken from.
      std::reverse(turned.begin() + (what == "_difference" ? 1 : 0), turned.end());
      Points a = random_points(5000, kAround, random);
      Points b = a;
      a.evaluate(make_field(family.name + what, {family.width}, of));
      b.evaluate(make_field(family.name + what, {family.width}, turned));
      for (std::size_t i = 0; i < a.x.size(); ++i) {
        most = std::fmax(most, std::fabs(double(a.value[i]) - double(b.value[i])));
      }
    }
    if (family.name == "smooth") {
      EXPECT_GT(most, 1e-3);
      EXPECT_LT(most, 0.3 / 4);
    } else {
      EXPECT_LT(most, 5e-6);
    }
  }
}

}  // namespace
