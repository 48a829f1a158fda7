// field/batch_kernel.h: the batch reading of a program, between ordinary code and the kernels,
// which are compiled once for each instruction set. Plain data only (not installed).
#pragma once

#include "sdfgrid/core/kernel.h"
#include "sdfgrid/field/program.h"

namespace sdfgrid {

struct BatchProgram {
  const Instruction* code;
  int size;
  const float* constants;
  const Sampler* const* samplers;
  void (*sample)(const Sampler* sampler, int n, const float* const p[3], float* out);
};

struct FieldKernel {
  // One block of n points, n a multiple of 16 and at most kBatch; scratch holds scratch_rows() of
  // the program's stacks, 64-byte aligned. p and out may be its own first rows.
  void (*run)(const BatchProgram& program, int n, const float* const p[3], float* out,
              float* scratch);
};

const FieldKernel& field_kernel();

// Field::evaluate by a kernel of one's choice: tests compare them.
class Field;
void evaluate(const FieldKernel& kernel, const Field& field, unsigned long n, const float* x,
              const float* y, const float* z, float* out);

// The families in the order of ops::Families.
SDFGRID_DECLARE_ISAS(extern const FieldKernel kFieldKernel;
                     extern const BatchFamily kCombinations, kBlends, kRanges, kDisplacements,
                     kDomains, kFolds, kWarps, kMoreWarps, kBasicLeaves, kRoundLeaves, kSoftLeaves,
                     kFractalLeaves, kTerrainLeaves, kFormulas)

}  // namespace sdfgrid
