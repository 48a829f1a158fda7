#include "field/roots_kernel.h"

#include "sdfgrid/field/lanes.h"

namespace SDFGRID_ISA {
namespace {

using namespace sdfgrid::SDFGRID_ISA;

void inner_root_over(int n, const float* a, float* out) {
  for (int i = 0; i < n; i += kLanes) store(out + i, inner_root(Lanes(load(a + i))).v);
}

}  // namespace

extern const RootsKernel kRootsKernel = {inner_root_over};

}  // namespace SDFGRID_ISA
