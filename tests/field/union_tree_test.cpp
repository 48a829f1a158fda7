// Unions of many nodes: whatever is left out, values, marks and bounds are those of all nodes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/vector_relational.hpp>
#include <random>
#include <span>

#include "field/examples.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/field/parts.h"

namespace sdfgrid {
namespace {

class Strewn {
 public:
  double number(double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random_);
  }
  glm::dvec3 place(double reach) {
    return {number(-reach, reach), number(-reach, reach), number(-reach, reach)};
  }
  Field moved(const Field& node, double reach) {
    const glm::dvec3 by = place(reach);
    const Field turned =
        make_field("rotate", {{"by", {number(0, 360), number(0, 360), number(0, 360)}}}, {node});
    return make_field("translate", {{"by", {by.x, by.y, by.z}}}, {turned});
  }
  Field exact(int i) {
    switch (i % 4) {
      case 0:
        return make_field("sphere", {{"radius", number(0.1, 0.5)}});
      case 1:
        return moved(make_field("box", {{"size", {number(0.1, 1), 0.4, 0.6}}}), 5);
      case 2:
        return moved(make_field("torus", {{"major", 0.4}, {"minor", 0.1}}), 5);
      default:
        return make_field("scale", {{"by", {1.5, 1.5, 1.5}}}, {moved(make_field("capsule"), 3)});
    }
  }
  std::vector<Field> exact_nodes(int count) {
    std::vector<Field> nodes;
    for (int i = 0; i < count; ++i) nodes.push_back(moved(exact(i), 5).tagged(i));
    return nodes;
  }

 private:
  std::mt19937 random_{7};
};

struct Points {
  std::vector<float> x, y, z, value;
  Points(Strewn& strewn, std::size_t count, double reach) : value(count) {
    for (std::size_t i = 0; i < count; ++i) {
      const glm::vec3 p(strewn.place(reach));
      x.push_back(p.x);
      y.push_back(p.y);
      z.push_back(p.z);
    }
  }
  void evaluate(const Field& f) {
    f.evaluate(value.size(), x.data(), y.data(), z.data(), value.data());
  }
};

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

// Nodes whose values are only bounds, that have no end, that are nowhere.
std::vector<Field> odd_nodes(Strewn& strewn) {
  std::vector<Field> nodes = strewn.exact_nodes(60);
  for (const char* name : {"gdf", "metaballs", "menger", "superellipsoid"}) {
    const OpEntry* op = find_op(name);
    if (op != nullptr) nodes.push_back(strewn.moved(read_example(op->info->example), 5));
  }
  nodes.push_back(make_field("twist", {{"turns", 0.3}}, {make_field("box")}));
  nodes.push_back(make_field("scale", {{"by", {1, 0.3, 0.6}}}, {strewn.moved(Field(), 1)}));
  nodes.push_back(make_field("plane", {{"normal", {0, 0, 1}}, {"distance", -4}}));
  nodes.push_back(make_field("infinite_cylinder", {{"radius", 0.2}}));
  nodes.push_back(make_field("offset", {{"by", -0.05}}, {strewn.moved(make_field("torus"), 4)}));
  nodes.push_back(make_field("union", {}, strewn.exact_nodes(40)));
  nodes.push_back(strewn.moved(make_field("union", {}, strewn.exact_nodes(30)), 2));
  return nodes;
}

TEST(UnionTree, OfDistancesItIsTheLeastToTheLastBit) {
  Strewn strewn;
  const std::vector<Field> nodes = strewn.exact_nodes(500);
  const Field all = make_field("union", {}, nodes);
  Points points(strewn, 3000, 8);
  points.evaluate(all);
  std::vector<float> least(points.value.size(), INFINITY);
  Points one = points;
  for (const Field& node : nodes) {
    one.evaluate(node);
    for (std::size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], one.value[i]);
  }
  EXPECT_TRUE(same_bits(points.value, least));
}

TEST(UnionTree, OfBoundsItIsABoundWithTheirSigns) {
  Strewn strewn;
  const std::vector<Field> nodes = odd_nodes(strewn);
  const Field all = make_field("union", {}, nodes);
  Points points(strewn, 3000, 8);
  points.evaluate(all);
  Points one = points;
  std::vector<float> least(points.value.size(), INFINITY);
  for (const Field& node : nodes) {
    one.evaluate(node);
    for (std::size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], one.value[i]);
  }
  int inside = 0;
  for (std::size_t i = 0; i < least.size(); ++i) {
    inside += least[i] < 0 ? 1 : 0;
    if (std::fabs(least[i]) > 1e-5F) {
      ASSERT_EQ(points.value[i] < 0, least[i] < 0) << i;
    }
  }
  EXPECT_GT(inside, 20);
  // Still no more than the distance: as steep as one.
  for (std::size_t i = 1; i < least.size(); ++i) {
    const double d =
        std::hypot(double(points.x[i]) - points.x[i - 1], double(points.y[i]) - points.y[i - 1],
                   double(points.z[i]) - points.z[i - 1]);
    ASSERT_LE(std::fabs(double(points.value[i]) - points.value[i - 1]), d + 1e-5);
  }
}

TEST(UnionTree, RestrictedToABoxItHasTheSameBits) {
  Strewn strewn;
  for (const bool odd : {false, true}) {
    const Field all = make_field("union", {}, odd ? odd_nodes(strewn) : strewn.exact_nodes(2000));
    for (int i = 0; i < 200; ++i) {
      const glm::dvec3 middle = strewn.place(7);
      const double half = std::exp(strewn.number(-5, 1.5));
      const Box box{middle - half, middle + half};
      Points points(strewn, 64, 1);
      for (std::size_t k = 0; k < 64; ++k) {
        points.x[k] = static_cast<float>(middle.x + 0.999 * half * double(points.x[k]));
        points.y[k] = static_cast<float>(middle.y + 0.999 * half * double(points.y[k]));
        points.z[k] = static_cast<float>(middle.z + 0.999 * half * double(points.z[k]));
      }
      Points left = points;
      points.evaluate(all);
      const Restricted here = *all.restricted(box);
      left.evaluate(here.field);
      ASSERT_TRUE(same_bits(points.value, left.value)) << i;
      // Again, of what is left: its operands may have changed places.
      left.evaluate(here.field.pruned(box));
      ASSERT_TRUE(same_bits(points.value, left.value)) << i;
      const double upper = 0.2;
      left.evaluate(all.restricted(box, kAnyLength, upper)->field);
      for (std::size_t k = 0; k < 64; ++k) {
        ASSERT_GE(points.value[k], here.range.lo);
        ASSERT_LE(points.value[k], here.range.hi);
        if (double(points.value[k]) < upper) {
          ASSERT_EQ(points.value[k], left.value[k]);
        } else {
          ASSERT_GE(double(left.value[k]), upper);
        }
      }
      if (odd) continue;
      const auto short_of_time = all.restricted(box, 50);
      if (short_of_time) {
        ASSERT_EQ(short_of_time->field.size(), here.field.size());
      }
    }
  }
}

TEST(UnionTree, ALimitIsThatOfUnionsByPlaceOnly) {
  Strewn strewn;
  const Box box{glm::dvec3(-8), glm::dvec3(8)};
  const std::vector<Field> nodes = strewn.exact_nodes(100);
  EXPECT_FALSE(make_field("union", {}, nodes).restricted(box, 10).has_value());
  const auto rest = make_field("intersection", {}, nodes).restricted(box, 10);
  ASSERT_TRUE(rest.has_value());
  EXPECT_GT(rest->field.size(), 10U);
}

TEST(UnionTree, ValuesDoNotDependOnWhatStandsBeside) {
  Strewn strewn;
  const Field all = make_field("union", {}, odd_nodes(strewn));
  Points points(strewn, 500, 6);
  points.evaluate(all);
  for (std::size_t i = 0; i < points.value.size(); ++i) {
    ASSERT_EQ(all(glm::vec3(points.x[i], points.y[i], points.z[i])), points.value[i]);
  }
}

TEST(UnionTree, OfAFaceThatTwoShareTheFirstIsSeen) {
  std::vector<Field> nodes;
  for (int i = 0; i < 40; ++i) {
    nodes.push_back(make_field("translate", {{"by", {double(i % 7), 0, 0}}},
                               {make_field("box", {{"size", {2, 2, 2}}})})
                        .tagged(i));
  }
  const Field all = make_field("union", {}, nodes);
  EXPECT_EQ(all.tag_at({0, 1, 0}), 0);
  EXPECT_EQ(all.tag_at({6.5, 1, 0}), 6);
  EXPECT_EQ(all.tag_at({3, 0, 1}), 2);
}

TEST(UnionTree, BoundsHoldEverything) {
  Strewn strewn;
  const Field all = make_field("union", {}, strewn.exact_nodes(300));
  const Box box = all.bounds();
  const Box wider = all.bounds(0.5);
  Points points(strewn, 5000, 9);
  points.evaluate(all);
  for (std::size_t i = 0; i < points.value.size(); ++i) {
    const glm::dvec3 p(points.x[i], points.y[i], points.z[i]);
    const auto in = [&](const Box& b) {
      return glm::all(glm::greaterThanEqual(p, b.lo)) && glm::all(glm::lessThanEqual(p, b.hi));
    };
    if (points.value[i] < 0) {
      ASSERT_TRUE(in(box));
    }
    if (points.value[i] < 0.5F) {
      ASSERT_TRUE(in(wider));
    }
  }
}

TEST(UnionTree, PartsAreTheSolidAndLieInTheirBoxes) {
  Strewn strewn;
  const Field all = strewn.moved(make_field("union", {}, odd_nodes(strewn)), 1);
  const std::vector<FieldPart> parts = parts_of(all);
  EXPECT_GT(parts.size(), 125U);
  Points points(strewn, 2000, 8);
  points.evaluate(all);
  std::vector<float> least(points.value.size(), INFINITY);
  Points one = points;
  for (const FieldPart& part : parts) {
    one.evaluate(part.field);
    for (std::size_t i = 0; i < least.size(); ++i) {
      least[i] = std::min(least[i], one.value[i]);
      if (one.value[i] >= 0) continue;
      for (int a = 0; a < 3; ++a) {
        const double c = a == 0 ? points.x[i] : (a == 1 ? points.y[i] : points.z[i]);
        ASSERT_GE(c, part.box.lo[a]);
        ASSERT_LE(c, part.box.hi[a]);
      }
    }
  }
  for (std::size_t i = 0; i < least.size(); ++i) {
    if (std::fabs(least[i]) > 1e-5F) {
      ASSERT_EQ(points.value[i] < 0, least[i] < 0) << i;
    }
  }
}

// The same union by hand, two by two, which knows no boxes.
Field joined(const char* op, double k, std::span<const Field> of) {
  if (of.size() == 1) return of[0];
  const std::size_t half = (of.size() + 1) / 2;
  return make_field(op, {{"k", k}},
                    {joined(op, k, of.first(half)), joined(op, k, of.subspan(half))});
}

struct SmoothCase {
  const char* op;
  double k;
  std::vector<Field> nodes;
};
// Crowds, which a blend makes far larger than any of them.
std::vector<Field> crowds(Strewn& strewn) {
  std::vector<Field> nodes;
  for (int crowd = 0; crowd < 8; ++crowd) {
    const glm::dvec3 at = strewn.place(4);
    for (int i = 0; i < 32; ++i) {
      nodes.push_back(make_field("translate", {{"by", {at.x + 0.01 * i, at.y, at.z}}},
                                 {make_field("sphere", {{"radius", 0.2}})}));
    }
  }
  return nodes;
}
std::vector<SmoothCase> smooth_cases(Strewn& strewn) {
  return {{"smooth_union", 0.3, strewn.exact_nodes(700)},
          {"smooth_union", 2, strewn.exact_nodes(300)},
          {"smooth_union", 0.4, odd_nodes(strewn)},
          {"smooth_union", 1.5, crowds(strewn)},
          {"exponential_union", 0.02, strewn.exact_nodes(300)},
          {"exponential_union", 0.05, odd_nodes(strewn)}};
}

TEST(SmoothUnionTree, ItIsThatOfAllToTheLastBit) {
  Strewn strewn;
  for (const auto& [op, k, nodes] : smooth_cases(strewn)) {
    SCOPED_TRACE(op);
    const Field all = make_field(op, {{"k", k}}, nodes);
    const Field plain = joined(op, k, nodes);
    ASSERT_EQ(all.size(), plain.size());
    for (const double reach : {8.0, 0.3}) {
      Points points(strewn, 3000, reach);
      Points same = points;
      points.evaluate(all);
      same.evaluate(plain);
      ASSERT_TRUE(same_bits(points.value, same.value));
      for (std::size_t i = 0; i < 200; ++i) {
        const glm::dvec3 p(points.x[i], points.y[i], points.z[i]);
        ASSERT_EQ(all.tag_at(p), plain.tag_at(p));
        // In double an exponential blend never ends; what is left out is e^-20.
        const glm::dvec3 d = all.gradient(p).gradient - plain.gradient(p).gradient;
        ASSERT_LT(std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z), 1e-8);
      }
    }
  }
}

TEST(SmoothUnionTree, RestrictedToABoxItHasTheSameBits) {
  Strewn strewn;
  for (const auto& [op, k, nodes] : smooth_cases(strewn)) {
    SCOPED_TRACE(op);
    const Field all = make_field(op, {{"k", k}}, nodes);
    std::size_t left_over = 0;
    for (int i = 0; i < 150; ++i) {
      const glm::dvec3 middle = strewn.place(7);
      const double half = std::exp(strewn.number(-5, 1.5));
      const Box box{middle - half, middle + half};
      Points points(strewn, 64, 1);
      for (std::size_t n = 0; n < 64; ++n) {
        points.x[n] = static_cast<float>(middle.x + 0.999 * half * double(points.x[n]));
        points.y[n] = static_cast<float>(middle.y + 0.999 * half * double(points.y[n]));
        points.z[n] = static_cast<float>(middle.z + 0.999 * half * double(points.z[n]));
      }
      Points left = points;
      points.evaluate(all);
      const Restricted here = *all.restricted(box);
      left_over += here.field.size();
      left.evaluate(here.field);
      ASSERT_TRUE(same_bits(points.value, left.value)) << i;
      left.evaluate(here.field.pruned(box));
      ASSERT_TRUE(same_bits(points.value, left.value)) << i;
      const double upper = i % 2 == 0 ? 0.2 : -0.1;
      const Restricted below = *all.restricted(box, kAnyLength, upper);
      left.evaluate(below.field);
      for (std::size_t n = 0; n < 64; ++n) {
        ASSERT_GE(points.value[n], here.range.lo);
        ASSERT_LE(points.value[n], here.range.hi);
        if (double(points.value[n]) < upper) {
          ASSERT_EQ(points.value[n], left.value[n]);
          ASSERT_GE(points.value[n], below.range.lo);
        } else {
          ASSERT_GE(double(left.value[n]), upper - 1e-6);
        }
      }
    }
    EXPECT_LT(left_over, 150 * all.size());
  }
}

TEST(SmoothUnionTree, BoundsHoldEverything) {
  Strewn strewn;
  for (const auto& [op, k, nodes] : smooth_cases(strewn)) {
    SCOPED_TRACE(op);
    const Field all = make_field(op, {{"k", k}}, nodes);
    Points points(strewn, 5000, 12);
    points.evaluate(all);
    for (const double level : {-0.1, 0.0, 0.5}) {
      const Box box = all.bounds(level);
      for (std::size_t i = 0; i < points.value.size(); ++i) {
        if (double(points.value[i]) >= level) continue;
        const glm::dvec3 p(points.x[i], points.y[i], points.z[i]);
        ASSERT_TRUE(glm::all(glm::greaterThanEqual(p, box.lo)) &&
                    glm::all(glm::lessThanEqual(p, box.hi)));
      }
    }
  }
}

// Along any line the value of what is called convex is a convex function, whatever floats round.
TEST(Parts, WhatIsCalledConvexIs) {
  Strewn strewn;
  int convex = 0;
  for (const OpEntry& op : op_list()) {
    if (op.info->role != OpRole::leaf) continue;
    const Field leaf = read_example(op.info->example);
    const std::vector<FieldPart> parts = parts_of(strewn.moved(leaf, 0.5));
    if (parts.size() != 1 || !parts[0].convex) continue;
    ++convex;
    const Field& f = parts[0].field;
    for (int i = 0; i < 3000; ++i) {
      const glm::dvec3 a = strewn.place(3);
      const glm::dvec3 b = i % 2 == 0 ? strewn.place(3) : a + strewn.place(0.05);
      const double t = strewn.number(0, 1);
      const double at_a = double(f(glm::vec3(a)));
      const double at_b = double(f(glm::vec3(b)));
      if (at_a < 0 || at_b < 0) continue;
      const double between = double(f(glm::vec3(a + t * (b - a))));
      ASSERT_LE(between, at_a + t * (at_b - at_a) + 3e-6) << op.info->name;
    }
  }
  EXPECT_GE(convex, 10);
}

}  // namespace
}  // namespace sdfgrid
