// trace/packet_tables.h: what the tables of an Atlas say of sixteen rays' cells; for
// packet_kernel.cpp only (not installed).
#pragma once

#include "sdfgrid/core/simd.h"
#include "sdfgrid/trace/packet_rays.h"

namespace sdfgrid::SDFGRID_ISA {

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

// The empty cube ahead of a cell.
struct Ahead {
  I16 in_brick;  // the cell is in a crossing brick ...
  I16 brick;     // ... this one
  I16 blocked;   // and may hold a zero: the rest does not apply
  I16 along[3];  // where in its brick the cell is, mirrored
  I16 past[3];   // first relative cells beyond the cube
};

// For lanes of `wanted`, whose cells must be within the tables.
inline Ahead look_ahead(const PacketScene& scene, const Rays& rays, const I16 (&cell)[3],
                        I16 wanted) {
  Ahead ahead;
  I16 slot[3];
  for (int a = 0; a < 3; ++a) {
    const I16 mirrored = cell[a] + rays.base[a];
    slot[a] = (mirrored ^ rays.flip[a]) >> 3;
    ahead.along[a] = mirrored & 7;
  }
  const std::int32_t plane = scene.dims[1] * scene.dims[2];
  const I16 place = wanted & (slot[0] * plane + slot[1] * scene.dims[2] + slot[2]);
  const I16 jumps = gather_byte(scene.jumps, place + (rays.octant >> 1) * (scene.dims[0] * plane));
  const I16 jump = jumps >> ((rays.octant & 1) << 2) & 15;
  ahead.in_brick = wanted & (jump == 0);
  ahead.brick = ahead.in_brick & gather(scene.bricks, place);
  const I16 row = (((ahead.brick << 3) + rays.octant) << 6) + (ahead.along[0] << 3);
  const I16 word = gather(reinterpret_cast<const std::int32_t*>(scene.hops), row + ahead.along[1]);
  const I16 hop = (word >> (ahead.along[2] << 2)) & 15;
  ahead.blocked = ahead.in_brick & (hop == 0);
  for (int a = 0; a < 3; ++a) {
    // A cube of cells is cut off where the brick ends, one of bricks starts where it does.
    const I16 inner = min(hop, 8 - ahead.along[a]);
    ahead.past[a] = cell[a] + select(ahead.in_brick, inner, (jump << 3) - ahead.along[a]);
  }
  return ahead;
}

}  // namespace sdfgrid::SDFGRID_ISA
