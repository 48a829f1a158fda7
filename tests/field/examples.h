// tests/field/examples.h: a field for each op of the list, made from the example in its own text.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sdfgrid/field/field.h"

// A node as scenes have them: one word with its parameters, and the nodes that it works on.
struct ExampleNode {
  std::string word;
  std::vector<sdfgrid::Argument> arguments;
  std::vector<ExampleNode> of;
};

// Reads a node in YAML flow style, as the examples of ops are: a small reader of its own, so that
// the tests of field/ need no room below it.
ExampleNode read_node(const std::string& text);
sdfgrid::Field make_field(const ExampleNode& node);
sdfgrid::Field read_example(const std::string& text);

struct Example {
  const sdfgrid::OpEntry* op;
  ExampleNode node;
  sdfgrid::Field field;
  std::string text;
  bool sampled = false;                               // a Sampler takes part
  bool estimate = false;                              // no bound is promised
  std::function<bool(const glm::dvec3&)> solid = {};  // whether a point is inside, of file_leaves()
};

// Formulas for the box from -1 to 1: one for each function that formulas may call, where it has no
// jump and no pole, and others with kinks, lengths and powers.
std::vector<std::string> example_formulas();

// The examples of all ops, then others of those that have several forms, then the formulas above,
// certified and estimated, then grids and meshes; and where they are worth looking at.
const std::vector<Example>& examples();
sdfgrid::Box example_box(const sdfgrid::Field& field);
