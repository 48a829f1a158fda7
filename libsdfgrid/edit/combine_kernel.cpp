// The arithmetic of combine_kernel.h, sixteen samples at a time. Compiled once for each instruction
// set: include nothing here that emits functions shared with other files.
#include "sdfgrid/edit/combine_kernel.h"

#include "sdfgrid/core/simd.h"

namespace sdfgrid::SDFGRID_ISA {
namespace {

constexpr int kGroups = 32;  // of sixteen samples: two rows of constant x and y

// Lane l of a group is its sample (0, l >> 3, l & 7).
alignas(64) constexpr float kLaneY[kLanes] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1};
alignas(64) constexpr float kLaneZ[kLanes] = {0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7};

constexpr float kThin = 1.7320508F;  // voxels: the diagonal of a cell

constexpr float group_x(int g) { return static_cast<float>(g >> 2); }
constexpr float group_y(int g) { return static_cast<float>(2 * (g & 3)); }

F16 ball(const RoundSegment& s, F16 x, F16 y, F16 z) {
  return sqrt(x * x + y * y + z * z) - s.radius;
}

F16 swept(const RoundSegment& s, F16 x, F16 y, F16 z) {
  F16 t = (x * s.axis[0] + y * s.axis[1] + z * s.axis[2]) * s.over_length2;
  if (s.across != 0) {
    const F16 rx = x - t * s.axis[0];
    const F16 ry = y - t * s.axis[1];
    const F16 rz = z - t * s.axis[2];
    t = t - sqrt(rx * rx + ry * ry + rz * rz) * s.across;
  }
  t = min(max(t, splat(0.0F)), splat(1.0F));
  const F16 dx = x - t * s.axis[0];
  const F16 dy = y - t * s.axis[1];
  const F16 dz = z - t * s.axis[2];
  return sqrt(dx * dx + dy * dy + dz * dz) - (s.radius + t * s.growth);
}

void sweep(const RoundSegment* segments, std::int32_t count, float* distances) {
  for (std::int32_t i = 0; i < count; ++i) {
    const RoundSegment& s = segments[i];
    const F16 z = load(kLaneZ) - s.a[2];
    for (int g = 0; g < kGroups; ++g) {
      const F16 x = splat(group_x(g) - s.a[0]);
      const F16 y = load(kLaneY) + (group_y(g) - s.a[1]);
      const F16 d = s.over_length2 == 0 ? ball(s, x, y, z) : swept(s, x, y, z);
      float* out = distances + g * kLanes;
      store(out, i == 0 ? d : min(load(out), d));
    }
  }
}

struct Combined {
  F16 value;
  I16 suspect;
};

// a: the grid's, b: the brush's distance, as the smaller (or larger) of the two is taken.
// Where the lesser is taken and is inside, its nearest surface point counts unless the other covers
// it, which it cannot from further away than that. A gap of less than `thin` between the two may
// have no sample in it, and be lost. The same with signs turned.
template <bool larger>
Combined choose(F16 a, F16 b, float smooth, float thin) {
  Combined r;
  r.value = larger ? max(a, b) : min(a, b);
  r.suspect = larger ? (a + b > -thin) & (r.value > 0.0F) : (a + b < thin) & (r.value < 0.0F);
  if (smooth > 0) {
    const F16 h = max(smooth - abs(a - b), splat(0.0F)) / smooth;
    const F16 blend = h * h * (0.25F * smooth);
    r.value = larger ? r.value + blend : r.value - blend;
  }
  return r;
}

std::uint64_t bits_of(int group, I16 mask) {
  return static_cast<std::uint64_t>(bits(mask)) << (16 * (group & 3));
}

template <CombineOp op>
void combine_as(const CombineInput& in, CombineOutput& out) {
  constexpr bool larger = op != CombineOp::unite;
  const F16 inside = splat(in.inside);
  const F16 outside = splat(in.outside);
  std::uint64_t any_active = 0;
  std::uint64_t any_changed = 0;
  I16 any_positive = splat(0);
  I16 any_negative = splat(0);
  for (int word = 0; word < 8; ++word) {
    std::uint64_t active_bits = 0;
    std::uint64_t suspect_bits = 0;
    std::uint64_t changed_bits = 0;
    for (int g = 4 * word; g < 4 * word + 4; ++g) {
      const F16 before = in.before != nullptr ? load(in.before + g * kLanes) : splat(in.constant);
      const F16 a = in.extended != nullptr ? load(in.extended + g * kLanes) : before;
      F16 b = load(in.brush + g * kLanes) * in.voxel;
      const I16 in_brush = b < 0.0F;
      if (op == CombineOp::subtract) b = -b;
      const Combined c = choose<larger>(a, b, in.smooth, kThin * in.voxel);
      const F16 after = max(min(c.value, outside), inside);
      I16 suspect = c.suspect;
      if (in.bound_inside) suspect = suspect | in_brush;
      store(out.after + g * kLanes, after);
      active_bits |= bits_of(g, (after > inside) & (after < outside));
      suspect_bits |= bits_of(g, suspect);
      changed_bits |= bits_of(g, after != before);
      any_positive = any_positive | (after >= outside);
      any_negative = any_negative | (after <= inside);
    }
    out.active[word] = active_bits;
    out.suspect[word] = suspect_bits & active_bits;
    out.changed[word] = changed_bits;
    any_active |= active_bits;
    any_changed |= changed_bits;
  }
  out.any_changed = any_changed != 0;
  out.all_inside = any_active == 0 && !any(any_positive);
  out.all_outside = any_active == 0 && !any(any_negative);
}

void combine(const CombineInput& in, CombineOutput& out) {
  switch (in.op) {
    case CombineOp::unite:
      return combine_as<CombineOp::unite>(in, out);
    case CombineOp::subtract:
      return combine_as<CombineOp::subtract>(in, out);
    case CombineOp::intersect:
      return combine_as<CombineOp::intersect>(in, out);
  }
}

}  // namespace

extern const CombineKernel kCombineKernel;
const CombineKernel kCombineKernel = {sweep, combine};

}  // namespace sdfgrid::SDFGRID_ISA
