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

void run(const BatchProgram& program, int n, const float* const p[3], float* out, float* scratch,
         int values) {
  // The last instruction writes to the lowest value, copied out in the end.
  const float* points[kMaxPoints + 1][3];
  set_point(points[0], p);
  float* const point_blocks = scratch + static_cast<long>(values) * kBatch;
  int top = 0;    // values on the stack
  int inner = 0;  // points on the stack above the outermost
  for (int i = 0; i < program.size; ++i) {
    const Instruction& at = program.code[i];
    BatchStep step{};
    step.n = n;
    step.constants = program.constants + at.constants;
    step.data = program.constants + at.data;
    step.offset = at.offset;
    step.count = static_cast<int>(at.count);
    set_point(step.p, points[inner]);
    const BatchFamily& family = *kFamilies[at.op / kFamilySize];
    const int place = at.op % kFamilySize;
    if (at.step == Step::leaf) {
      step.out = scratch + static_cast<long>(top++) * kBatch;
      family.apply[place](step);
    } else if (at.step == Step::sample) {
      program.sample(program.samplers[at.sampler], n, step.p,
                     scratch + static_cast<long>(top++) * kBatch);
    } else if (at.step == Step::enter) {
      ++inner;
      for (int a = 0; a < 3; ++a) {
        step.q[a] = point_blocks + (static_cast<long>(inner - 1) * 3 + a) * kBatch;
      }
      family.apply[place](step);
      set_point(points[inner], const_cast<const float* const*>(step.q));
    } else {
      if (at.step == Step::combine) {
        step.b = scratch + static_cast<long>(--top) * kBatch;
      } else if (at.step == Step::leave) {
        set_point(step.p, points[--inner]);
      }
      step.out = scratch + static_cast<long>(top - 1) * kBatch;
      step.a = step.out;
      const BatchFunction function =
          at.step == Step::leave ? family.leave[place] : family.apply[place];
      if (function != nullptr) function(step);
    }
  }
  __builtin_memcpy(out, scratch, static_cast<unsigned long>(n) * sizeof(float));
}

}  // namespace

extern const FieldKernel kFieldKernel = {run};

}  // namespace sdfgrid::SDFGRID_ISA
