// The GLSL reading: every op's formula with text for numbers.
#include <fmt/format.h>

#include <cmath>

#include "sdfgrid/core/error.h"
#include "sdfgrid/field/interpret.h"
#include "sdfgrid/field/text.h"

namespace sdfgrid {
namespace ops {

std::string glsl_number(double v) {
  if (std::isinf(v)) return v > 0 ? "1e38" : "(-1e38)";
  std::string s = fmt::format("{:.9g}", v);
  if (s.find_first_of(".e") == std::string::npos) s += ".0";
  return v < 0 || (v == 0 && std::signbit(v)) ? "(" + s + ")" : s;
}

namespace {

// What drivers take for constants of a function.
constexpr int kMostConstants = 4096;

void check_count(int count, const char* of) {
  if (count <= kMostConstants) return;
  throw Error(ErrorKind::input, fmt::format("{} of {} numbers is too large for GLSL, which takes "
                                            "{}; make it smaller or leave it out",
                                            of, count, kMostConstants));
}

}  // namespace

std::string TextSink::array(const float* values, int count) {
  check_count(count, "a picture");
  std::string& name = arrays[values];
  if (!name.empty()) return name;
  name = "a" + std::to_string(arrays.size());
  body += fmt::format("  const float {}[{}] = float[{}](", name, count, count);
  for (int i = 0; i < count; ++i) body += (i > 0 ? ", " : "") + glsl_number(values[i]);
  body += ");\n";
  return name;
}

std::string TextSink::rows(const float* values, int width, int count) {
  constexpr int kVectors = 3;
  check_count(kVectors * count, "a graph");
  std::string& name = arrays[values];
  if (!name.empty()) return name;
  name = "a" + std::to_string(arrays.size());
  const int all = kVectors * count;
  body += fmt::format("  const vec4 {}[{}] = vec4[{}](", name, all, all);
  for (int i = 0; i < 4 * all; ++i) {
    const int column = i % (4 * kVectors);
    if (i % 4 == 0) body += i > 0 ? "), vec4(" : "vec4(";
    body += i % 4 > 0 ? ", " : "";
    body += column < width ? glsl_number(values[i / (4 * kVectors) * width + column]) : "0.0";
  }
  body += "));\n";
  return name;
}

}  // namespace ops

std::string Field::glsl(const std::string& function) const {
  using namespace ops;
  static const auto functions = make_functions<Text>();
  TextSink sink;
  TextSink* const outer = TextSink::current();
  TextSink::current() = &sink;
  const Point<Text> p = {Text::named("p.x"), Text::named("p.y"), Text::named("p.z")};
  const auto leaf = [&](const Instruction& at, const Point<Text>& q) {
    if (at.step == Step::sample) {
      throw Error(ErrorKind::input,
                  "a grid, mesh, point set or cubic curve has no form in GLSL; leave it out");
    }
    return functions[at.op].leaf(constants_of(*program_, at), data_of(*program_, at), q);
  };
  try {
    const Text result = interpret(*program_, functions, p, leaf);
    TextSink::current() = outer;
    return fmt::format("float {}(vec3 p) {{\n{}  return {};\n}}\n", function, sink.body,
                       result.name);
  } catch (...) {
    TextSink::current() = outer;
    throw;
  }
}

}  // namespace sdfgrid
