// field/op.h: what is said of an op: its word in scene files, parameters with ranges and units,
// text, example, source. It stands inside the op's own struct, beside the formula; help, scene
// words, docs/shapes.md and the property tests are made from it.
#pragma once

#include <cstdint>

namespace sdfgrid {

enum class OpRole : std::uint8_t {
  leaf,         // a solid of its own
  combination,  // of two or more nodes
  range,        // changes the value of one node
  domain,       // changes the space of one node
};

enum class OpGuarantee : std::uint8_t {
  exact,          // the Euclidean distance, if those of the nodes under it are
  exact_outside,  // that where it is positive, a bound inside
  exact_inside,   // that where it is negative, a bound outside
  bound,          // never more than the distance (gradient <= 1 by proof)
  computed,       // divided by a bound on its gradient that is computed over the node's region
  estimate,       // a distance estimate without proof; only where the user asks for one
};

enum class ParameterKind : std::uint8_t {
  number,   // one number
  whole,    // one whole number
  pair,     // two numbers; a single one stands for two equal ones where `lo` > 0
  vector,   // three numbers; a single one stands for three equal ones where `lo` > 0
  matrix,   // nine numbers, row by row
  numbers,  // a list of any length
  points,   // a list of triples
  text,     // a formula, a file name, a choice
};

struct Parameter {
  const char* name;
  ParameterKind kind;
  const char* unit;    // "length", "degrees", "1/length", "" for a pure number
  double fallback[3];  // the default; NaN in the first: must be given
  double lo, hi;       // range of each number, both ends allowed
  const char* text;
};

struct OpInfo {
  const char* name;  // the word in scene files
  OpRole role;
  OpGuarantee guarantee;
  const char* text;     // what it is, one to three sentences
  const char* example;  // YAML flow style, a whole node
  const char* source;   // where the formula is from, "" if it is elementary
  bool listed = true;   // false: made by the library itself, no word of scene files
};

}  // namespace sdfgrid
