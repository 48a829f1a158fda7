// trace/packet_rays.h: rays as packet_kernel.cpp works on them, and a queue of such; for that file
// only (not installed).
//
// Each ray is mirrored so that it runs towards growing coordinates on all axes: of the planes of a
// cube it leaves by an upper one. The mirrored cell c is the cell ~c of the lattice. Positions are
// relative to the cell in which the ray starts, or starts a further segment.
#pragma once

#include "sdfgrid/trace/packet_kernel.h"
#include "sdfgrid/trace/simd_double.h"

namespace sdfgrid::SDFGRID_ISA {

// What does not change along a ray, one a lane.
struct Rays {
  F16 origin[3];     // in the base cell, so about [0, 1]
  F16 direction[3];  // > 0
  F16 inverse[3];
  F16 offset[3];  // -origin * inverse
  I16 base[3];    // mirrored base cell: what to add to relative cells
  I16 flip[3];    // -1 if mirrored, else 0
  I16 limit[3];   // first relative cell beyond the tables
  I16 octant;     // as in Atlas
  I16 number;     // of the ray
};
inline constexpr int kFields = sizeof(Rays) / sizeof(F16);

// Lanes of `mask`, packed to the front, into p, where there must be room for all sixteen.
inline void compress(const F16& v, std::uint32_t mask, float* p) {
#if defined(__AVX512F__)
  _mm512_storeu_ps(p, _mm512_maskz_compress_ps(static_cast<__mmask16>(mask), (__m512)v));
#else
  for (int i = 0; i < kLanes; ++i) {
    if (((mask >> i) & 1U) != 0) *p++ = v[i];
  }
#endif
}

// The inverse: the lanes of `mask` get successive values from p.
inline F16 expand(F16 v, std::uint32_t mask, const float* p) {
#if defined(__AVX512F__)
  return (F16)_mm512_mask_expandloadu_ps((__m512)v, static_cast<__mmask16>(mask), p);
#else
  for (int i = 0; i < kLanes; ++i) {
    if (((mask >> i) & 1U) != 0) v[i] = *p++;
  }
  return v;
#endif
}

// Rays waiting for a free lane, first in first out.
class RayQueue {
 public:
  void push(const Rays& rays, std::uint32_t mask) {
    for (int f = 0; f < kFields; ++f) {
      if (mask == 0xffffU) {
        store(field_[f] + end_, field(rays, f));
      } else {
        compress(field(rays, f), mask, field_[f] + end_);
      }
    }
    end_ += __builtin_popcount(mask);
  }

  // Fills the free lanes as far as there are rays; returns those filled.
  std::uint32_t pop(Rays& rays, std::uint32_t free) {
    while (__builtin_popcount(free) > end_ - begin_) free &= free - 1;
    for (int f = 0; f < kFields; ++f) {
      const F16 filled = expand(field(rays, f), free, field_[f] + begin_);
      __builtin_memcpy(reinterpret_cast<char*>(&rays) + f * sizeof filled, &filled, sizeof filled);
    }
    begin_ += __builtin_popcount(free);
    return free;
  }

  [[nodiscard]] bool empty() const { return begin_ == end_; }

 private:
  static F16 field(const Rays& rays, int f) {
    F16 v;
    __builtin_memcpy(&v, reinterpret_cast<const char*>(&rays) + f * sizeof v, sizeof v);
    return v;
  }

  int begin_ = 0;
  int end_ = 0;
  alignas(64) float field_[kFields][PacketRays::kRays + kLanes];
};

// A packet's rays from one place: unit directions, and where on them to start.
struct Start {
  const double* origin;
  D16 direction[3];
  D16 from;
  [[nodiscard]] D16 place(int a) const { return splat16(origin[a]) + from * direction[a]; }
};

// Moves starts to where the rays enter the tables; returns which do.
inline I16 clip(const PacketScene& scene, Start& start) {
  I16 inside = splat(-1);
  for (int a = 0; a < 3; ++a) {
    const D16 place = start.place(a);
    inside &= to_float(min(place, splat16(scene.dims[a] * 8) - place)) > 0.0F;
  }
  if (all(inside)) return inside;
  D16 to = splat16(1e300);
  for (int a = 0; a < 3; ++a) {
    D16 direction = start.direction[a];
    for (DPart& d : direction.part) d = d == 0.0 ? splat_part(1e-200) : d;
    const D16 inverse = splat16(1) / direction;
    const D16 zero = splat16(-start.origin[a]) * inverse;
    const D16 end = splat16(scene.dims[a] * 8 - start.origin[a]) * inverse;
    start.from = max(min(zero, end), start.from);
    to = min(max(zero, end), to);
  }
  return to_float(to - start.from) > 0.0F;
}

// Splits the places where the rays start into a cell of the tables and the rest, in double.
inline Rays make_lanes(const PacketScene& scene, const Start& start) {
  Rays rays;
  rays.octant = splat(0);
  rays.number = splat(0);
  for (int a = 0; a < 3; ++a) {
    const std::int32_t cells = scene.dims[a] * 8;
    const D16 place = start.place(a);
    const I16 base = to_int(min(max(place, splat16(0)), splat16(cells - 1)));
    const F16 rest = to_float(place - to_double(base));
    const F16 d = to_float(start.direction[a]);
    rays.flip[a] = d < 0.0F;
    rays.origin[a] = select(rays.flip[a], 1.0F - rest, rest);
    // Flatter than this a ray stays in its cell; 0 would make the plane at hand 0 / 0 away.
    rays.direction[a] = max(abs(d), splat(1e-30F));
    rays.inverse[a] = 1.0F / rays.direction[a];
    rays.offset[a] = -rays.origin[a] * rays.inverse[a];
    rays.base[a] = base ^ rays.flip[a];
    rays.limit[a] = (~rays.flip[a] & cells) - rays.base[a];
    rays.octant = 2 * rays.octant - rays.flip[a];
  }
  return rays;
}

}  // namespace sdfgrid::SDFGRID_ISA
