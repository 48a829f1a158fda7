// Upwind solutions of the eikonal equation at sixteen samples at a time, wherever they are: three
// gathers along each axis. The samples of a front are known a bucket ahead, so that what the next
// ones will read is fetched while these are solved.
#include "sdfgrid/transform/march_kernel.h"

#include "sdfgrid/core/simd.h"

namespace sdfgrid::SDFGRID_ISA {
namespace {

constexpr float kInfinite = __builtin_inff();
constexpr int kAhead = 3 * kLanes;  // samples between fetching and using

inline I16 as_bits(F16 v) {
  I16 bits;
  __builtin_memcpy(&bits, &v, sizeof bits);
  return bits;
}
inline F16 as_float(I16 bits) {
  F16 v;
  __builtin_memcpy(&v, &bits, sizeof v);
  return v;
}

// The neighbours `by` steps (at most two) along an axis.
struct DensePlaces {
  const MarchStencil& stencil;

  I16 step(I16 sample, int axis, int by) const { return sample + by * stencil.stride[axis]; }
  void fetch(std::int32_t sample) const {
    for (int axis = 0; axis < 2; ++axis) {
      __builtin_prefetch(stencil.values + sample - 2 * stencil.stride[axis]);
      __builtin_prefetch(stencil.values + sample + 2 * stencil.stride[axis]);
    }
  }
};

// As BrickField::step().
struct BrickPlaces {
  const MarchStencil& stencil;

  I16 step(I16 sample, int axis, int by) const {
    const int shift = 6 - 3 * axis;
    const I16 digit = (sample >> shift & 7) + (8 + by);
    const I16 brick = gather(stencil.bricks, (sample >> 9) * 9 + (digit >> 3) + 3 * axis);
    return brick << 9 | (sample & (511 & ~(7 << shift))) | (digit & 7) << shift;
  }
  void fetch(std::int32_t sample) const { __builtin_prefetch(stencil.values + sample); }
};

// What each axis says: weight * (T - value)^2 is its part of |grad T|^2.
struct Terms {
  F16 nearest[3];  // the neighbour's own distance, below which T may not fall; infinite if none
  F16 value[3];
  F16 weight[3];

  void order(int i, int j) {
    const I16 swap = nearest[j] < nearest[i];
    exchange(swap, nearest[i], nearest[j]);
    exchange(swap, value[i], value[j]);
    exchange(swap, weight[i], weight[j]);
  }
  static void exchange(I16 swap, F16& a, F16& b) {
    const F16 low = select(swap, b, a);
    b = select(swap, a, b);
    a = low;
  }
};

// The distances of neighbours that are final and on this side; the others are infinite.
inline F16 known(const MarchStencil& stencil, I16 samples, I16 side) {
  const I16 bits = as_bits(gather(stencil.values, samples));
  const F16 distance = as_float(bits ^ side);
  return select(((bits & 1) == splat(0)) & (distance >= splat(0.0F)), distance, splat(kInfinite));
}

template <class Places>
inline Terms find_terms(const Places& places, I16 sample, I16 side) {
  const MarchStencil& stencil = places.stencil;
  Terms terms;
  for (int axis = 0; axis < 3; ++axis) {
    const F16 below = known(stencil, places.step(sample, axis, -1), side);
    const F16 above = known(stencil, places.step(sample, axis, 1), side);
    const F16 first = min(below, above);
    const I16 some = first < splat(kInfinite);
    F16 value = first;
    F16 weight = splat(stencil.weight[axis]);
    if (stencil.second_order) {
      const I16 behind =
          select(below <= above, places.step(sample, axis, -2), places.step(sample, axis, 2));
      const F16 second = known(stencil, behind, side);
      const I16 smooth = some & (second <= first);
      value = select(smooth, (first * 4.0F - second) * (1.0F / 3), value);
      weight = select(smooth, weight * 2.25F, weight);
    }
    terms.nearest[axis] = first;
    terms.value[axis] = select(some, value, splat(0.0F));
    terms.weight[axis] = select(some, weight, splat(0.0F));
  }
  return terms;
}

// The largest number of terms, nearest first, whose solution is not before any of them.
inline F16 solve(Terms terms) {
  terms.order(0, 1);
  terms.order(1, 2);
  terms.order(0, 1);
  const F16 inf = splat(kInfinite);
  const F16 zero = splat(0.0F);
  const I16 some = terms.nearest[0] < inf;
  // Relative to a value nearby, so that squares of far distances do not eat the digits.
  const F16 origin = select(some, terms.nearest[0], zero);
  F16 a = select(some, terms.weight[0], splat(1.0F));
  F16 v = terms.value[0] - origin;
  F16 b = a * v;
  F16 c = fma(b, v, splat(-1.0F));
  F16 t = v + 1.0F / sqrt(a);
  for (int i = 1; i < 3; ++i) {
    const F16 nearest = terms.nearest[i] - origin;
    const I16 has = terms.nearest[i] < inf;
    v = select(has, terms.value[i] - origin, zero);
    const F16 weight = terms.weight[i];
    a += weight;
    b = fma(weight, v, b);
    c = fma(weight * v, v, c);
    const F16 root = fma(b, b, -(a * c));
    const F16 with = (b + sqrt(max(root, zero))) / a;
    t = select(has & (root >= zero) & (with >= nearest), with, t);
  }
  return select(some, origin + t, inf);
}

template <class Places>
void solve_all(const MarchStencil& stencil, const std::int32_t* samples, const std::int32_t* sides,
               int count, float* distances) {
  const Places places{stencil};
  int i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    if (i + kAhead + kLanes <= count) {
      for (int lane = 0; lane < kLanes; ++lane) places.fetch(samples[i + kAhead + lane]);
    }
    store(distances + i, solve(find_terms(places, load(samples + i), load(sides + i))));
  }
  if (i == count) return;
  I16 sample = splat(samples[i]);
  I16 side = splat(sides[i]);
  for (int lane = 0; i + lane < count; ++lane) {
    sample[lane] = samples[i + lane];
    side[lane] = sides[i + lane];
  }
  const F16 found = solve(find_terms(places, sample, side));
  for (int lane = 0; i + lane < count; ++lane) distances[i + lane] = found[lane];
}

}  // namespace

extern const MarchKernel kMarchKernel;
const MarchKernel kMarchKernel = {solve_all<DensePlaces>, solve_all<BrickPlaces>};

}  // namespace sdfgrid::SDFGRID_ISA
