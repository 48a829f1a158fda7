#include <fmt/format.h>

#include <algorithm>

#include "sdfgrid/core/error.h"
#include "sdfgrid/field/program_data.h"
#include "sdfgrid/field/union_tree.h"

namespace sdfgrid {

void append(Draft& to, const Program& from) {
  const auto constants = static_cast<std::uint32_t>(to.pool.constants.size());
  const auto samplers = static_cast<std::uint32_t>(to.pool.samplers.size());
  for (Instruction at : from.code) {
    at.constants += constants;
    at.data += constants;
    at.sampler += samplers;
    to.code.push_back(at);
  }
  const Pool& pool = *from.pool;
  to.pool.constants.insert(to.pool.constants.end(), pool.constants.begin(), pool.constants.end());
  to.pool.samplers.insert(to.pool.samplers.end(), pool.samplers.begin(), pool.samplers.end());
}

Field make_field(Draft draft) {
  return Field(std::make_shared<const Program>(
      make_program(std::move(draft.code), std::make_shared<const Pool>(std::move(draft.pool)))));
}

Program make_program(std::vector<Instruction> code, std::shared_ptr<const Pool> pool) {
  Program program;
  program.code = std::move(code);
  program.pool = std::move(pool);
  std::vector<int> nesting;  // of each value on the stack
  int inner = 0;
  for (const Instruction& at : program.code) {
    switch (at.step) {
      case Step::leaf:
      case Step::sample:
        nesting.push_back(1);
        break;
      case Step::combine: {
        const int last = nesting.back();
        nesting.pop_back();
        nesting.back() = std::max(nesting.back(), last) + 1;
        break;
      }
      case Step::enter:
        ++inner;
        break;
      case Step::leave:
        --inner;
        [[fallthrough]];
      case Step::range:
        ++nesting.back();
        break;
    }
    program.values = std::max(program.values, static_cast<int>(nesting.size()));
    program.points = std::max(program.points, inner);
    program.nesting = std::max(program.nesting, nesting.empty() ? 0 : nesting.back());
  }
  if (program.nesting > kMaxNesting || program.values > kMaxValues || program.points > kMaxPoints) {
    throw Error(ErrorKind::input,
                fmt::format("nodes are nested too deep: {} levels ({} of moved space), at most {} "
                            "({}) are possible; flatten lists of unions, join moves",
                            program.nesting, program.points, kMaxNesting, kMaxPoints));
  }
  if (std::any_of(program.code.begin(), program.code.end(), has_boxes)) {
    program.starts = subtree_starts(program.code);
    program.strewn = std::any_of(program.code.begin(), program.code.end(), [](const auto& at) {
      return has_boxes(at) && is_plain_union(at);
    });
  }
  return program;
}

std::vector<std::int32_t> subtree_starts(const std::vector<Instruction>& code) {
  std::vector<std::int32_t> starts(code.size());
  std::vector<std::int32_t> open;     // of each value on the stack, where its code begins
  std::vector<std::int32_t> entered;  // of each domain op that is not left yet
  for (std::int32_t i = 0; i < std::ssize(code); ++i) {
    switch (code[i].step) {
      case Step::leaf:
      case Step::sample:
        open.push_back(i);
        break;
      case Step::combine:
        open.pop_back();
        break;
      case Step::enter:
        entered.push_back(i);
        break;
      case Step::leave:
        open.back() = entered.back();
        entered.pop_back();
        break;
      case Step::range:
        break;
    }
    starts[i] = code[i].step == Step::enter ? i : open.back();
  }
  return starts;
}

}  // namespace sdfgrid
