// How far from their surfaces a field looks at the values of its samplers.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "sdfgrid/field/field.h"
#include "sdfgrid/field/program_data.h"
#include "sdfgrid/field/registry.h"

namespace sdfgrid {
namespace {

class Uses {
 public:
  // `size`: how far from each other surfaces may lie.
  Uses(const Program& program, double size)
      : program_(program),
        size_(size),
        own_starts_(program.starts.empty() ? subtree_starts(program.code)
                                           : std::vector<std::int32_t>()),
        starts_(program.starts.empty() ? own_starts_ : program.starts) {}

  // Of the subtree that ends at instruction `last`. A list of nodes is joined two by two: what the
  // outer joins of one list ask for is hardly more than what one asks for, so no more than two of
  // them count.
  void add(int last, const Levels& levels, int joins = 0) {
    const Instruction& at = program_.code[last];
    if (at.step == Step::sample) {
      (void)add_use(found, {&sampler_of(program_, at), levels.lo, levels.hi});
    }
    if (at.step == Step::sample || at.step == Step::leaf) return;
    constexpr int kMostJoins = 2;
    const RegisteredOp& op = registry()[at.op];
    const Levels first =
        joins < kMostJoins ? op.looks_at(constants_of(program_, at), levels, size_) : levels;
    const Levels second = op.turns_last ? first.negated() : first;
    if (at.step != Step::combine) return add(last - 1, second);
    const auto joins_below = [&](int node) {
      return program_.code[node].op == at.op ? joins + 1 : 0;
    };
    add(last - 1, second, joins_below(last - 1));
    const int other = starts_[last - 1] - 1;
    add(other, first, joins_below(other));
  }

  std::vector<SamplerUse> found;

 private:
  const Program& program_;
  double size_;
  const std::vector<std::int32_t> own_starts_;
  const std::vector<std::int32_t>& starts_;
};

}  // namespace

SamplerUse& add_use(std::vector<SamplerUse>& uses, const SamplerUse& use) {
  const auto same = [&](const SamplerUse& known) { return known.sampler == use.sampler; };
  const auto found = std::find_if(uses.begin(), uses.end(), same);
  SamplerUse& known =
      found != uses.end() ? *found : uses.emplace_back(SamplerUse{use.sampler, 0, 0});
  known.lo = std::fmin(known.lo, use.lo);
  known.hi = std::fmax(known.hi, use.hi);
  return known;
}

std::vector<SamplerUse> Field::sampler_uses() const {
  const double diagonal = glm::length(bounds().size());
  Uses uses(*program_, std::isfinite(diagonal) ? 0.5 * diagonal : 0);
  uses.add(static_cast<int>(program_->code.size()) - 1, {});
  return uses.found;
}

}  // namespace sdfgrid
