// Sixteen beams against one box; see box_kernel.h.
#include "sdfgrid/trace/box_kernel.h"

#include "sdfgrid/trace/simd_double.h"

namespace sdfgrid::SDFGRID_ISA {
namespace {

// Bit i where lane i of a is no more than that of b.
std::uint32_t at_most(const D16& a, const D16& b) {
  std::uint32_t bits = 0;
  for (int i = 0; i < kDoubleParts; ++i) {
#if defined(__AVX512F__)
    const auto part = _mm512_cmp_pd_mask((__m512d)a.part[i], (__m512d)b.part[i], _CMP_LE_OQ);
#elif defined(__AVX2__)
    const auto part =
        _mm256_movemask_pd(_mm256_cmp_pd((__m256d)a.part[i], (__m256d)b.part[i], _CMP_LE_OQ));
#else
    unsigned part = 0;
    for (int k = 0; k < kPartLanes; ++k) part |= (a.part[i][k] <= b.part[i][k] ? 1U : 0U) << k;
#endif
    bits |= static_cast<std::uint32_t>(part) << (i * kPartLanes);
  }
  return bits;
}

BeamsMet meet(const BeamLanes& beams, const double lo[3], const double hi[3], double farthest,
              std::uint32_t asked) {
  const D16 width = load16(beams.width);
  const D16 radius = width + load16(beams.widening) * (width + splat16(farthest));
  D16 near = splat16(0);
  D16 far = load16(beams.deepest);
  for (int a = 0; a < 3; ++a) {
    const D16 origin = load16(beams.origin[a]);
    const D16 inverse = load16(beams.inverse[a]);
    const D16 t0 = (splat16(lo[a]) - radius - origin) * inverse;
    const D16 t1 = (splat16(hi[a]) + radius - origin) * inverse;
    near = max(min(t0, t1), near);
    far = min(max(t0, t1), far);
  }
  BeamsMet met{at_most(near, far) & asked, 1e300};
  double from[BeamLanes::kLanes];
  store16(from, near);
  for (std::uint32_t left = met.beams; left != 0; left &= left - 1) {
    const double t = from[__builtin_ctz(left)];
    met.nearest = t < met.nearest ? t : met.nearest;
  }
  return met;
}

}  // namespace

extern const MeetBox kMeetBox = meet;

}  // namespace sdfgrid::SDFGRID_ISA
