// Sixteen rays of sphere tracing, each at its own place, in lockstep.
#include "sdfgrid/trace/step_kernel.h"

#include "sdfgrid/core/simd.h"
#include "sdfgrid/trace/look_through.h"
#include "sdfgrid/trace/simd_double.h"

namespace sdfgrid::SDFGRID_ISA {
namespace {

constexpr std::int32_t kMostSteps = 1 << 22;  // no ray needs so many
constexpr float kMomentum = 0.3F;             // how much of a step's slope goes into the next one's
constexpr float kFar = 1e30F;                 // as good as without end

inline F16 at_most(F16 a, float b) { return min(a, splat(b)); }
inline F16 at_least(F16 a, float b) { return max(a, splat(b)); }

void look(const PacketCamera& camera, int x, int y, RayLanes& rays) {
  D16 direction[3];
  look_through(camera, x, y, 1, direction);
  for (int a = 0; a < 3; ++a) {
    store16(rays.along[a], direction[a]);
    store16(rays.start[a], splat16(camera.eye[a]));
  }
}

void clip(const RayLanes& rays, const double lo[3], const double hi[3], double* from, double* to) {
  D16 near = splat16(0);
  D16 far = splat16(1e300);
  for (int a = 0; a < 3; ++a) {
    // A direction that is nearly 0 leaves the box far away, or never.
    D16 along = load16(rays.along[a]);
    for (DPart& d : along.part) {
      const DPart least = d < 0 ? splat_part(-1e-200) : splat_part(1e-200);
      d = (d < 0 ? -d : d) < 1e-200 ? least : d;
    }
    const D16 inverted = inverse(along);
    const D16 start = load16(rays.start[a]);
    const D16 t0 = (splat16(lo[a]) - start) * inverted;
    const D16 t1 = (splat16(hi[a]) - start) * inverted;
    near = max(min(t0, t1), near);
    far = min(max(t0, t1), far);
  }
  store16(from, near);
  store16(to, far);
}

inline float largest_root(const D16& squares) {
  DPart larger = squares.part[0];
  for (int i = 1; i < kDoubleParts; ++i) larger = max(larger, squares.part[i]);
  double largest = 0;
  for (int i = 0; i < kPartLanes; ++i) largest = larger[i] > largest ? larger[i] : largest;
  return static_cast<float>(__builtin_sqrt(largest));
}

// Around the line midway between the first and the last ray.
void beam(const RayLanes& rays, RayLanes& axes, RayGroup& beams, int lane) {
  D16 wide = splat16(0);
  D16 wider = splat16(0);
  for (int a = 0; a < 3; ++a) {
    const double start = 0.5 * (rays.start[a][0] + rays.start[a][kLanes - 1]);
    const double along = 0.5 * (rays.along[a][0] + rays.along[a][kLanes - 1]);
    axes.start[a][lane] = start;
    axes.along[a][lane] = along;
    beams.origin[a][lane] = static_cast<float>(start);
    beams.direction[a][lane] = static_cast<float>(along);
    const D16 u = load16(rays.start[a]) - splat16(start);
    const D16 v = load16(rays.along[a]) - splat16(along);
    wide = wide + u * u;
    wider = wider + v * v;
  }
  constexpr float kRounding = 1 + 1e-5F;  // of what is added up when the base moves
  beams.width[lane] = kRounding * largest_root(wide);
  beams.widening[lane] = kRounding * largest_root(wider);
  beams.steps[lane] = 0;
  beams.base = 0;
}

// The least of all `from` and the largest of all `to`.
inline GroupWay span_of(const D16& from, const D16& to) {
  DPart least = from.part[0];
  DPart most = to.part[0];
  for (int h = 1; h < kDoubleParts; ++h) {
    least = min(from.part[h], least);
    most = max(to.part[h], most);
  }
  GroupWay way{least[0], most[0]};
  for (int i = 1; i < kPartLanes; ++i) {
    way.clear = least[i] < way.clear ? least[i] : way.clear;
    way.end = most[i] > way.end ? most[i] : way.end;
  }
  return way;
}

// The same of those lanes where the one is before the other.
inline GroupWay way_of(const D16& from, const D16& to) {
  D16 first;
  D16 last;
  for (int h = 0; h < kDoubleParts; ++h) {
    first.part[h] = from.part[h] < to.part[h] ? from.part[h] : splat_part(1e300);
    last.part[h] = from.part[h] < to.part[h] ? to.part[h] : splat_part(-1e300);
  }
  return span_of(first, last);
}

GroupWay begin(RayGroup& g, const double* from, const double* to, double grain) {
  const D16 starts = load16(from);
  const D16 ends = load16(to);
  const GroupWay way = way_of(starts, ends);
  g.base = way.clear < way.end ? grain * __builtin_floor(way.clear / grain) : 0;
  const D16 base = splat16(g.base);
  for (int a = 0; a < 3; ++a) {
    const D16 along = load16(g.rays->along[a]);
    store(g.origin[a], to_float(load16(g.rays->start[a]) + base * along));
    store(g.direction[a], to_float(along));
  }
  const F16 clear = to_float(starts - base);
  const F16 end = to_float(ends - base);
  const I16 wanted = clear < end;
  const F16 place = select(wanted, clear, splat(0.0F));
  store(g.clear, place);
  store(g.next, place);
  store(g.end, select(wanted, end, splat(RayGroup::kNever)));
  store(g.last, splat(RayGroup::kNever));
  store(g.value, splat(0.0F));
  store(g.slope, splat(-1.0F));
  store(g.hit, splat(RayGroup::kNotHit));
  store(g.width, splat(0.0F));
  store(g.widening, splat(0.0F));
  store(g.steps, splat(0));
  return way;
}

void rebase(RayGroup* groups, const std::uint32_t* list, int n, double base) {
  for (int k = 0; k < n; ++k) {
    RayGroup& g = groups[list[k]];
    if (g.base == base) continue;
    for (int a = 0; a < 3; ++a) {
      const D16 along = load16(g.rays->along[a]);
      store(g.origin[a], to_float(load16(g.rays->start[a]) + splat16(base) * along));
    }
    const auto shift = static_cast<float>(base - g.base);
    g.base = base;
    store(g.clear, load(g.clear) - shift);
    store(g.next, load(g.next) - shift);
    store(g.end, load(g.end) - shift);
    store(g.last, load(g.last) - shift);
    store(g.width, load(g.width) + shift * load(g.widening));
  }
}

// To about four digits, for guesses only.
inline F16 about(F16 a, F16 over) {
#if defined(__AVX512F__)
  return a * (F16)_mm512_rcp14_ps((__m512)over);
#else
  return a / over;
#endif
}

// A group's lanes that go on before the limit.
inline I16 going_on(F16 clear, F16 end, float limit) { return clear < at_most(end, limit); }

inline void write_place(const RayGroup& g, F16 t, float* const p[3], int at) {
  for (int a = 0; a < 3; ++a) {
    store(p[a] + at, fma(t, load(g.direction[a]), load(g.origin[a])));
  }
}

int place(RayGroup* groups, std::uint32_t* list, int n, const float* from, float limit,
          float* const p[3]) {
  int left = 0;
  for (int k = 0; k < n; ++k) {
    RayGroup& g = groups[list[k]];
    const F16 clear = at_least(load(g.clear), from[k]);
    const F16 next = max(load(g.next), clear);
    store(g.clear, clear);
    store(g.next, next);
    if (!any(going_on(clear, load(g.end), limit))) continue;
    write_place(g, next, p, left * kLanes);
    list[left++] = list[k];
  }
  return left;
}

// How far the way ahead is free, and how far the surface is at least as long as the slope stays.
struct Free {
  F16 way, surface;
};

// A convex function lies above the line through two of its values, beyond them: without end if that
// does not fall.
inline Free past_convex(const Free& ahead, F16 t, F16 r, F16 error, F16 last, F16 value) {
  const F16 fall = (value - r + 2.0F * error) / (t - last);
  const I16 falls = fall > 0.0F;
  const F16 secant = (r - error) / select(falls, fall, splat(1.0F));
  const F16 above =
      select(last > 0.5F * RayGroup::kNever, select(falls, secant, splat(kFar)), splat(0.0F));
  return {max(ahead.way, above), max(ahead.surface, above)};
}

// The slope along the ray that steps are relaxed by, after the value r at t.
inline F16 smoothed_slope(const RayGroup& g, F16 t, F16 r, F16 last, F16 value) {
  const I16 known = last > 0.5F * RayGroup::kNever;
  const F16 slope = load(g.slope);
  const F16 now =
      at_most(at_least(about(r - value, select(known, t - last, splat(1.0F))), -1.0F), 0.99F);
  return select(known, slope + kMomentum * (now - slope), slope);
}

// Takes in that the field is `value` at p, where each lane is to be evaluated next. Returns which
// lanes go on.
inline I16 step_group(RayGroup& g, const StepRule& rule, const F16 (&p)[3], F16 value,
                      const FreeWays& ways, int at) {
  const F16 clear = load(g.clear);
  const F16 end = load(g.end);
  const F16 t = load(g.next);
  const I16 active = going_on(clear, end, rule.limit);
  const F16 radius = fma(t, load(g.widening), load(g.width));
  const F16 r = rule.sign * value - radius;
  const F16 far = max(max(abs(p[0]), abs(p[1])), abs(p[2]));
  const F16 error = static_cast<float>(kFieldSlack) * far + kPlaceSlack * t;
  Free ahead = {abs(r), abs(r)};
  F16 back = abs(r);
  if (ways.ahead != nullptr) {
    ahead = {load(ways.ahead + at), load(ways.surface + at)};
    back = load(ways.back + at);
  }
  const F16 last = load(g.last);
  const F16 before = load(g.value);
  if (rule.convex) ahead = past_convex(ahead, t, r, error, last, before);
  ahead.way = max(ahead.way, 0.5F * error);
  // A relaxed step stands if what both of its ends know of the way between meets.
  const I16 taken_back = active & (t > clear) & ~((r >= 0.0F) & (t - back <= clear));
  const I16 taken = active & ~taken_back;
  const F16 least = fma(t, splat(rule.tolerance), splat(rule.near)) + error + rule.share * radius;
  const std::int32_t* const counted = g.steps;
  const I16 steps = load(counted) - active;
  // What is not hit leaves at least half the error free: rays that glide along a surface take many
  // steps, but none is given up as free.
  const I16 hit = taken & ((r < 0.0F) | (ahead.surface <= least) | (steps >= kMostSteps));
  const F16 free = t + ahead.way;
  F16 next = free;
  if (rule.relax && !rule.convex) {
    const F16 slope = smoothed_slope(g, t, r, last, before);
    next = t + about(2.0F * ahead.way, 1.0F - slope);
    store(g.slope, select(taken, slope, select(taken_back, splat(-1.0F), load(g.slope))));
  }
  // Beyond the limit this program does not hold, beyond the end no local bound: only what is
  // certain goes there.
  next = max(free, min(next, at_most(end, rule.limit)));
  store(g.steps, steps);
  const F16 now_clear = select(taken, free, clear);
  const F16 now_end = select(hit, splat(RayGroup::kNever), end);
  store(g.clear, now_clear);
  store(g.end, now_end);
  store(g.next, select(taken, next, select(taken_back, clear, t)));
  store(g.last, select(taken, t, select(taken_back, splat(RayGroup::kNever), last)));
  store(g.value, select(taken, r, before));
  store(g.hit, select(hit, select(r < 0.0F, t, free), load(g.hit)));
  return going_on(now_clear, now_end, rule.limit);
}

int step(RayGroup* groups, std::uint32_t* list, int n, const StepRule& rule, const float* values,
         const FreeWays& ways, float* const p[3]) {
  int left = 0;
  for (int k = 0; k < n; ++k) {
    RayGroup& g = groups[list[k]];
    const int at = k * kLanes;
    const F16 place[3] = {load(p[0] + at), load(p[1] + at), load(p[2] + at)};
    if (!any(step_group(g, rule, place, load(values + at), ways, at))) continue;
    // Positions before this one have been read.
    write_place(g, load(g.next), p, left * kLanes);
    list[left++] = list[k];
  }
  return left;
}

GroupWay collect(RayGroup& g) {
  const F16 hit = load(g.hit);
  const D16 base = splat16(g.base);
  if (any(hit < RayGroup::kNotHit)) {
    const D16 to = to_double(hit);
    D16 depth = load16(g.depth);
    for (int h = 0; h < kDoubleParts; ++h) {
      const DPart found = to.part[h] + base.part[h];
      const DPart nearer = min(found, depth.part[h]);
      depth.part[h] = to.part[h] < RayGroup::kNotHit ? nearer : depth.part[h];
    }
    store16(g.depth, depth);
    store(g.hit, splat(RayGroup::kNotHit));
  }
  return way_of(to_double(load(g.clear)) + base, to_double(load(g.end)) + base);
}

// A box that grows, sixteen corners at a time.
struct Corners {
  D16 lo[3], hi[3];

  Corners() {
    for (int a = 0; a < 3; ++a) lo[a] = splat16(1e300), hi[a] = splat16(-1e300);
  }
  // Around beams at the places t where `live`.
  void add(const RayGroup& around, const D16& t, const D16& live) {
    const D16 radius = to_double(load(around.width)) +
                       to_double(load(around.widening)) * (t - splat16(around.base));
    for (int a = 0; a < 3; ++a) {
      const D16 c = load16(around.rays->start[a]) + t * load16(around.rays->along[a]);
      for (int h = 0; h < kDoubleParts; ++h) {
        const DPart r = radius.part[h];
        const DPart low = live.part[h] > 0 ? c.part[h] - r : splat_part(1e300);
        const DPart high = live.part[h] > 0 ? c.part[h] + r : splat_part(-1e300);
        lo[a].part[h] = min(low, lo[a].part[h]);
        hi[a].part[h] = max(high, hi[a].part[h]);
      }
    }
  }
  void write(double (&low)[3], double (&high)[3]) const {
    for (int a = 0; a < 3; ++a) {
      // Rays that begin in one place have no width there.
      const GroupWay all = span_of(lo[a], hi[a]);
      low[a] = all.clear;
      high[a] = all.end;
    }
  }
};

alignas(64) constexpr double kCounting[kLanes] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                  8, 9, 10, 11, 12, 13, 14, 15};

GroupRoom room(const RayGroup* beams, const double* clear, const double* end, int first, int last,
               double t0, double t1) {
  GroupRoom r{};
  Corners all;
  Corners far;
  for (int group = first / kLanes * kLanes; group < last; group += kLanes) {
    const D16 from = max(load16(clear + group), splat16(t0));
    const D16 to = min(load16(end + group), splat16(t1));
    const D16 number = load16(kCounting) + splat16(group);
    D16 live;
    DPart count = splat_part(0);
    for (int h = 0; h < kDoubleParts; ++h) {
      const DPart within =
          number.part[h] >= first && number.part[h] < last ? splat_part(1) : splat_part(0);
      live.part[h] = from.part[h] < to.part[h] ? within : splat_part(0);
      count += live.part[h];
    }
    double sum = 0;
    for (int i = 0; i < kPartLanes; ++i) sum += count[i];
    if (sum == 0) continue;
    r.groups += static_cast<int>(sum);
    all.add(beams[group / kLanes], from, live);
    far.add(beams[group / kLanes], to, live);
  }
  if (r.groups == 0) return r;
  far.write(r.far_lo, r.far_hi);
  all.write(r.lo, r.hi);
  for (int a = 0; a < 3; ++a) {
    r.lo[a] = r.far_lo[a] < r.lo[a] ? r.far_lo[a] : r.lo[a];
    r.hi[a] = r.far_hi[a] > r.hi[a] ? r.far_hi[a] : r.hi[a];
  }
  return r;
}

void write(const double* depth, const std::uint32_t* steps, float* depths, std::uint16_t* counts,
           long width) {
  float near[kLanes];
  std::uint16_t counted[kLanes];
  store(near, to_float(load16(depth)));
  for (int i = 0; i < kLanes; ++i) {
    counted[i] = static_cast<std::uint16_t>(steps[i] < 0xffffU ? steps[i] : 0xffffU);
  }
  for (int row = 0; row < 4; ++row) {
    __builtin_memcpy(depths + row * width, near + 4 * row, 4 * sizeof *depths);
    __builtin_memcpy(counts + row * width, counted + 4 * row, 4 * sizeof *counts);
  }
}

}  // namespace

extern const StepKernel kStepKernel;
const StepKernel kStepKernel = {look, clip, beam, begin, rebase, place, step, collect, room, write};

}  // namespace sdfgrid::SDFGRID_ISA
