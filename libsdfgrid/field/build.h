// field/build.h: the parts that fields are made of, for ops that take more than numbers (internal
// to field/).
#pragma once

#include <optional>

#include "sdfgrid/core/error.h"
#include "sdfgrid/field/program_data.h"
#include "sdfgrid/field/registry.h"

namespace sdfgrid {

// The arguments of one op, checked against its parameters. Everything throws Error{input}.
class CheckedArguments {
 public:
  // Refuses names that the op does not have.
  CheckedArguments(const OpEntry& op, const std::vector<Argument>& arguments);

  [[nodiscard]] bool has(std::string_view name) const { return find(name) != nullptr; }
  // The numbers of a parameter or its default, within range.
  [[nodiscard]] std::vector<double> numbers(std::string_view name) const;
  [[nodiscard]] double number(std::string_view name) const { return numbers(name)[0]; }
  // Its text; `fallback` if there is none, which null forbids. A number counts as its text.
  [[nodiscard]] std::string text(std::string_view name, const char* fallback) const;
  [[nodiscard]] Error refused(const std::string& what) const;

 private:
  [[nodiscard]] const Argument* find(std::string_view name) const;
  [[nodiscard]] const Parameter& parameter(std::string_view name) const;

  OpEntry op_;
  const std::vector<Argument>& arguments_;
};

// How many floats of an op's struct a parameter fills; 0 if it stands in the op's list.
[[nodiscard]] int width_of(ParameterKind kind);

// An instruction for the op: parameters and list appended to the draft's pool, prepared.
[[nodiscard]] Instruction add_op(Draft& draft, int number, std::vector<float> parameters,
                                 const std::vector<float>& list);
[[nodiscard]] Field make_leaf(int number, const std::vector<float>& parameters,
                              const std::vector<float>& list);

// Appends a node with an op of one node around it, or after it.
void append_around(Draft& draft, Instruction at, const Program& node);
// The field of an op of one node, from the numbers of its parameters.
[[nodiscard]] Field make_unary(int number, const std::vector<float>& parameters, const Field& node);

// Refuses a box without end: nothing bounds a slope over all of space.
void check_finite(const OpInfo& op, const Box& box);

// A field whose slope is bounded over a region only, as a distance bound everywhere. The region is
// the box of its inside, or `box`, where the solid then ends.
[[nodiscard]] Field bounded_by_region(const OpInfo& op, const Field& raw,
                                      const std::optional<Box>& box = {});
// The same with a slope that is taken for granted.
[[nodiscard]] Field within_region(const Field& raw, const Box& box, double slope);

}  // namespace sdfgrid
