// That formulas are safe: derivatives of every function, and a bound or a refusal whatever it is
// given.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include "field/examples.h"
#include "field/pairs.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/field/formula.h"
#include "sdfgrid/field/formulas.h"

namespace {

using sdfgrid::Box;
using sdfgrid::Error;
using sdfgrid::Field;
using sdfgrid::make_field;
using sdfgrid::ops::Data;
using sdfgrid::ops::Dual;
using sdfgrid::ops::Point;
using sdfgrid::ops::with_derivatives;

Box cube(double half) { return {glm::dvec3(-half), glm::dvec3(half)}; }

Field certified(const std::string& f, const Box& box) {
  const std::vector<double> corners = {box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z};
  return make_field("formula", {{"f", f}, {"bounds", corners}});
}

std::string refusal(const std::string& f, const Box& box) {
  try {
    (void)certified(f, box);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

bool holds(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

// First and second derivatives in double, of every function that there is.
TEST(FormulaDerivatives, AreThoseOfFiniteDifferences) {
  for (const std::string& text : example_formulas()) {
    SCOPED_TRACE(text);
    const std::vector<float> code = sdfgrid::parse_formula(text);
    const Data data = {code.data(), static_cast<int>(code.size())};
    const auto first = [&](const glm::dvec3& p) {
      return run_formula(data, with_derivatives(Point<double>{p.x, p.y, p.z}));
    };
    std::mt19937 random(21);
    std::uniform_real_distribution<double> unit(-1, 1);
    int compared = 0;
    for (int k = 0; k < 200; ++k) {
      const glm::dvec3 p(unit(random), unit(random), unit(random));
      const auto f =
          run_formula(data, with_derivatives(with_derivatives(Point<double>{p.x, p.y, p.z})));
      ASSERT_EQ(f.v.v, first(p).v);
      for (int j = 0; j < 3; ++j) {
        constexpr double kStep = 1e-5;
        glm::dvec3 lo = p;
        glm::dvec3 hi = p;
        lo[j] -= kStep;
        hi[j] += kStep;
        const Dual<double, 3> below = first(lo);
        const Dual<double, 3> above = first(hi);
        ASSERT_EQ(f.d[j].v, f.v.d[j]);
        ASSERT_EQ(f.v.d[j], first(p).d[j]);
        for (int i = 0; i < 3; ++i) {
          const double rise = above.d[i] - below.d[i];
          if (std::fabs(rise) > 0.01) continue;  // a kink between the two
          ASSERT_NEAR(rise / (2 * kStep), f.d[i].d[j], 1e-5 * (1 + std::fabs(f.d[i].d[j])))
              << i << ' ' << j;
          ASSERT_NEAR((above.v - below.v) / (2 * kStep), f.v.d[j], 1e-5);
          ++compared;
        }
      }
    }
    EXPECT_GT(compared, 1700);
  }
}

// Given what it has jumps, poles and infinite slopes in, every function makes a bound or an error.
TEST(FormulaSafety, EveryFunctionIsBoundedOrRefused) {
  int refused = 0;
  int made = 0;
  for (const sdfgrid::FormulaFunction& f : sdfgrid::formula_functions()) {
    for (const char* argument : {"3*x", "x*x - 0.5", "2 + x", "x - 2", "abs(2*x)", "x"}) {
      const std::string name(f.name);
      const std::string text =
          name + "(" + argument + (f.least > 1 ? ", 0.7*y + 0.3" : "") + ") + 0.3*z";
      SCOPED_TRACE(text);
      const Box box = cube(1);
      std::optional<Field> field;
      try {
        field = certified(text, box);
      } catch (const Error& error) {
        EXPECT_TRUE(holds(error.what(), "formula: ") && holds(error.what(), "; ")) << error.what();
        ++refused;
        continue;
      }
      EXPECT_LE(pair_excess(*field, cube(1.6)), kRounding);
      ++made;
    }
  }
  EXPECT_GT(refused, 15);
  EXPECT_GT(made, 50);
}

std::string random_formula(std::mt19937& random, int depth) {
  const auto any = [&] { return random_formula(random, depth - 1); };
  const auto pick = [&](const std::vector<std::string>& of) { return of[random() % of.size()]; };
  if (depth == 0) return pick({"x", "y", "z", "2*x", "0.7", "1.5", "x + y", "z - 0.3"});
  switch (random() % 4) {
    case 0:
      return "(" + any() + pick({" + ", " - ", " * ", " / "}) + any() + ")";
    case 1:
      return "(" + any() + ")" + pick({"^2", "^3", "^1.5", "^0.5", "^-1"});
    case 2:
      return "sqrt((" + any() + ")^2 + 2*(" + any() + ")^2" + pick({"", " + y*y", " + 0.1"}) + ")";
    default: {
      const auto all = sdfgrid::formula_functions();
      const sdfgrid::FormulaFunction& f = all[random() % all.size()];
      std::string text = std::string(f.name) + "(" + any();
      for (int i = 1; i < f.least; ++i) text += ", " + any();
      return text + ")";
    }
  }
}

// In double, as intermediate results may be large; only the values are rounded to float.
TEST(FormulaSafety, RandomFormulasAreBoundedOrRefused) {
  std::mt19937 random(22);
  int made = 0;
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    const std::string text = random_formula(random, 1 + i % 3);
    SCOPED_TRACE(text);
    try {
      const Field field = certified(text, cube(1));
      double largest = 1;
      const auto values = [&](Points& p) {
        for (std::size_t k = 0; k < p.x.size(); ++k) {
          const double value = field.gradient(p.at(k)).value;
          largest = std::fmax(largest, std::fabs(value));
          p.value[k] = static_cast<float>(value);
        }
      };
      const double excess = pair_excess(values, cube(1.3), 1, 3000);
      EXPECT_LE(excess, 0x1p-22 * largest);
      ++made;
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(made, 150);
  EXPECT_GT(refused, 50);
}

TEST(FormulaSafety, JumpsAreRefusedByName) {
  const Box around{{0.5, -1, -1}, {1.5, 1, 1}};
  const std::string text = refusal("mod(x, 1) - 0.1", around);
  EXPECT_TRUE(holds(text,
                    "formula: `mod` jumps on the region from (0.5, -1, -1) to (1.5, 1, 1), "
                    "near ("))
      << text;
  EXPECT_TRUE(holds(text, "`repeat`") && holds(text, "`function`") &&
              holds(text, "abs, min and max") && holds(text, "order: 1"))
      << text;
  EXPECT_TRUE(holds(refusal("floor(3*x) - y", around), "`floor` jumps"));
  EXPECT_TRUE(holds(refusal("sign(y) + x - 1", around), "`sign` jumps"));
  EXPECT_TRUE(holds(refusal("x*sign(y)", around), "`sign` jumps"));
  EXPECT_TRUE(holds(refusal("atan2(y, -x) + z", around), "`atan2` jumps"));
  // Beside the jump, up to the region's end, and where nothing is left of it.
  for (const char* f : {"mod(x, 2) - 1", "mod(y, 1)*0 + x - 1", "atan2(y, x) + z",
                        "sign(x) - 2 + x", "sign(y^2) - x", "max(floor(y) - 1, x) - 1"}) {
    EXPECT_EQ(refusal(f, around), "") << f;
    EXPECT_LE(pair_excess(certified(f, around), cube(2)), kRounding) << f;
  }
  EXPECT_EQ(refusal("floor(x) + y", {{0, -1, -1}, {0.9, 1, 1}}), "");
  // A factor that is 0 where the sign jumps takes the jump out.
  for (const char* f : {"y*sign(y) - x + 0.3", "sign(y - z) * (y - z) + x - 1",
                        "2*y*z*sign(z) - 0.1", "y^2*sign(y) - z", "sign(z)*z^3 + x - 1",
                        "abs(y)^3*sign(y) + z - 0.2", "abs(y)^2.5*sign(y) + z - 0.2"}) {
    EXPECT_EQ(refusal(f, around), "") << f;
    EXPECT_LE(pair_excess(certified(f, around), cube(2)), kRounding) << f;
  }
  for (const char* f :
       {"(y + 1)*sign(y) - x", "y*sign(z)", "y^0.5*sign(y) - x", "y^-2*sign(y) - x"}) {
    EXPECT_NE(refusal(f, around), "") << f;
  }
  try {
    (void)make_field("formula_displace", {{"f", "0.1*mod(4*x, 1)"}}, {make_field("sphere")});
    FAIL();
  } catch (const Error& error) {
    EXPECT_TRUE(holds(error.what(), "formula_displace: `mod` jumps on the region")) << error.what();
    EXPECT_FALSE(holds(error.what(), "order")) << error.what();
  }
}

// A root of a sum of squares is a length: its slope is bounded where that of the root is not.
TEST(FormulaSafety, LengthsAndPowersHaveTheirSlope) {
  const Box box = cube(1.5);
  const auto worth = [&](const char* f, const glm::vec3& p) { return certified(f, box)(p); };
  // The distance itself.
  EXPECT_NEAR(worth("sqrt(x^2 + y^2 + z^2) - 1", {1.3F, 0, 0}), 0.3, 1e-5);
  EXPECT_NEAR(worth("(x^2 + y^2 + z^2)^0.5 - 1", {0, 0.6F, 0}), -0.4, 1e-5);
  EXPECT_NEAR(worth("sqrt(x*x + y**2) - 0.5", {0, 1.3F, 1}), 0.8, 1e-5);
  EXPECT_NEAR(worth("sqrt(x^2) - 0.5", {1.3F, 1, 1}), 0.8, 1e-5);
  EXPECT_NEAR(worth("(sqrt(4*x^2 + (2*y)^2) - 1)/2", {1.3F, 0, 0}), 0.8, 1e-5);
  EXPECT_NEAR(worth("sqrt((sqrt(x^2 + y^2) - 0.8)^2 + z^2) - 0.3", {1.4F, 0, 0}), 0.3, 1e-5);
  for (const char* f : {"(sqrt(x^2+y^2)-1)^2+z^2-0.16", "abs(x)^2.5+y^2+z^2-1", "x^2.5+y^2+z^2-1",
                        "(x^2+y^2)^1.5+z-0.5", "sqrt(x^4+y^4)-z", "sqrt((x*y)^2+z^2)-0.5"}) {
    EXPECT_EQ(refusal(f, box), "") << f;
    EXPECT_LE(pair_excess(certified(f, box), cube(2)), kRounding) << f;
  }
  EXPECT_TRUE(holds(refusal("sqrt(x^2 - y^2) - 0.5", box), "`sqrt` has a slope without bound"));
  EXPECT_TRUE(holds(refusal("abs(x)^0.7 - 0.5", box), "`^` has a slope without bound"));
  EXPECT_TRUE(holds(refusal("log(x - 2) + x", box), "`log` has a slope without bound"));
  EXPECT_TRUE(holds(refusal("tan(2*x) + y", box), "`tan` has a slope without bound"));
  EXPECT_TRUE(holds(refusal("asin(x) + y", box), "`asin` has a slope without bound"));
  EXPECT_TRUE(holds(refusal("1/x", box), "`/` has a slope without bound"));
}

TEST(FormulaSafety, SteepSlopesAreSaidToBeSteep) {
  const std::string text = refusal("exp(10*x) + y^2 + z^2 - 2", cube(1.5));
  EXPECT_TRUE(holds(text, "its slope may be 3.27e+07 on the region")) << text;
  EXPECT_TRUE(holds(text, "divide the formula by a number")) << text;
  EXPECT_EQ(refusal("(exp(10*x) + y^2 + z^2 - 2)/100", cube(1.5)), "");
}

TEST(FormulaSafety, FunctionsOfOneVariableRefuseOthers) {
  const auto said = [](const std::string& f, const char* mode) -> std::string {
    try {
      (void)make_field("function", {{"f", f}, {"mode", mode}});
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(
      said("0.5 + 0.2*sin(4*z)", "revolve_z"),
      "formula: `z` has no value here (the variable is x) at character 17\n  0.5 + 0.2*sin(4*z)\n"
      "                  ^");
  EXPECT_TRUE(holds(said("y", "extrude"), "`y` has no value here (the variable is x)"));
  EXPECT_EQ(said("0.5 + 0.2*sin(4*x)", "revolve_z"), "");
  EXPECT_EQ(said("sqrt(1 - x^2)", "revolve_x"), "");
  EXPECT_FALSE(holds(said("1/x", "extrude"), "order"));
  // More arcs than there may be, and steeper than any bound.
  EXPECT_TRUE(holds(said("1 + sqrt(abs(sin(9000*x)))", "extrude"),
                    "keep away from where it degenerates: give another range by `from` and `to`"))
      << said("1 + sqrt(abs(sin(9000*x)))", "extrude");
}

}  // namespace
