// trace/packet_kernel.h: sixteen rays at a time through an atlas, between the ordinary code and
// packet_kernel.cpp, which is compiled once for each instruction set. Plain data only (not
// installed). Lengths and positions are in cells, counted from the first slot of the tables.
//
// Why no zero is missed in float. A ray's path is kept relative to a cell at most kSegment cells
// back, so that a computed place is less than `reach` from the true one; the times of entry and
// exit may be further off, where a ray is nearly parallel to a plane, but never the places. So each
// true place of the ray lies within `reach` of a cell that was jumped over, or of the part of a
// cell that was solved.
// - A cell jumped over has no sample within Atlas::margin() of zero, so no zero is within `reach`
//   of it: also not in the corner of another cell that a ray cuts unnoticed.
// - A cell is solved for values, not only for a root: the cubic is known within `tolerance`
//   (reach times the slope, and rounding) at the ends of its monotone pieces. If it comes that
//   near to zero without clearly passing it, the ray is declared unsure, and done again in double.
//   A value near zero at the cell's exit is judged in the next cell, of which it is the entry.
// - A value clearly beyond zero at the entry of a cell says that a zero was passed: unsure as well.
// What remains are clear changes of sign, of which the first in float is the first in truth.
#pragma once

#include <cstdint>

namespace sdfgrid {

struct PacketScene {
  const std::int32_t* bricks;
  const std::uint8_t* jumps;
  const std::uint32_t* hops;
  const float* samples;
  std::int32_t dims[3];  // slots
  float tolerance;       // of a value, in cells
};

// The rays of a picture: from eye through corner + x right + y down, which is not of unit length.
struct PacketCamera {
  double eye[3], corner[3], right[3], down[3];
};

struct PacketRays {
  static constexpr int kRays = 16;
  alignas(64) double origin[3][kRays];
  alignas(64) double direction[3][kRays];  // unit length
  alignas(64) double from[kRays];          // where the ray starts
  std::uint32_t active;                    // bit i: ray i is to be traced
  std::uint32_t inside;                    // bit i: the field is negative where ray i starts
};

struct PacketHits {
  alignas(64) double t[PacketRays::kRays];  // of the rays that hit
  alignas(64) std::int32_t steps[PacketRays::kRays];
  std::uint32_t hit;     // bit i: ray i hits
  std::uint32_t unsure;  // bit i: do ray i again in double
};

struct PacketKernel {
  // The rays through the centres of 4 x 4 pixels, (x, y) the first, starting at `from`.
  void (*make_rays)(const PacketCamera& camera, int x, int y, double from, PacketRays& rays);
  void (*trace)(const PacketScene& scene, const PacketRays& rays, PacketHits& hits);
};

// The kernel for this machine.
const PacketKernel& packet_kernel();

namespace baseline {
extern const PacketKernel kPacketKernel;
}
#if defined(__x86_64__)
namespace avx2 {
extern const PacketKernel kPacketKernel;
}
namespace avx512 {
extern const PacketKernel kPacketKernel;
}
#endif

}  // namespace sdfgrid
