// field/program_data.h: what a Field holds, and the building of programs (internal to field/).
#pragma once

#include <memory>
#include <vector>

#include "sdfgrid/field/field.h"
#include "sdfgrid/field/program.h"

namespace sdfgrid {

struct Program {
  std::vector<Instruction> code;
  std::vector<float> constants;  // never empty
  std::vector<std::shared_ptr<const Sampler>> samplers;
  int values = 0;   // greatest depth of the stack of values
  int points = 0;   // and of the points above the outermost
  int nesting = 0;  // of nodes
};

// The op numbers that the library itself needs.
int op_number(std::string_view name);

// Appends all of `from` to `to`, indices moved; depths are not touched.
void append(Program& to, const Program& from);

// Sets the depths of a program from its code. Throws Error{input} if they are too great.
void measure(Program& program);

// Of each instruction the index where the code of its subtree begins.
std::vector<std::int32_t> subtree_starts(const std::vector<Instruction>& code);

}  // namespace sdfgrid
