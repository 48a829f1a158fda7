// Sixteen rays through an atlas in lockstep. Lanes walk from cell to cell until they arrive at one
// that may hold a zero, wait there until enough have arrived for it to be worth solving their
// cubics, and are given the next ray of the queue when they are done.
#include "sdfgrid/trace/packet_kernel.h"

#include "sdfgrid/core/simd.h"
#include "sdfgrid/trace/look_through.h"
#include "sdfgrid/trace/packet_beam.h"
#include "sdfgrid/trace/packet_cell.h"
#include "sdfgrid/trace/packet_rays.h"
#include "sdfgrid/trace/packet_tables.h"
#include "sdfgrid/trace/simd_double.h"

namespace sdfgrid::SDFGRID_ISA {
namespace {

constexpr float kSegment = 256;
// A root where the field changes by less than this many tolerances a cell is left to double.
constexpr float kSteep = 64;
constexpr int kEdge = 9;  // samples a side of a brick
constexpr int kSamples = kEdge * kEdge * kEdge;
// As many lanes must be free for new rays to be fetched, and arrived for cells to be solved, unless
// there is nothing else to do.
constexpr int kFetch = 4;
constexpr int kSolve = 9;

// p[index] and p[index + 1], or the other way round where `backwards`.
inline void gather_pair(const float* p, I16 index, I16 backwards, F16 (&pair)[2]) {
#if defined(__AVX512F__)
  const __m512i low = _mm512_i32gather_epi64(_mm512_castsi512_si256((__m512i)index), p, 4);
  const __m512i high = _mm512_i32gather_epi64(_mm512_extracti64x4_epi64((__m512i)index, 1), p, 4);
  const __m512i even = _mm512_set_epi32(30, 28, 26, 24, 22, 20, 18, 16, 14, 12, 10, 8, 6, 4, 2, 0);
  const __m512i which = _mm512_sub_epi32(even, (__m512i)backwards);
  pair[0] = (F16)_mm512_permutex2var_epi32(low, which, high);
  pair[1] =
      (F16)_mm512_permutex2var_epi32(low, _mm512_xor_epi32(which, _mm512_set1_epi32(1)), high);
#else
  const F16 a = gather(p, index);
  const F16 b = gather(p, index + 1);
  pair[0] = select(backwards, b, a);
  pair[1] = select(backwards, a, b);
#endif
}

class Tracer {
 public:
  Tracer(const PacketScene& scene, PacketHits& hits) : scene_(scene), hits_(hits) {}

  // Traces all rays of the queue to their outcome, or the end of their segment.
  void run(RayQueue& queue) {
    for (;;) {
      const std::uint32_t free = ~bits(walking_ | arrived_) & 0xffffU;
      const int waiting = __builtin_popcount(bits(arrived_));
      const bool idle = !any(walking_);
      if (!queue.empty() && (__builtin_popcount(free) >= kFetch || (idle && waiting == 0))) {
        fetch(queue, free);
      } else if (waiting >= kSolve || (idle && waiting > 0)) {
        solve();
      } else if (!idle) {
        walk();
      } else {
        break;
      }
    }
    write(bits(taken_));
    taken_ = splat(0);
  }

 private:
  void fetch(RayQueue& queue, std::uint32_t free) {
    write(free & bits(taken_));
    const I16 fresh = lanes(queue.pop(rays_, free));
    taken_ = (taken_ & ~lanes(free)) | fresh;
    walking_ |= fresh;
    t_ = select(fresh, splat(0.0F), t_);
    steps_ = select(fresh, splat(0), steps_);
    outcome_ = select(fresh, splat(kMissed), outcome_);
    for (I16& cell : cell_) cell = select(fresh, splat(0), cell);
  }

  static I16 lanes(std::uint32_t mask) {
    I16 r;
    for (int i = 0; i < kLanes; ++i) r[i] = static_cast<std::int32_t>(1U << i);
    return (r & static_cast<std::int32_t>(mask)) != 0;
  }

  void write(std::uint32_t which) {
    for (; which != 0; which &= which - 1) {
      const int lane = __builtin_ctz(which);
      const std::int32_t ray = rays_.number[lane];
      hits_.outcome[ray] = outcome_[lane];
      hits_.steps[ray] += steps_[lane];
      hits_.t[ray] = t_[lane];
    }
  }

  // One jump of the walking lanes, or their arrival.
  void walk() {
    const Ahead ahead = look_ahead(scene_, rays_, cell_, walking_);
    steps_ -= walking_;
    arrived_ |= ahead.blocked;
    brick_ = select(ahead.blocked, ahead.brick, brick_);
    walking_ &= ~ahead.blocked;
    leave(ahead.past, walking_);
  }

  // Moves lanes that walk on to where they first pass one of three planes.
  void leave(const I16 (&past)[3], I16 moving) {
    F16 times[3];
    for (int a = 0; a < 3; ++a) {
      times[a] = to_float(past[a]) * rays_.inverse[a] + rays_.offset[a];
    }
    const F16 exit = min(min(times[0], times[1]), times[2]);
    I16 beyond = splat(0);
    for (int a = 0; a < 3; ++a) {
      // Never back, and across the plane of exit whatever the rounding says.
      I16 next = to_int(rays_.origin[a] + exit * rays_.direction[a]);
      next = min(max(next, cell_[a]), past[a] - 1);
      next = select(times[a] <= exit, past[a], next);
      cell_[a] = select(moving, next, cell_[a]);
      beyond |= cell_[a] >= rays_.limit[a];
    }
    t_ = select(moving, exit, t_);
    const I16 far = t_ > kSegment;
    outcome_ = select(moving & far & ~beyond, splat(kGoingOn), outcome_);
    walking_ &= ~(moving & (far | beyond));
  }

  // The cubic of the cell that each arrived lane is in, in mirrored coordinates.
  Cubic load_cubic() const {
    static constexpr int kStride[3] = {kEdge * kEdge, kEdge, 1};
    I16 first = brick_ * kSamples;
    I16 step[3];
    F16 from[3];
    for (int a = 0; a < 3; ++a) {
      const I16 at = ((cell_[a] + rays_.base[a]) ^ rays_.flip[a]) & 7;
      first += (at - rays_.flip[a]) * kStride[a];
      step[a] = arrived_ & ((rays_.flip[a] ^ kStride[a]) - rays_.flip[a]);
      from[a] = (rays_.origin[a] - to_float(cell_[a])) + t_ * rays_.direction[a];
    }
    // The pair's lower sample.
    first = arrived_ & (first + rays_.flip[2]);
    const I16 backwards = rays_.flip[2];
    F16 corners[4][2];
    for (int i = 0; i < 4; ++i) {
      I16 corner = first;
      if ((i & 2) != 0) corner += step[0];
      if ((i & 1) != 0) corner += step[1];
      gather_pair(scene_.samples, corner, backwards, corners[i]);
    }
    return make_cubic(corners, from, rays_.direction);
  }

  // Solves the cells of the arrived lanes; those without a hit walk on.
  void solve() {
    I16 past[3];
    F16 exit = splat(0.0F);
    for (int a = 0; a < 3; ++a) {
      past[a] = cell_[a] + 1;
      const F16 time = to_float(past[a]) * rays_.inverse[a] + rays_.offset[a];
      exit = a == 0 ? time : min(exit, time);
    }
    const F16 length = max(exit - t_, splat(0.0F));
    Cubic cubic = load_cubic();
    if (scene_.inside) cubic = {-cubic.c0, -cubic.c1, -cubic.c2, -cubic.c3};
    Bracket bracket = first_bracket(cubic, length, scene_.tolerance, arrived_);
    I16 found = arrived_ & bracket.found & ~bracket.unsure;
    if (any(found)) {
      const F16 s = refine(cubic, bracket, found, kSteep * scene_.tolerance);
      found &= ~bracket.unsure;
      t_ = select(found, t_ + s, t_);
      outcome_ = select(found, splat(kHit), outcome_);
    }
    outcome_ = select(arrived_ & bracket.unsure, splat(kUnsure), outcome_);
    const I16 passing = arrived_ & ~bracket.found & ~bracket.unsure;
    walking_ |= passing;
    arrived_ = splat(0);
    leave(past, passing);
  }

  const PacketScene& scene_;
  PacketHits& hits_;
  Rays rays_{};
  I16 cell_[3]{};  // mirrored, relative to the base
  F16 t_{};        // since the base
  I16 taken_{};    // has or had a ray
  I16 walking_{};  // between crossing cells
  I16 arrived_{};  // at a crossing cell, of brick_
  I16 brick_{};
  I16 steps_{};
  I16 outcome_{};
};

Start load_start(const PacketRays& in, int first) {
  return {in.origin,
          {load16(in.direction[0] + first), load16(in.direction[1] + first),
           load16(in.direction[2] + first)},
          load16(in.from + first)};
}

void trace(const PacketScene& scene, PacketRays& in, PacketHits& hits) {
  Tracer tracer(scene, hits);
  for (int packet = 0; packet < in.packets; ++packet) {
    const int first = packet * kLanes;
    store(hits.outcome + first, splat(kMissed));
    store(hits.steps + first, splat(0));
    Start start = load_start(in, first);
    in.active[packet] &= bits(clip(scene, start));
    store16(in.from + first, start.from);
  }
  for (bool more = true; more;) {
    RayQueue queue;
    for (int packet = 0; packet < in.packets; ++packet) {
      if (in.active[packet] == 0) continue;
      Rays rays = make_lanes(scene, load_start(in, packet * kLanes));
      for (int i = 0; i < kLanes; ++i) rays.number[i] = packet * kLanes + i;
      queue.push(rays, in.active[packet]);
    }
    if (queue.empty()) return;
    tracer.run(queue);
    more = false;
    for (int packet = 0; packet < in.packets; ++packet) {
      const int first = packet * kLanes;
      const I16 going_on = load(hits.outcome + first) == splat(kGoingOn);
      in.active[packet] &= bits(going_on);
      if (in.active[packet] == 0) continue;
      more = true;
      const F16 passed = select(going_on, load(hits.t + first), splat(0.0F));
      store16(in.from + first, load16(in.from + first) + to_double(passed));
    }
  }
}

Start start_of(const PacketCamera& camera, int x, int y, int size, double from) {
  Start start{camera.eye, {}, splat16(from)};
  look_through(camera, x, y, size, start.direction);
  return start;
}

void march_packets(const PacketScene& scene, const PacketCamera& camera, int x, int y,
                   double spread, double from, double* starts) {
  const Start start = start_of(camera, x, y, 4, from);
  const F16 radius = splat(static_cast<float>(spread * from) * 1.000001F + kBeamSlack);
  const BeamEnds ends =
      march(scene, make_lanes(scene, start), radius, static_cast<float>(spread) * 1.000001F);
  const std::uint32_t gone = bits(ends.gone);
  store16(starts, start.from + to_double(ends.t));
  for (int i = 0; i < kLanes; ++i) {
    if (((gone >> i) & 1U) != 0) starts[i] = __builtin_inf();
  }
}

void add_rays(const PacketCamera& camera, int x, int y, double from, PacketRays& rays) {
  const Start start = start_of(camera, x, y, 1, from);
  const int first = rays.packets * kLanes;
  for (int a = 0; a < 3; ++a) {
    store16(rays.direction[a] + first, start.direction[a]);
    rays.origin[a] = camera.eye[a];
  }
  store16(rays.from + first, start.from);
  rays.active[rays.packets++] = 0xffffU;
}

}  // namespace

extern const PacketKernel kPacketKernel;
const PacketKernel kPacketKernel = {march_packets, add_rays, trace};

}  // namespace sdfgrid::SDFGRID_ISA
