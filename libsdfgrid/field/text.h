// field/text.h: GLSL as a number type: every operation writes a statement and is its name from then
// on (internal to field/).
#pragma once

#include <map>
#include <string>

#include "sdfgrid/field/dual.h"
#include "sdfgrid/field/number.h"
#include "sdfgrid/field/profile.h"
#include "sdfgrid/field/texture.h"

namespace sdfgrid::ops {

// Where the statements go; one a text in the making.
struct TextSink {
  std::string body;
  int names = 0;
  std::map<const float*, std::string> arrays;  // by what they hold

  // The name of an array of constants. Throws Error{input} for more than a shader holds.
  std::string array(const float* values, int count);
  // The same of rows of at most twelve numbers, three vec4 each.
  std::string rows(const float* values, int width, int count);

  // `type` is "float" or "bool"; gives the new name.
  std::string define(const char* type, const std::string& expression) {
    const std::string name = "v" + std::to_string(names++);
    body += std::string("  ") + type + " " + name + " = " + expression + ";\n";
    return name;
  }
  // The sink of the thread that writes a text now.
  static TextSink*& current() {
    thread_local TextSink* sink = nullptr;
    return sink;
  }
};

std::string glsl_number(double v);

struct TextMask {
  std::string name;
};

struct Text {
  std::string name = "0.0";

  Text() = default;
  Text(double v) : name(glsl_number(v)) {}
  static Text named(std::string n) {
    Text t;
    t.name = std::move(n);
    return t;
  }
};

inline Text text_of(const std::string& expression) {
  return Text::named(TextSink::current()->define("float", expression));
}
inline TextMask mask_of(const std::string& expression) {
  return {TextSink::current()->define("bool", expression)};
}
inline Text text_of(const char* function, const Text& a) {
  return text_of(std::string(function) + "(" + a.name + ")");
}
inline Text text_of(const char* function, const Text& a, const Text& b) {
  return text_of(std::string(function) + "(" + a.name + ", " + b.name + ")");
}

inline Text operator+(const Text& a, const Text& b) { return text_of(a.name + " + " + b.name); }
inline Text operator-(const Text& a, const Text& b) { return text_of(a.name + " - " + b.name); }
inline Text operator*(const Text& a, const Text& b) { return text_of(a.name + " * " + b.name); }
inline Text operator/(const Text& a, const Text& b) { return text_of(a.name + " / " + b.name); }
inline Text operator-(const Text& a) { return text_of("-" + a.name); }
inline Text& operator+=(Text& a, const Text& b) { return a = a + b; }
inline Text& operator-=(Text& a, const Text& b) { return a = a - b; }
inline Text& operator*=(Text& a, const Text& b) { return a = a * b; }
inline TextMask operator<(const Text& a, const Text& b) { return mask_of(a.name + " < " + b.name); }
inline TextMask operator>(const Text& a, const Text& b) { return mask_of(a.name + " > " + b.name); }
inline TextMask operator<=(const Text& a, const Text& b) {
  return mask_of(a.name + " <= " + b.name);
}
inline TextMask operator>=(const Text& a, const Text& b) {
  return mask_of(a.name + " >= " + b.name);
}
inline TextMask operator&(const TextMask& a, const TextMask& b) {
  return mask_of(a.name + " && " + b.name);
}
inline TextMask operator|(const TextMask& a, const TextMask& b) {
  return mask_of(a.name + " || " + b.name);
}
inline TextMask operator!(const TextMask& a) { return mask_of("!" + a.name); }
inline Text select(const TextMask& m, const Text& yes, const Text& no) {
  return text_of(m.name + " ? " + yes.name + " : " + no.name);
}
inline Text min(const Text& a, const Text& b) { return text_of("min", a, b); }
inline Text max(const Text& a, const Text& b) { return text_of("max", a, b); }
inline Text abs(const Text& a) { return text_of("abs", a); }
inline Text floor(const Text& a) { return text_of("floor", a); }
inline Text sqrt(const Text& a) { return text_of("sqrt(max(" + a.name + ", 0.0))"); }
inline Text square(const Text& a) { return text_of(a.name + " * " + a.name); }
inline Text sign(const Text& a) { return text_of(a.name + " < 0.0 ? -1.0 : 1.0"); }
inline Text exp(const Text& a) { return text_of("exp", a); }
inline Text log(const Text& a) { return text_of("log(max(" + a.name + ", 1.2e-38))"); }
inline Text sin(const Text& a) { return text_of("sin", a); }
inline Text cos(const Text& a) { return text_of("cos", a); }
// GLSL leaves atan(0, 0) and pow(0, b) open.
inline Text atan2(const Text& y, const Text& x) {
  return text_of("(" + y.name + " == 0.0 && " + x.name + " == 0.0) ? 0.0 : atan(" + y.name + ", " +
                 x.name + ")");
}
// As the batch has it: GLSL's own may be off by 5e-4, and Mesa's is by 2e-4.
inline Text acos(const Text& a) {
  const Text x = text_of("clamp(" + a.name + ", -1.0, 1.0)");
  return atan2(sqrt((Text(1.0) - x) * (Text(1.0) + x)), x);
}
inline Text pow(const Text& a, const Text& b) {
  return text_of(a.name + " > 0.0 ? pow(" + a.name + ", " + b.name + ") : 0.0");
}
inline Text unit_ratio(const Text& part, const Text& whole) {
  return text_of(whole.name + " > 0.0 ? " + part.name + " / " + whole.name + " : 0.0");
}
inline Text texel(const Texture& t, const Text& column, const Text& row) {
  const std::string array = TextSink::current()->array(t.values, t.width * t.height);
  const auto index = [](const Text& place, int size) {
    return "clamp(int(" + place.name + "), 0, " + std::to_string(size - 1) + ")";
  };
  return text_of(array + "[" + index(row, t.height) + " * " + std::to_string(t.width) + " + " +
                 index(column, t.width) + "]");
}

// A loop over all arcs; sides by the arcs above.
inline Text profile_distance(const Profile& profile, const Text& u, const Text& r) {
  TextSink& sink = *TextSink::current();
  constexpr int kFloats = ProfileArc<Text>::kFloats;
  const std::string array = sink.rows(profile.arcs, kFloats, profile.count);
  const std::string best = sink.define("float", "1e36");
  const std::string inside = sink.define("bool", "false");
  sink.body += "  for (int i = 0; i < " + std::to_string(profile.count) + "; ++i) {\n";
  auto next = [&, k = 0]() mutable {
    const std::string row = "3 * i + " + std::to_string(k / 4);
    return text_of(array + "[" + row + "]." + "xyzw"[k++ % 4]);
  };
  ProfileArc<Text> arc;
  for (Text* c : {arc.a, arc.along, &arc.bend, arc.b, arc.leaving}) {
    for (int i = 0; i < (c == &arc.bend ? 1 : 2); ++i) c[i] = next();
  }
  const Text nearest = select(arc.faces(u, r), square(arc.to_circle(u, r)), arc.end_square(u, r));
  const TextMask above = arc.above(u, r);
  sink.body += "  " + best + " = min(" + best + ", " + nearest.name + ");\n";
  sink.body += "  if (" + above.name + ") " + inside + " = !" + inside + ";\n  }\n";
  const Text d = sqrt(Text::named(best));
  return select(TextMask{inside}, -d, d);
}

}  // namespace sdfgrid::ops
