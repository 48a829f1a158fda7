// transform/site_kernel.h: the vector arithmetic of nearest sites in bricks, compiled once for each
// instruction set. Plain data only (not installed).
//
// A key holds a squared distance and, below it, the offsets to the site it belongs to, so that one
// minimum finds both: square << 18 | (x + 32) << 12 | (y + 32) << 6 | (z + 32).
#pragma once

#include <cstdint>

#include "sdfgrid/core/kernel.h"

namespace sdfgrid {

inline constexpr int kLargestReach = 24;          // samples, of an offset
inline constexpr std::int32_t kNoSite = 1 << 30;  // and keys above have none either
inline constexpr std::int32_t kNoOffset = 32 << 12 | 32 << 6 | 32;

struct SiteKernel {
  // out[i] = least over d in [0, 2 * reach] of strip[i + width * d] + add[d], for the 8 * width
  // numbers of a slice of `width` samples, at most kNoSite. `width` is a multiple of 8.
  void (*nearest)(const std::int32_t* strip, int width, int reach, const std::int32_t* add,
                  std::int32_t* out);
};

// The kernel for this machine.
const SiteKernel& site_kernel();

SDFGRID_DECLARE_ISAS(extern const SiteKernel kSiteKernel)

}  // namespace sdfgrid
