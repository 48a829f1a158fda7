// The parser of formulas: values, carets, and that no text breaks it.
#include "sdfgrid/field/formula.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>

#include "sdfgrid/core/error.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/field/formula_code.h"

namespace {

using sdfgrid::Error;
using sdfgrid::Field;
using sdfgrid::formula_functions;
using sdfgrid::FormulaFunction;
using sdfgrid::make_field;
using sdfgrid::parse_formula;
using sdfgrid::parse_number;

double value(const std::string& text, double x = 0, double y = 0, double z = 0) {
  const std::vector<float> code = parse_formula(text);
  return sdfgrid::ops::run_formula(sdfgrid::ops::Data{code.data(), static_cast<int>(code.size())},
                                   sdfgrid::ops::Point<double>{x, y, z});
}

std::string refusal(const std::string& text) {
  try {
    (void)parse_formula(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), sdfgrid::ErrorKind::input);
    return error.what();
  }
  return "";
}

TEST(Formula, Values) {
  EXPECT_DOUBLE_EQ(parse_number("2+3*4^2/8-1"), 7);
  EXPECT_DOUBLE_EQ(parse_number("-2^2"), -4);
  EXPECT_DOUBLE_EQ(parse_number("2^-1"), 0.5);
  EXPECT_DOUBLE_EQ(parse_number("2^3^2"), 512);
  EXPECT_DOUBLE_EQ(parse_number("2**3"), 8);
  EXPECT_DOUBLE_EQ(parse_number("cos(2*pi*t)", 0.5), -1);
  EXPECT_DOUBLE_EQ(parse_number("max(1, 5, 3) + min(4, 2)"), 7);
  EXPECT_DOUBLE_EQ(parse_number("1e3 + .5"), 1000.5);
  EXPECT_NEAR(value("x^2 + y^2*z - 1", 3, 2, 5), 28, 1e-12);
  EXPECT_NEAR(value("tan(x)", 0.7), std::tan(0.7), 1e-7);
  EXPECT_NEAR(value("asin(x)", 0.3), std::asin(0.3), 1e-7);
  EXPECT_NEAR(value("atan(x)", -2), std::atan(-2), 1e-7);
  EXPECT_NEAR(value("sinh(x)", 0.7), std::sinh(0.7), 1e-7);
  EXPECT_NEAR(value("cosh(x)", 0.7), std::cosh(0.7), 1e-7);
  EXPECT_NEAR(value("tanh(x)", 0.7), std::tanh(0.7), 1e-7);
  EXPECT_NEAR(value("mod(x + 1, y * 2)", 6.5, 1), 1.5, 1e-12);
  EXPECT_NEAR(value("x^y", 2, 0.5), std::sqrt(2), 1e-12);
  EXPECT_NEAR(value("pow(x, 3) + x^0.5", 4), 66, 1e-12);
  EXPECT_NEAR(value("sqrt(abs(x)) * sign(x) + floor(y)", -4, 2.7), 0, 1e-12);
  EXPECT_NEAR(value("x*sign(x) + y*y*sign(y)", -4, -2), 4 - 4, 1e-12);
  EXPECT_NEAR(value("x^3*sign(x) + sign(y)*abs(y)^3", -4, -2), 64 - 8, 1e-12);
  EXPECT_NEAR(value("exp(log(x))", 3), 3, 1e-12);
}

// The list that users see is the parser's own: each with as many arguments as it says, no fewer.
TEST(Formula, ListedFunctionsAreThoseThatParse) {
  const auto call = [](const FormulaFunction& f, int arguments) {
    std::string text = fmt::format("{}(0.5", f.name);
    for (int i = 1; i < arguments; ++i) text += ", 0.5 + x";
    return refusal(text + ")");
  };
  for (const FormulaFunction& f : formula_functions()) {
    EXPECT_EQ(call(f, f.least), "") << f.name;
    EXPECT_EQ(call(f, f.most), "") << f.name;
    EXPECT_NE(call(f, f.most + 1), "") << f.name;
    EXPECT_EQ(std::count(f.arguments, f.arguments + std::strlen(f.arguments), ','),
              f.most > 2 ? 2 : f.least - 1)
        << f.name;
    // An error names all that there are.
    EXPECT_NE(refusal("foo(1)").find(fmt::format(" {}", f.name)), std::string::npos);
  }
  EXPECT_GE(formula_functions().size(), 20U);
}

TEST(Formula, ErrorsPointAtTheFault) {
  EXPECT_EQ(refusal("x^2 + (y*3"),
            "formula: this parenthesis is never closed at character 7\n  x^2 + (y*3\n        ^");
  EXPECT_EQ(
      refusal("x + * y"),
      "formula: expected a number, a name or a parenthesis at character 5\n  x + * y\n      ^");
  EXPECT_EQ(refusal("x 2"),
            "formula: expected an operator or the end at character 3\n  x 2\n    ^");
  EXPECT_EQ(refusal("x)"), "formula: there is no parenthesis to close at character 2\n  x)\n   ^");
  EXPECT_NE(refusal("foo + 1").find("unknown name `foo`"), std::string::npos);
  EXPECT_NE(refusal("foo(1)").find("unknown function `foo`"), std::string::npos);
  EXPECT_NE(refusal("sin(1, x)").find("takes 1 arguments, not 2"), std::string::npos);
  for (const char* text : {"1/0", "log(-1)", "log(0)", "(-8)^0.7"}) {
    EXPECT_NE(refusal(text).find("not a finite number"), std::string::npos) << text;
  }
  EXPECT_NE(refusal("").find("ends where"), std::string::npos);
  EXPECT_NE(refusal("1e999").find("not a number in range"), std::string::npos);
  try {
    (void)parse_number("2*exp(x)");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()),
              "formula: `x` has no value here (a number is wanted) at character 7\n  2*exp(x)\n"
              "        ^");
  }
}

TEST(Formula, DeepAndLongTextsAreRefused) {
  EXPECT_NE(refusal(std::string(1000, '(') + "x" + std::string(1000, ')')), "");
  EXPECT_NE(refusal(std::string(3000, '-') + "x"), "");
  EXPECT_NE(refusal(std::string(1000000, '(')), "");
  std::string powers = "x";
  for (int i = 0; i < 1000; ++i) powers += "^x";
  EXPECT_NE(refusal(powers), "");
  std::string stacked = "x";
  for (int i = 0; i < 60; ++i) stacked = "(x+" + stacked + ")";
  EXPECT_NE(refusal(stacked), "");
}

// Random texts from the parser's own tokens and from all bytes: a value or an Error, nothing else.
TEST(Formula, SurvivesRandomTexts) {
  const std::vector<std::string> tokens = {
      "x",  "y", "z",    "t",    "1",    "2.5",   "(",    ")", "+",      "-",  "*", "/", "^",
      "**", ",", "sin(", "max(", "mod(", "tanh(", "pow(", " ", "atan2(", "pi", "e", "."};
  std::mt19937 random(3);
  int parsed = 0;
  for (int i = 0; i < 50000; ++i) {
    std::string text;
    const auto length = 1 + random() % 12;
    for (unsigned k = 0; k < length; ++k) {
      text += random() % 50 == 0 ? std::string(1, static_cast<char>(random() % 256))
                                 : tokens[random() % tokens.size()];
    }
    try {
      value(text, 0.3, 0.4, 0.5);
      ++parsed;
    } catch (const Error&) {
    }
  }
  EXPECT_GT(parsed, 1500);
}

TEST(FormulaField, TheCertifiedBoundIsTheDistanceOfABall) {
  const Field f = make_field("formula", {{"f", "x^2 + y^2 + z^2 - 1"}});
  EXPECT_NEAR(f.bounds().hi.x, 1, 1e-3);
  EXPECT_EQ(f(glm::vec3(1, 0, 0)), 0);
  EXPECT_LT(f(glm::vec3(0)), 0);
  EXPECT_GT(f(glm::vec3(3, 0, 0)), 1.9F);  // a little more than the region from there
  EXPECT_LE(f(glm::vec3(3, 0, 0)), 2);
}

// The second order is exact on a ball, inside as well (printed without the sign it is NaN there).
TEST(FormulaField, OrdersOfABall) {
  const std::vector<sdfgrid::Argument> ball = {{"f", "x^2 + y^2 + z^2 - 1"},
                                               {"bounds", {-2, -2, -2, 2, 2, 2}}};
  auto first = ball;
  first.emplace_back("order", 1);
  auto second = ball;
  second.emplace_back("order", "2");
  EXPECT_NEAR(make_field("formula", first)(glm::vec3(1.5, 0, 0)), 1.25 / 3, 1e-6);
  // The Frobenius norm of the Hessian 2 I is 2 sqrt(3), a little more than its norm 2.
  EXPECT_NEAR(make_field("formula", second)(glm::vec3(1.5, 0, 0)),
              2 * 1.25 / (3 + std::sqrt(9 + 2 * 2 * std::sqrt(3.0) * 1.25)), 1e-6);
  EXPECT_NEAR(make_field("formula", second)(glm::vec3(0.3F, 0, 0)),
              -2 * 0.91 / (0.6 + std::sqrt(0.36 + 2 * 2 * std::sqrt(3.0) * 0.91)), 1e-6);
}

TEST(FormulaField, RefusesWhatHasNoEndOrNoSlope) {
  EXPECT_THROW(make_field("formula", {{"f", "x + y"}}), Error);
  EXPECT_THROW(make_field("formula", {{"f", "1/x"}, {"bounds", {-1, -1, -1, 1, 1, 1}}}), Error);
  EXPECT_THROW(make_field("formula", {{"f", "x"}, {"bounds", {-1, -1, -1}}}), Error);
  EXPECT_THROW(make_field("formula", {{"f", "x"}, {"order", "3"}}), Error);
  EXPECT_THROW(make_field("formula"), Error);
}

}  // namespace
