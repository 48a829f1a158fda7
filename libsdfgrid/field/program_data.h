// field/program_data.h: what a Field holds, and the building of programs (internal to field/).
#pragma once

#include <memory>
#include <vector>

#include "sdfgrid/field/field.h"
#include "sdfgrid/field/program.h"

namespace sdfgrid {

// What instructions refer to; pruned programs share it.
struct Pool {
  std::vector<float> constants = {0};  // never empty: an op without parameters has an address too
  std::vector<std::shared_ptr<const Sampler>> samplers;
};

// A program in the making.
struct Draft {
  std::vector<Instruction> code;
  Pool pool;
};

struct Program {
  std::vector<Instruction> code;
  std::shared_ptr<const Pool> pool = std::make_shared<const Pool>();
  int values = 0;   // greatest depth of the stack of values
  int points = 0;   // and of the points above the outermost
  int nesting = 0;  // of nodes
  // Of each instruction where its subtree begins; only where a union knows its operands' boxes
  // (union_tree.h).
  std::vector<std::int32_t> starts;
  bool strewn = false;  // some of these are plain unions: few of their nodes matter anywhere
};

// The struct of an instruction's op.
inline const float* constants_of(const Program& program, const Instruction& at) {
  return program.pool->constants.data() + at.constants;
}
inline const Sampler& sampler_of(const Program& program, const Instruction& at) {
  return *program.pool->samplers[at.sampler];
}

// The number of an op that exists.
int op_number(std::string_view name);

// Appends all of `from`, its indices moved.
void append(Draft& to, const Program& from);

// Throws Error{input} if the stacks that the code needs are too deep.
[[nodiscard]] Program make_program(std::vector<Instruction> code, std::shared_ptr<const Pool> pool);
[[nodiscard]] Field make_field(Draft draft);

// Of each instruction the index where the code of its subtree begins.
std::vector<std::int32_t> subtree_starts(const std::vector<Instruction>& code);

}  // namespace sdfgrid
