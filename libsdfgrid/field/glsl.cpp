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

std::string TextSink::array(const float* values, int count) {
  constexpr int kMost = 1024;
  if (count > kMost) {
    throw Error(ErrorKind::input, fmt::format("a picture of {} samples is too large for GLSL; make "
                                              "it smaller than {}",
                                              count, kMost));
  }
  std::string& name = arrays[values];
  if (!name.empty()) return name;
  name = "a" + std::to_string(arrays.size());
  body += fmt::format("  const float {}[{}] = float[{}](", name, count, count);
  for (int i = 0; i < count; ++i) body += (i > 0 ? ", " : "") + glsl_number(values[i]);
  body += ");\n";
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
