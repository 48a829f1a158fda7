#include "sdfgrid/transform/site_kernel.h"

#include "sdfgrid/core/simd.h"

namespace sdfgrid::SDFGRID_ISA {
namespace {

void nearest(const std::int32_t* strip, int width, int reach, const std::int32_t* add,
             std::int32_t* out) {
  for (int i = 0; i < 8 * width; i += 4 * kLanes) {
    I16 best[4] = {splat(kNoSite), splat(kNoSite), splat(kNoSite), splat(kNoSite)};
    for (int d = 0; d <= 2 * reach; ++d) {
      const I16 more = splat(add[d]);
      const std::int32_t* from = strip + i + width * d;
      for (int v = 0; v < 4; ++v) best[v] = min(best[v], load(from + v * kLanes) + more);
    }
    for (int v = 0; v < 4; ++v) store(out + i + v * kLanes, best[v]);
  }
}

}  // namespace

extern const SiteKernel kSiteKernel;
const SiteKernel kSiteKernel = {nearest};

}  // namespace sdfgrid::SDFGRID_ISA
