// Runs a program over one block of points: the two stacks are arrays of blocks.
#include "sdfgrid/field/batch_family.h"
#include "sdfgrid/field/batch_kernel.h"

namespace sdfgrid::SDFGRID_ISA {
namespace {

const BatchFamily* const kFamilies[] = {
    &kCombinations, &kBlends,        &kRanges,        &kDisplacements, &kDomains,
    &kFolds,        &kWarps,         &kMoreWarps,     &kBasicLeaves,   &kRoundLeaves,
    &kSoftLeaves,   &kFractalLeaves, &kTerrainLeaves, &kFormulas};

void set_point(const float* p[3], const float* const from[3]) {
  for (int a = 0; a < 3; ++a) p[a] = from[a];
}

// The two stacks over one block, in the rows of the scratch memory (program.h); the lowest value is
// the result itself, the outermost point is where it lies.
struct Stacks {
  float* out;
  float* rows;

  float* value(int depth) const { return depth == 0 ? out : value_row(rows, depth); }
  float* coordinate(int depth, int axis) const { return point_row(rows, depth, axis); }
};

void run(const BatchProgram& program, int n, const float* const p[3], float* out, float* scratch) {
  const Stacks stacks = {out, scratch};
  const float* points[kMaxPoints + 1][3];
  set_point(points[0], p);
  BatchStep step{};
  step.n = n;
  int top = 0;    // values on the stack
  int inner = 0;  // points on the stack above the outermost
  for (int i = 0; i < program.size; ++i) {
    const Instruction& at = program.code[i];
    step.constants = program.constants + at.constants;
    step.data = program.constants + at.data;
    step.offset = at.offset;
    step.count = static_cast<int>(at.count);
    if (at.step == Step::leave) --inner;
    set_point(step.p, points[inner]);
    const BatchFamily& family = *kFamilies[at.op / kFamilySize];
    const int place = at.op % kFamilySize;
    if (at.step == Step::leaf) {
      step.out = stacks.value(top++);
      family.apply[place](step);
    } else if (at.step == Step::sample) {
      program.sample(program.samplers[at.sampler], n, step.p, stacks.value(top++));
    } else if (at.step == Step::enter) {
      ++inner;
      for (int a = 0; a < 3; ++a) points[inner][a] = step.q[a] = stacks.coordinate(inner, a);
      family.apply[place](step);
    } else {
      if (at.step == Step::combine) step.b = stacks.value(--top);
      step.out = stacks.value(top - 1);
      step.a = step.out;
      const BatchFunction function =
          at.step == Step::leave ? family.leave[place] : family.apply[place];
      if (function != nullptr) function(step);
    }
  }
}

}  // namespace

extern const FieldKernel kFieldKernel = {run};

}  // namespace sdfgrid::SDFGRID_ISA
