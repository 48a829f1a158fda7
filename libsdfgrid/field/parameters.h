// field/parameters.h: short forms for the parameter lists of ops (internal to field/).
#pragma once

#include "sdfgrid/field/op.h"

namespace sdfgrid::ops {

inline constexpr double kRequired = __builtin_nan("");
inline constexpr double kAny = 1e9;                    // no coordinate or length is larger
inline constexpr double kSmall = 1e-6;                 // no size is smaller
inline constexpr double kUnlimited = __builtin_inf();  // as an upper limit: infinity is a value

// A size: positive.
constexpr Parameter size(const char* name, double fallback, const char* text) {
  return {name, ParameterKind::number, "length", {fallback, 0, 0}, kSmall, kAny, text};
}
// A length of either sign.
constexpr Parameter length_of(const char* name, double fallback, const char* text) {
  return {name, ParameterKind::number, "length", {fallback, 0, 0}, -kAny, kAny, text};
}
constexpr Parameter number(const char* name, double fallback, double lo, double hi,
                           const char* text, const char* unit = "") {
  return {name, ParameterKind::number, unit, {fallback, 0, 0}, lo, hi, text};
}
constexpr Parameter whole(const char* name, double fallback, double lo, double hi,
                          const char* text) {
  return {name, ParameterKind::whole, "", {fallback, 0, 0}, lo, hi, text};
}
constexpr Parameter vector(const char* name, double x, double y, double z, double lo, double hi,
                           const char* text, const char* unit = "length") {
  return {name, ParameterKind::vector, unit, {x, y, z}, lo, hi, text};
}
constexpr Parameter position(const char* name, double x, double y, double z, const char* text) {
  return vector(name, x, y, z, -kAny, kAny, text);
}
constexpr Parameter sizes(const char* name, double each, const char* text) {
  return vector(name, each, each, each, kSmall, kAny, text);
}

}  // namespace sdfgrid::ops
