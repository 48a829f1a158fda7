// trace/look_through.h: directions through pixels, sixteen at a time, for the *_kernel.cpp files of
// trace/ only (not installed).
#pragma once

#include "sdfgrid/trace/packet_kernel.h"
#include "sdfgrid/trace/simd_double.h"

namespace sdfgrid::SDFGRID_ISA {

// Through the middles of 4 x 4 squares of `size` pixels, (x, y) the first pixel; of unit length.
inline void look_through(const PacketCamera& camera, int x, int y, int size, D16 (&direction)[3]) {
  double column[kLanes];
  double row[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    const int right = i % 4;
    const int down = i / 4;
    column[i] = x + size * (right + 0.5);
    row[i] = y + size * (down + 0.5);
  }
  D16 square = splat16(0);
  for (int a = 0; a < 3; ++a) {
    direction[a] = splat16(camera.corner[a]) + splat16(camera.right[a]) * load16(column) +
                   splat16(camera.down[a]) * load16(row);
    square = square + direction[a] * direction[a];
  }
  const D16 scale = inverse_root(square);
  for (D16& d : direction) d = d * scale;
}

}  // namespace sdfgrid::SDFGRID_ISA
