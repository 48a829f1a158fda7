// Graphs of functions of one variable against dense points of their border in double, made from
// the functions as C++ knows them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "field/examples.h"
#include "sdfgrid/core/error.h"

namespace sdfgrid {
namespace {

struct Graph {
  const char* text;
  std::function<double(double)> f;
  double from = -0.9, to = 1.1;
};

std::vector<Graph> graphs() {
  return {{"0.5 + 0.2*sin(4*x)", [](double x) { return 0.5 + 0.2 * std::sin(4 * x); }},
          {"0.3*exp(x)", [](double x) { return 0.3 * std::exp(x); }},
          {"0.6 + x^3 - 0.7*x", [](double x) { return 0.6 + x * x * x - 0.7 * x; }},
          {"sqrt(1 + x^2) - 0.6", [](double x) { return std::sqrt(1 + x * x) - 0.6; }},
          {"0.2 + abs(x)", [](double x) { return 0.2 + std::fabs(x); }},
          {"0.5 + 0.1*sin(100*x)", [](double x) { return 0.5 + 0.1 * std::sin(100 * x); }},
          {"sqrt(1 - x^2)", [](double x) { return std::sqrt(std::fmax(0, 1 - x * x)); }, -1, 1},
          {"0.5*sin(3*x)", [](double x) { return 0.5 * std::sin(3 * x); }},
          {"x^4", [](double x) { return x * x * x * x; }},
          {"0.7 - x^2 - 0.2*x^3", [](double x) { return 0.7 - x * x * (1 + 0.2 * x); }},
          {"0.5 + 0.2*floor(3*x)", [](double x) { return 0.5 + 0.2 * std::floor(3 * x); }},
          {"max(0.3, 1 - 3*abs(x))", [](double x) { return std::fmax(0.3, 1 - 3 * std::fabs(x)); }},
          {"0.9 - sqrt(abs(x))", [](double x) { return 0.9 - std::sqrt(std::fabs(x)); }},
          {"0.1 + sqrt(abs(x))", [](double x) { return 0.1 + std::sqrt(std::fabs(x)); }},
          {"0.2 + 0.5*abs(mod(3*x, 2) - 1)",  // continuous, made of what jumps
           [](double x) { return 0.2 + 0.5 * std::fabs(3 * x - 2 * std::floor(1.5 * x) - 1); }},
          {"exp(9*x)", [](double x) { return std::exp(9 * x); }, -0.5, 0.2},
          {"0.5", [](double) { return 0.5; }},
          {"0.4*x", [](double x) { return 0.4 * x; }},
          {"0.7 - 0.3*x", [](double x) { return 0.7 - 0.3 * x; }},
          {"0.2 + 0.5*x^2", [](double x) { return 0.2 + 0.5 * x * x; }},
          {"1 + 0.3*x - x*x/2", [](double x) { return 1 + x * (0.3 - 0.5 * x); }}};
}

struct Flat {
  double u, r;
};
// How far two of a border's neighbours are apart, at most.
constexpr double kApart = 1e-3;

void add_segment(std::vector<Flat>& border, Flat a, Flat b) {
  const double l = std::hypot(b.u - a.u, b.r - a.r);
  const int n = std::max(1, static_cast<int>(std::ceil(l / kApart)));
  for (int i = 0; i <= n; ++i) {
    const double t = static_cast<double>(i) / n;
    border.push_back({a.u + t * (b.u - a.u), a.r + t * (b.r - a.r)});
  }
}

// Where to look at a function: denser towards the ends, where a slope may be infinite, around kinks
// and jumps, and where it crosses `low`.
std::vector<double> nodes_of(const Graph& g, double low) {
  constexpr int kMany = 20000;
  std::vector<double> nodes;
  for (int i = 0; i <= kMany; ++i) {
    nodes.push_back(g.from + (g.to - g.from) * 0.5 * (1 - std::cos(M_PI * i / kMany)));
  }
  for (int i = -3; i <= 3; ++i) {
    for (const double kink : {i / 3.0, i * 0.7 / 3}) {
      for (const double beside : {-1e-9, 0.0, 1e-9}) nodes.push_back(kink + beside);
    }
  }
  for (double beside = 1e-9; beside < 0.01; beside *= 1.02) {
    nodes.push_back(-beside);
    nodes.push_back(beside);
  }
  for (std::size_t i = 1; i <= kMany; ++i) {
    double a = nodes[i - 1];
    double b = nodes[i];
    const bool up = g.f(a) > low;
    if (up == (g.f(b) > low)) continue;
    for (int k = 0; k < 50; ++k) ((g.f(0.5 * (a + b)) > low) == up ? a : b) = 0.5 * (a + b);
    nodes.push_back(a);
    nodes.push_back(b);
  }
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

// The border of what is above `low` and below the graph; its floor if it has one.
std::vector<Flat> border_of(const Graph& g, double low, bool floor) {
  std::vector<Flat> border;
  Flat last{g.from, low};
  for (const double u : nodes_of(g, low)) {
    if (u < g.from || u > g.to) continue;
    // From within.
    const double r = std::fmax(g.f(std::clamp(u, g.from + 1e-9, g.to - 1e-9)), low);
    if (r > low || last.r > low) {
      add_segment(border, last, {u, r});
      if (floor) border.push_back({u, low});
    }
    last = {u, r};
  }
  if (last.r > low) add_segment(border, last, {g.to, low});
  return border;
}

double nearest_of(const std::vector<Flat>& border, double u, double r) {
  double square = 1e30;
  for (const Flat& b : border) {
    square = std::min(square, (b.u - u) * (b.u - u) + (b.r - r) * (b.r - r));
  }
  return std::sqrt(square);
}

constexpr double kLow = -0.4;
constexpr double kDepth = 0.8;

Field graph_field(const Graph& g, const char* mode) {
  return make_field("function", {{"f", g.text},
                                 {"mode", mode},
                                 {"from", g.from},
                                 {"to", g.to},
                                 {"floor", kLow},
                                 {"depth", kDepth}});
}

TEST(Graphs, AreAsFarAsTheirBorders) {
  for (const Graph& g : graphs()) {
    for (const char* mode : {"revolve_z", "revolve_x", "extrude"}) {
      SCOPED_TRACE(std::string(g.text) + " " + mode);
      const Field field = graph_field(g, mode);
      EXPECT_EQ(field.size(), 1U);  // no region around it
      const bool extruded = std::string(mode) == "extrude";
      const bool z = std::string(mode) == "revolve_z";
      const double low = extruded ? kLow : 0;
      const std::vector<Flat> border = border_of(g, low, extruded);
      std::mt19937 random(29);
      std::uniform_real_distribution<double> unit(-1, 1);
      for (int k = 0; k < 120; ++k) {
        glm::vec3 p(2 * unit(random), 2 * unit(random), 2 * unit(random));
        if (k % 2 == 1) {  // beside the graph
          const double u = 0.5 * (g.from + g.to) + 0.55 * (g.to - g.from) * unit(random);
          const double r = std::fmax(g.f(u), low) + 0.03 * unit(random);
          p = z ? glm::vec3(r, 0.001, u) : glm::vec3(u, r, 0.3 * unit(random));
        }
        const auto u = double(z ? p.z : p.x);
        const double r = extruded ? double(p.y)
                                  : (z ? std::hypot(double(p.x), double(p.y))
                                       : std::hypot(double(p.y), double(p.z)));
        double flat = nearest_of(border, u, r);
        // Points of the border are kApart from each other: an eighth of that squared over the
        // distance.
        const double far = std::max({1.0, std::fabs(u), r});
        const double slack =
            4e-6 * far + std::fmin(0.5 * kApart, kApart * kApart / 8 / std::fmax(flat, 1e-9));
        if (u > g.from && u < g.to && r < g.f(u) && r > (extruded ? low : -1)) flat = -flat;
        double expected = flat;
        if (extruded) {
          const double h = std::fabs(double(p.z)) - 0.5 * kDepth;
          expected =
              std::hypot(std::fmax(flat, 0), std::fmax(h, 0)) + std::fmin(std::fmax(flat, h), 0);
        }
        ASSERT_NEAR(double(field(p)), expected, slack) << p.x << " " << p.y << " " << p.z;
      }
    }
  }
}

// The surface itself, far finer than the points of a border are: the value on the graph is within
// the tolerance of 0, that a little beside it within the tolerance of how far that is.
TEST(Graphs, AreWithinTheirTolerance) {
  for (const Graph& g : graphs()) {
    SCOPED_TRACE(g.text);
    const Field field = graph_field(g, "extrude");
    double height = 0;
    for (int i = 0; i <= 1000; ++i) {
      height = std::fmax(height, g.f(g.from + (g.to - g.from) * i / 1000));
    }
    std::mt19937 random(31);
    std::uniform_real_distribution<double> unit(0, 1);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
      const double u = g.from + (g.to - g.from) * unit(random);
      if (g.f(u) < kLow) continue;
      worst = std::fmax(worst, std::fabs(field.gradient({u, g.f(u), 0}).value));
    }
    // Single precision holds points of the border within 6e-8 of their coordinates.
    const double tolerance = 1e-6 * std::fmin(g.to - g.from, height - kLow);
    EXPECT_LT(worst, tolerance + 2e-7 * std::fmax(height, 1.1));
  }
}

TEST(Graphs, AreOneLipschitzInAHundredThousandPairs) {
  for (const Graph& g : graphs()) {
    for (const char* mode : {"revolve_z", "extrude"}) {
      SCOPED_TRACE(std::string(g.text) + " " + mode);
      const Field field = graph_field(g, mode);
      const Box box = example_box(field);
      std::mt19937 random(37);
      std::uniform_real_distribution<double> unit(0, 1);
      constexpr std::size_t kPairs = 100000;
      std::vector<float> c[6];
      for (auto& axis : c) axis.resize(kPairs);
      for (std::size_t i = 0; i < kPairs; ++i) {
        const double t = std::pow(10.0, -7 * unit(random));
        for (int a = 0; a < 3; ++a) {
          const double p = box.lo[a] + unit(random) * box.size()[a];
          const double q = box.lo[a] + unit(random) * box.size()[a];
          c[a][i] = static_cast<float>(p);
          c[a + 3][i] = static_cast<float>(p + t * (q - p));
        }
      }
      std::vector<float> at_p(kPairs);
      std::vector<float> at_q(kPairs);
      field.evaluate(kPairs, c[0].data(), c[1].data(), c[2].data(), at_p.data());
      field.evaluate(kPairs, c[3].data(), c[4].data(), c[5].data(), at_q.data());
      double worst = 0;
      for (std::size_t i = 0; i < kPairs; ++i) {
        double square = 0;
        for (int a = 0; a < 3; ++a) {
          const double d = double(c[a][i]) - double(c[a + 3][i]);
          square += d * d;
        }
        worst = std::fmax(worst, std::fabs(double(at_p[i]) - double(at_q[i])) - std::sqrt(square));
      }
      EXPECT_LE(worst, 4e-6);
    }
  }
}

std::string refusal(const char* f) {
  try {
    (void)make_field("function", {{"f", f}});
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::input);
    return e.what();
  }
  return "";
}

TEST(Graphs, WhatHasNoChainOfArcsIsBoundedOrRefused) {
  // More arcs than a chain may have: the formula itself within a region.
  EXPECT_GT(make_field("function", {{"f", "0.5 + 0.01*sin(20000*x)"}}).size(), 1U);
  // Where it is below the axis there is nothing, poles downwards among it.
  EXPECT_EQ(make_field("function", {{"f", "1 - 0.01/x^2"}}).size(), 1U);
  EXPECT_GT(make_field("function", {{"f", "-1 - x^2"}})(glm::vec3(0)), 1e6F);
  for (const char* f : {"1/x", "tan(3*x)", "0.5 + 0.1*sin(1/x)"}) {
    const std::string why = refusal(f);
    EXPECT_EQ(why.find("function: "), 0U) << f << ": " << why;
  }
}

TEST(Graphs, NothingIsLeftOfAFlatFunctionOnTheAxis) {
  const Field field = make_field("function", {{"f", "max(0, x - 0.5)"}, {"from", -1}, {"to", 1}});
  EXPECT_NEAR(double(field(glm::vec3(0, 0, -0.5F))), 1, 1e-5);
  EXPECT_NEAR(double(field(glm::vec3(0, 0, 0.9F))), -0.1, 1e-5);
}

}  // namespace
}  // namespace sdfgrid
