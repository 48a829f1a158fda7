// Sixteen rays through an atlas in lockstep: those between cells that may hold a zero jump on until
// all have arrived at one or are done, then all arrived ones solve their cells' cubics at once.
//
// Each ray is mirrored so that it runs towards growing coordinates on all axes: of the planes of a
// box it leaves by an upper one. A mirrored cell c is the cell ~c of the lattice.
#include "sdfgrid/trace/packet_kernel.h"

#include "sdfgrid/core/simd.h"
#include "sdfgrid/trace/simd_double.h"

namespace sdfgrid::SDFGRID_ISA {
namespace {

constexpr float kSegment = 256;
// A root where the field changes by less than this many tolerances a cell is left to double.
constexpr float kSteep = 64;
constexpr int kBrick = 8;
constexpr int kEdge = 9;
constexpr int kSamples = kEdge * kEdge * kEdge;

inline I16 lanes(std::uint32_t mask) {
  I16 r;
  for (int i = 0; i < kLanes; ++i) r[i] = -static_cast<std::int32_t>((mask >> i) & 1U);
  return r;
}

// Whole words, so that nothing is read beyond the table, whose size is a multiple of four.
inline I16 gather_byte(const std::uint8_t* p, I16 index) {
#if defined(__AVX512F__)
  const I16 word = (I16)_mm512_i32gather_epi32((__m512i)(index >> 2), p, 4);
  return (word >> ((index & 3) << 3)) & 0xff;
#else
  I16 r;
  for (int i = 0; i < kLanes; ++i) r[i] = p[index[i]];
  return r;
#endif
}

struct Rays {
  F16 origin[3];     // relative to the base cell, mirrored
  F16 direction[3];  // > 0
  F16 inverse[3];
  I16 base[3];   // the base cell, mirrored: what to add to relative ones
  I16 flip[3];   // 0 or -1: mirrored
  I16 octant;    // as in Atlas
  I16 limit[3];  // first mirrored cell beyond the tables, relative to base
};

struct State {
  I16 cell[3];  // mirrored, relative to base
  F16 t;        // since the base
  I16 walking;  // between crossing cells
  I16 arrived;  // at a crossing cell
  I16 steps;
  I16 brick;  // of arrived lanes
};

// Moves the starts of rays to where they enter the tables; returns which do.
inline I16 clip(const PacketScene& scene, const PacketRays& in, D16& from) {
  D16 to = splat16(1e300);
  for (int a = 0; a < 3; ++a) {
    const D16 origin = load16(in.origin[a]);
    D16 direction = load16(in.direction[a]);
    for (D8& d : direction.half) d = d == 0.0 ? splat8(1e-200) : d;
    const D16 zero = splat16(0) - origin / direction;
    const D16 end = (splat16(scene.dims[a] * kBrick) - origin) / direction;
    from = max(min(zero, end), from);
    to = min(max(zero, end), to);
  }
  return to_float(to - from) > 0.0F;
}

// Splits the rays' places at `from` into a cell and the rest, in double, and starts there.
inline void rebase(const PacketScene& scene, const PacketRays& in, const D16& from, Rays& rays,
                   State& state) {
  rays.octant = splat(0);
  for (int a = 0; a < 3; ++a) {
    const std::int32_t cells = scene.dims[a] * kBrick;
    const D16 direction = load16(in.direction[a]);
    const D16 place = load16(in.origin[a]) + from * direction;
    const I16 base = to_int(min(max(place, splat16(0)), splat16(cells - 1)));
    const F16 rest = to_float(place - to_double(base));
    const F16 d = to_float(direction);
    rays.flip[a] = d < 0.0F;
    rays.origin[a] = select(rays.flip[a], -rest, rest);
    // Flatter than this a ray stays in its cell; 0 would make the plane at hand 0 / 0 away.
    rays.direction[a] = max(abs(d), splat(1e-30F));
    rays.inverse[a] = 1.0F / rays.direction[a];
    rays.base[a] = select(rays.flip[a], -base, base);
    rays.limit[a] = select(rays.flip[a], base, cells - base);
    rays.octant = 2 * rays.octant - rays.flip[a];
    state.cell[a] = rays.flip[a];
  }
  state.t = splat(0.0F);
}

// One jump of the walking lanes, or their arrival.
inline void walk(const PacketScene& scene, const Rays& rays, State& state) {
  I16 slot[3];   // of the lattice
  I16 along[3];  // within the brick, mirrored
  for (int a = 0; a < 3; ++a) {
    const I16 cell = state.cell[a] + rays.base[a];
    slot[a] = (cell ^ rays.flip[a]) >> 3;
    along[a] = cell & 7;
  }
  const std::int32_t plane_slots = scene.dims[1] * scene.dims[2];
  const I16 place = state.walking & (slot[0] * plane_slots + slot[1] * scene.dims[2] + slot[2]);
  const I16 jump = gather_byte(scene.jumps, place + rays.octant * (scene.dims[0] * plane_slots));
  const I16 in_brick = state.walking & (jump == 0);
  const I16 brick = in_brick & gather(scene.bricks, place);
  const I16 word = gather(reinterpret_cast<const std::int32_t*>(scene.hops),
                          (((brick << 3) + rays.octant) << 6) + (along[0] << 3) + along[1]);
  const I16 hop = (word >> (along[2] << 2)) & 15;
  const I16 arriving = in_brick & (hop == 0);
  state.steps -= state.walking;
  state.arrived |= arriving;
  state.brick = select(arriving, brick, state.brick);
  const I16 moving = state.walking & ~arriving;
  I16 plane[3];
  F16 times[3];
  for (int a = 0; a < 3; ++a) {
    const I16 left = 8 - along[a];
    const I16 far = select(in_brick, select(hop < left, hop, left), (jump << 3) - along[a]);
    plane[a] = state.cell[a] + far;
    times[a] = (to_float(plane[a]) - rays.origin[a]) * rays.inverse[a];
  }
  const F16 exit = min(min(times[0], times[1]), times[2]);
  I16 beyond = exit > kSegment;
  for (int a = 0; a < 3; ++a) {
    // Never back, and across the plane of exit whatever the rounding says.
    const I16 reached = to_int(floor(rays.origin[a] + exit * rays.direction[a]));
    I16 next = select(reached > state.cell[a], reached, state.cell[a]);
    next = select(next < plane[a], next, plane[a] - 1);
    next = select(times[a] <= exit, plane[a], next);
    state.cell[a] = select(moving, next, state.cell[a]);
    beyond |= state.cell[a] >= rays.limit[a];
  }
  state.t = select(moving, exit, state.t);
  state.walking = moving & ~beyond;
}

struct Cubic {
  F16 c0, c1, c2, c3;
  F16 operator()(F16 s) const { return ((c3 * s + c2) * s + c1) * s + c0; }
  F16 derivative(F16 s) const { return (3.0F * c3 * s + 2.0F * c2) * s + c1; }
};

// The cubic of the cell that each lane is in, as in cubic.cpp, all in mirrored coordinates.
inline Cubic cell_cubic(const PacketScene& scene, const Rays& rays, const State& state) {
  static constexpr int kStride[3] = {kEdge * kEdge, kEdge, 1};
  I16 index = state.brick * kSamples;
  I16 step[3];
  F16 from[3];
  for (int a = 0; a < 3; ++a) {
    const I16 at = ((state.cell[a] + rays.base[a]) ^ rays.flip[a]) & 7;
    index += (at - rays.flip[a]) * kStride[a];
    step[a] = (rays.flip[a] ^ kStride[a]) - rays.flip[a];
    from[a] = (rays.origin[a] - to_float(state.cell[a])) + state.t * rays.direction[a];
  }
  index &= state.arrived;
  F16 e0[4];
  F16 e1[4];
  for (int i = 0; i < 4; ++i) {
    const I16 corner =
        index + (state.arrived & ((i & 2 ? step[0] : splat(0)) + (i & 1 ? step[1] : splat(0))));
    const F16 v0 = gather(scene.samples, corner);
    const F16 v1 = gather(scene.samples, corner + (state.arrived & step[2]));
    e0[i] = v0 + from[2] * (v1 - v0);
    e1[i] = rays.direction[2] * (v1 - v0);
  }
  F16 q0[2];
  F16 q1[2];
  F16 q2[2];
  for (int i = 0; i < 2; ++i) {
    const F16 d0 = e0[2 * i + 1] - e0[2 * i];
    const F16 d1 = e1[2 * i + 1] - e1[2 * i];
    q0[i] = e0[2 * i] + from[1] * d0;
    q1[i] = e1[2 * i] + from[1] * d1 + rays.direction[1] * d0;
    q2[i] = rays.direction[1] * d1;
  }
  const F16 d0 = q0[1] - q0[0];
  const F16 d1 = q1[1] - q1[0];
  const F16 d2 = q2[1] - q2[0];
  return {q0[0] + from[0] * d0, q1[0] + from[0] * d1 + rays.direction[0] * d0,
          q2[0] + from[0] * d2 + rays.direction[0] * d1, rays.direction[0] * d2};
}

// Where a positive cubic first becomes clearly negative in [0, length]: a bracket in which it is
// monotone.
struct Bracket {
  I16 found;
  I16 unsure;
  F16 lo, hi, at_lo, at_hi;
};

inline Bracket first_bracket(const Cubic& cubic, F16 length, float tolerance) {
  // The derivative's zeros within (0, length), in order, or `length` in their place.
  const F16 a = 3.0F * cubic.c3;
  const F16 discriminant = cubic.c2 * cubic.c2 - a * cubic.c1;
  const F16 root = sqrt(max(discriminant, splat(0.0F)));
  const F16 q = -(cubic.c2 + select(cubic.c2 < 0.0F, -root, root));
  const F16 r1 = q / a;
  const F16 r2 = cubic.c1 / q;
  const F16 s1 = select((r1 > 0.0F) & (r1 < length), r1, length);
  const F16 s2 = select((r2 > 0.0F) & (r2 < length), r2, length);
  const F16 first = min(s1, s2);
  const F16 second = max(s1, s2);
  const F16 f0 = cubic.c0;
  const F16 f1 = cubic(first);
  const F16 f2 = cubic(second);
  const F16 f3 = cubic(length);
  const I16 negative0 = f0 < -tolerance;
  const I16 negative1 = f1 < -tolerance;
  const I16 negative2 = f2 < -tolerance;
  const I16 negative3 = f3 < -tolerance;
  const I16 later2 = ~negative1;
  const I16 later3 = later2 & ~negative2;
  Bracket b;
  b.found = negative1 | negative2 | negative3;
  // Written so that a NaN is unsure.
  b.unsure = negative0 | (~(f0 > tolerance) & ~negative1) |
             (~(f1 > tolerance) & (first < length) & later2 & ~negative2) |
             (~(f2 > tolerance) & (second < length) & later3 & ~negative3);
  b.lo = select(negative1, splat(0.0F), select(negative2, first, second));
  b.at_lo = select(negative1, f0, select(negative2, f1, f2));
  b.hi = select(negative1, first, select(negative2, second, length));
  b.at_hi = select(negative1, f1, select(negative2, f2, f3));
  return b;
}

// The root in the brackets of `wanted` lanes: Newton's method from the chord's, kept in the
// bracket.
inline F16 refine(const Cubic& cubic, Bracket& b, I16 wanted, float steep) {
  constexpr int kRounds = 24;
  const F16 close = 1e-6F * (b.hi - b.lo) + 1e-6F;
  F16 s = b.lo + (b.hi - b.lo) * (b.at_lo / (b.at_lo - b.at_hi));
  s = min(max(s, b.lo), b.hi);
  I16 open = wanted;
  for (int round = 0; round < kRounds; ++round) {
    const F16 value = cubic(s);
    b.lo = select(value >= 0.0F, s, b.lo);
    b.hi = select(value >= 0.0F, b.hi, s);
    const F16 newton = s - value / cubic.derivative(s);
    const I16 good = (newton >= b.lo) & (newton <= b.hi);
    const F16 next = select(good, newton, 0.5F * (b.lo + b.hi));
    const I16 done = abs(next - s) <= close;
    s = select(open, next, s);
    open &= ~done;
    if (!any(open)) break;
  }
  // A grazing root moves far with a small error.
  b.unsure |= open | (abs(cubic.derivative(s)) < steep);
  return s;
}

// Solves the cells of the arrived lanes; those without a hit walk on.
inline void solve(const PacketScene& scene, const Rays& rays, I16 inside, const D16& from,
                  State& state, I16& unsure, PacketHits& hits) {
  I16 plane[3];
  F16 times[3];
  for (int a = 0; a < 3; ++a) {
    plane[a] = state.cell[a] + 1;
    times[a] = (to_float(plane[a]) - rays.origin[a]) * rays.inverse[a];
  }
  const F16 exit = max(min(min(times[0], times[1]), times[2]), state.t);
  Cubic cubic = cell_cubic(scene, rays, state);
  cubic.c0 = select(inside, -cubic.c0, cubic.c0);
  cubic.c1 = select(inside, -cubic.c1, cubic.c1);
  cubic.c2 = select(inside, -cubic.c2, cubic.c2);
  cubic.c3 = select(inside, -cubic.c3, cubic.c3);
  Bracket bracket = first_bracket(cubic, exit - state.t, scene.tolerance);
  I16 found = state.arrived & bracket.found & ~bracket.unsure;
  if (any(found)) {
    const F16 s = refine(cubic, bracket, found, kSteep * scene.tolerance);
    found &= ~bracket.unsure;
    const std::uint32_t bits_found = bits(found);
    double t[kLanes];
    store16(t, from + to_double(state.t + s));
    for (int i = 0; i < kLanes; ++i) {
      if ((bits_found >> i) & 1U) hits.t[i] = t[i];
    }
    hits.hit |= bits_found;
  }
  unsure |= state.arrived & bracket.unsure;
  const I16 passing = state.arrived & ~bracket.found & ~bracket.unsure;
  I16 beyond = exit > kSegment;
  for (int a = 0; a < 3; ++a) {
    const I16 next = select(times[a] <= exit, plane[a], state.cell[a]);
    state.cell[a] = select(passing, next, state.cell[a]);
    beyond |= state.cell[a] >= rays.limit[a];
  }
  state.t = select(passing, exit, state.t);
  state.walking = passing & ~beyond;
  state.arrived = splat(0);
}

void trace(const PacketScene& scene, const PacketRays& in, PacketHits& hits) {
  Rays rays;
  State state;
  const I16 inside = lanes(in.inside);
  I16 unsure = splat(0);
  D16 from = load16(in.from);
  I16 active = lanes(in.active) & clip(scene, in, from);
  hits.hit = 0;
  state.steps = splat(0);
  state.arrived = splat(0);
  state.brick = splat(0);
  while (any(active)) {
    rebase(scene, in, from, rays, state);
    state.walking = active;
    active = splat(0);
    while (any(state.walking)) {
      do {
        walk(scene, rays, state);
      } while (any(state.walking));
      if (any(state.arrived)) solve(scene, rays, inside, from, state, unsure, hits);
    }
    // Lanes still within the tables that neither hit nor are unsure ended their segment.
    active = state.t > kSegment;
    for (int a = 0; a < 3; ++a) active &= state.cell[a] < rays.limit[a];
    from = from + to_double(select(active, state.t, splat(0.0F)));
  }
  hits.unsure = bits(unsure);
  store(hits.steps, state.steps);
}

void make_rays(const PacketCamera& camera, int x, int y, double from, PacketRays& rays) {
  double column[kLanes];
  double row[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    column[i] = x + i % 4 + 0.5;
    row[i] = y + i / 4 + 0.5;
  }
  D16 direction[3];
  D16 square = splat16(0);
  for (int a = 0; a < 3; ++a) {
    direction[a] = splat16(camera.corner[a]) + splat16(camera.right[a]) * load16(column) +
                   splat16(camera.down[a]) * load16(row);
    square = square + direction[a] * direction[a];
  }
  const D16 scale = splat16(1) / sqrt(square);
  for (int a = 0; a < 3; ++a) {
    store16(rays.direction[a], direction[a] * scale);
    store16(rays.origin[a], splat16(camera.eye[a]));
  }
  store16(rays.from, splat16(from));
}

}  // namespace

extern const PacketKernel kPacketKernel;
const PacketKernel kPacketKernel = {make_rays, trace};

}  // namespace sdfgrid::SDFGRID_ISA
