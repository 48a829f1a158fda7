// Every op of the list against the definition of its solid (solids.h), which shares nothing with
// its formula: its sign, that no point of the surface is nearer than it says, and that one is as
// near as that where it says that it is exact.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "field/brute_force.h"
#include "field/pairs.h"

namespace {

using sdfgrid::Box;
using sdfgrid::Field;
using sdfgrid::OpGuarantee;

// Of the orbits of the Mandelbulb single precision leaves less.
double rounding_of(const Example& e) {
  return e.op->info->name == std::string("mandelbulb") ? 2e-3 : 1e-5;
}

// Values at points all over the box of an example, and many near its surface.
Points points_of(const Example& e, std::size_t n, std::mt19937& random) {
  const Box box = example_box(e.field);
  Points many = random_points(8 * n, box, random);
  many.evaluate(e.field);
  std::vector<std::size_t> order(many.x.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto half = static_cast<std::ptrdiff_t>(n / 2);
  std::partial_sort(order.begin(), order.begin() + half, order.end(), [&](auto a, auto b) {
    return std::fabs(many.value[a]) < std::fabs(many.value[b]);
  });
  Points p(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t from = i < n / 2 ? order[i] : i;
    p.x[i] = many.x[from];
    p.y[i] = many.y[from];
    p.z[i] = many.z[from];
    p.value[i] = many.value[from];
  }
  return p;
}

void expect_negative_inside_alone(const Example& e) {
  const Inside inside = solid_of(e);
  std::mt19937 random(41);
  const Points p = points_of(e, 4000, random);
  int in = 0;
  for (std::size_t i = 0; i < p.x.size(); ++i) {
    in += p.value[i] < 0 ? 1 : 0;
    if (inside(p.at(i)) == (p.value[i] < 0) || std::fabs(p.value[i]) < kRounding) continue;
    ASSERT_TRUE(both_sides_near(inside, p.at(i), rounding_of(e), random))
        << p.x[i] << " " << p.y[i] << " " << p.z[i] << ": " << p.value[i];
  }
  EXPECT_GT(in, 50);
  EXPECT_LT(in, 3950);
}

TEST(Solids, AreNegativeInsideAlone) {
  for (const Example& e : examples()) {
    SCOPED_TRACE(e.text);
    expect_negative_inside_alone(e);
  }
}

// The solid's own box, as far as it is worth looking at.
Box solid_box(const Field& field) {
  Box box = field.bounds();
  for (int a = 0; a < 3; ++a) {
    box.lo[a] = std::fmax(box.lo[a], -4.0);
    box.hi[a] = std::fmin(box.hi[a], 4.0);
  }
  return box;
}

// How much of the distance values are, on one side of a surface.
struct Ratio {
  double least = 1;
  double sum = 0;
  int count = 0;

  void add(double ratio) {
    least = std::fmin(least, ratio);
    sum += ratio;
    ++count;
  }
  [[nodiscard]] double mean() const { return count > 0 ? sum / count : 1; }
};

void expect_no_surface_nearer(const Example& e, Ratio ratios[2]) {
  const Inside inside = solid_of(e);
  const std::vector<Vec> surface = surface_points(inside, solid_box(e.field));
  ASSERT_GT(surface.size(), 200U);
  std::mt19937 random(42);
  const Points p = points_of(e, 200, random);
  for (std::size_t i = 0; i < p.x.size(); ++i) {
    const double r = std::fabs(static_cast<double>(p.value[i]));
    const double d = nearest_found(inside, surface, p.at(i), random);
    ASSERT_LE(r, d + kRounding) << p.x[i] << " " << p.y[i] << " " << p.z[i];
    constexpr double kFar = 0.01;  // as against rounding
    if (d > kFar) ratios[p.value[i] > 0 ? 1 : 0].add(r / d);
  }
}

// How close values come to it stands in the test's XML: docs/methods.md has a table of them.
TEST(Solids, HaveNoSurfaceNearerThanTheValue) {
  std::set<std::string> seen;
  for (const Example& e : examples()) {
    SCOPED_TRACE(e.text);
    if (e.estimate) continue;
    Ratio ratios[2];
    expect_no_surface_nearer(e, ratios);
    constexpr double kWorthHaving = 0.05;
    EXPECT_GT(ratios[0].mean(), kWorthHaving) << "inside";
    EXPECT_GT(ratios[1].mean(), kWorthHaving) << "outside";
    if (!seen.insert(e.node.word).second) continue;
    RecordProperty(e.node.word, fmt::format("inside {:.3f} mean {:.3f}, outside {:.3f} mean {:.3f}",
                                            ratios[0].least, ratios[0].mean(), ratios[1].least,
                                            ratios[1].mean()));
  }
}

// Where a field is the distance itself.
struct Exact {
  bool outside = false;
  bool inside = false;
};

// By what the ops say of themselves, over nodes that are exact on both sides.
Exact exact_by_its_ops(const ExampleNode& node) {
  for (const ExampleNode& each : node.of) {
    const Exact below = exact_by_its_ops(each);
    if (!below.outside || !below.inside) return {};
  }
  switch (sdfgrid::find_op(node.word)->info->guarantee) {
    case OpGuarantee::exact:
      return {true, true};
    case OpGuarantee::exact_outside:
      return {true, false};
    case OpGuarantee::exact_inside:
      return {false, true};
    default:
      return {};
  }
}

// A place of the surface is as near as the value says: at the foot, where the gradient points,
// both sides are found. How many points on each side were looked at.
void expect_reaches(const Example& e, const Exact& exact) {
  const Inside inside = solid_of(e);
  std::mt19937 random(43);
  const Points p = points_of(e, 3000, random);
  int seen[2] = {0, 0};
  for (std::size_t i = 0; i < p.x.size(); ++i) {
    const bool out = p.value[i] > 0;
    const double r = std::fabs(static_cast<double>(p.value[i]));
    if (!(out ? exact.outside : exact.inside) || r < 1e-4) continue;
    const Vec gradient = e.field.gradient(p.at(i)).gradient;
    if (norm(gradient) < 0.999) continue;  // a crease, where several places are as near
    ++seen[out];
    const Vec foot = p.at(i) - static_cast<double>(p.value[i]) * gradient;
    ASSERT_TRUE(both_sides_near(inside, foot, 1e-5, random))
        << p.x[i] << " " << p.y[i] << " " << p.z[i] << ": " << p.value[i];
  }
  EXPECT_TRUE(!exact.outside || seen[1] > 50) << seen[1];
  EXPECT_TRUE(!exact.inside || seen[0] > 50) << seen[0];
}

TEST(Solids, AreAsFarAsTheValueWhereTheOpIsExact) {
  std::set<std::string> proved;
  for (const Example& e : examples()) {
    SCOPED_TRACE(e.text);
    const Exact exact = e.solid ? Exact{} : exact_by_its_ops(e.node);
    if (!exact.outside && !exact.inside) continue;
    expect_reaches(e, exact);
    proved.insert(e.node.word);
  }
  for (const sdfgrid::OpEntry& op : sdfgrid::op_list()) {
    const bool says = op.info->guarantee < OpGuarantee::bound;
    EXPECT_EQ(says, proved.count(op.info->name) == 1) << op.info->name << " needs an example";
  }
}

// What the texts of ops say beyond that.
TEST(Solids, AreAsFarAsTheValueWhereTheTextSaysSo) {
  const std::pair<const char*, Exact> cases[] = {
      {"scale: {by: 1.5, of: {box: {size: [1, 1, 0.6]}}}", {true, true}},
      {"offset: {by: 0.3, of: {torus: {major: 1, minor: 0.3}}}", {true, false}},
      {"offset: {by: 0.3, of: {box: {size: [1, 1, 0.6]}}}", {true, true}},
      {"offset: {by: -0.2, of: {torus: {major: 1, minor: 0.4}}}", {false, true}},
      {"gdf: {solid: icosahedron, exponent: inf}", {false, true}},
      {"gdf: {solid: truncated_octahedron, exponent: 1000}", {false, true}},
      {"gdf: {solid: truncated_dodecahedron, exponent: inf}", {false, true}}};
  for (const auto& [text, exact] : cases) {
    SCOPED_TRACE(text);
    const ExampleNode node = read_node(text);
    expect_reaches({sdfgrid::find_op(node.word), node, make_field(node), text}, exact);
  }
}

// Before flat faces the height above the highest plane is less than the distance: far away, by the
// direction that is as far as possible from all normals. As the words of gdf and polyhedron have
// it.
double least_far_away(const Field& f) {
  std::mt19937 random(50);
  constexpr double kFar = 1e4;
  double least = 1;
  Vec direction(1, 0, 0);
  for (int i = 0; i < 3000; ++i) {
    const double step = std::fmax(2 * std::pow(0.997, i), 1e-3);
    Vec u = direction + step * random_direction(random);
    u /= norm(u);
    const double value = f.gradient(u * kFar).value / kFar;
    if (value > least) continue;
    least = value;
    direction = u;
  }
  return least;
}

TEST(Solids, WithFlatFacesAreNotMuchFartherThanTheValue) {
  const std::pair<const char*, double> least[] = {{"tetrahedron", 0.33},
                                                  {"cube", 0.57},
                                                  {"octahedron", 0.57},
                                                  {"dodecahedron", 0.79},
                                                  {"icosahedron", 0.79},
                                                  {"truncated_tetrahedron", 0.57},
                                                  {"truncated_cube", 0.8},
                                                  {"truncated_octahedron", 0.8},
                                                  {"truncated_dodecahedron", 0.91},
                                                  {"truncated_icosahedron", 0.91}};
  for (const auto& [solid, ratio] : least) {
    const double found =
        least_far_away(sdfgrid::make_field("gdf", {{"solid", solid}, {"exponent", INFINITY}}));
    EXPECT_GT(found, ratio) << solid;
    EXPECT_LT(found, ratio + 0.02) << solid;
  }
  for (const double angle : {170.0, 90.0, 30.0}) {  // of a wedge along x, its edge the z axis
    const double half = 0.5 * angle * M_PI / 180;
    const Field wedge = sdfgrid::make_field(
        "polyhedron",
        {{"planes",
          {std::sin(half), std::cos(half), 0, 0, std::sin(half), -std::cos(half), 0, 0}}});
    EXPECT_NEAR(wedge(glm::vec3(2, 0, 0)) / 2, std::sin(half), 1e-6) << angle;
    EXPECT_LT(wedge(glm::vec3(-2, 0, 0)), 0);
  }
}

}  // namespace
