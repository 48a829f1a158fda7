// How far from their surfaces a field looks at the values of its samplers.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <string_view>

#include "sdfgrid/field/field.h"
#include "sdfgrid/field/program_data.h"
#include "sdfgrid/field/registry.h"

namespace sdfgrid {
namespace {

// Values that matter for a surface, around 0 if nothing moves it.
struct Levels {
  double lo = 0;
  double hi = 0;

  [[nodiscard]] Levels wider(double by) const { return {lo - by, hi + by}; }
  [[nodiscard]] Levels negated() const { return {-hi, -lo}; }
};

// The first number of an op's struct: the width of a smooth blend, the thickness of a shell.
double first_number(const Program& program, const Instruction& at) {
  return static_cast<double>(constants_of(program, at)[0]);
}

// What is asked of the nodes of an op, so that it is right at `levels`.
struct Asked {
  Levels first;
  Levels last;  // of an op of one node: its
};

Asked asked_by(const Program& program, const Instruction& at, const Levels& levels, double size) {
  const std::string_view op = registry()[at.op].entry.info->name;
  const auto both = [](const Levels& of) { return Asked{of, of}; };
  if (op == "complement") return both(levels.negated());
  if (op == "difference") return {levels, levels.negated()};
  if (op == "smooth_union" || op == "smooth_intersection" || op == "smooth_difference") {
    const Levels wider = levels.wider(first_number(program, at));
    return {wider, op == "smooth_difference" ? wider.negated() : wider};
  }
  if (op == "morph" || op == "spatial_morph") return both(levels.wider(size));
  if (op == "shell") {
    const double most = levels.hi + 0.5 * first_number(program, at);
    return both({-most, most});
  }
  const auto child_level = registry()[at.op].child_level;
  const float* c = constants_of(program, at);
  if (op == "offset") return both({child_level(c, levels.lo), child_level(c, levels.hi)});
  if (at.step != Step::combine && at.step != Step::range) {  // scales
    return both({-child_level(c, -levels.lo), child_level(c, levels.hi)});
  }
  // Blends read more than what they lower the surface by.
  constexpr double kOfBlends = 4;
  const double more = child_level(c, levels.hi) - levels.hi;
  const bool blends = at.step == Step::combine && op != "blend";
  return both(levels.wider(std::fmax(more, 0) * (blends ? kOfBlends : 1)));
}

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
    if (at.step == Step::sample) return add_use(&sampler_of(program_, at), levels);
    if (at.step == Step::leaf) return;
    constexpr int kMostJoins = 2;
    const Asked asked =
        joins < kMostJoins ? asked_by(program_, at, levels, size_) : Asked{levels, levels};
    const auto joins_below = [&](int node) {
      return program_.code[node].op == at.op ? joins + 1 : 0;
    };
    if (at.step != Step::combine) return add(last - 1, asked.last);
    add(last - 1, asked.last, joins_below(last - 1));
    const int first = starts_[last - 1] - 1;
    add(first, asked.first, joins_below(first));
  }

  std::vector<SamplerUse> found;

 private:
  void add_use(const Sampler* sampler, const Levels& levels) {
    const auto same = [&](const SamplerUse& use) { return use.sampler == sampler; };
    const auto known = std::find_if(found.begin(), found.end(), same);
    SamplerUse& use = known != found.end() ? *known : found.emplace_back(SamplerUse{sampler, 0, 0});
    use.lo = std::fmin(use.lo, levels.lo);
    use.hi = std::fmax(use.hi, levels.hi);
  }

  const Program& program_;
  double size_;
  const std::vector<std::int32_t> own_starts_;
  const std::vector<std::int32_t>& starts_;
};

}  // namespace

std::vector<SamplerUse> Field::sampler_uses() const {
  const double diagonal = glm::length(bounds().size());
  Uses uses(*program_, std::isfinite(diagonal) ? 0.5 * diagonal : 0);
  uses.add(static_cast<int>(program_->code.size()) - 1, {});
  return uses.found;
}

}  // namespace sdfgrid
