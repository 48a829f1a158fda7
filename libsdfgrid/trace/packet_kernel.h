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

#include "sdfgrid/core/kernel.h"

namespace sdfgrid {

struct PacketScene {
  const std::int32_t* bricks;
  const std::uint8_t* jumps;  // as in Atlas
  const std::uint32_t* hops;
  const float* samples;
  std::int32_t dims[3];  // slots
  float tolerance;       // of a value
  bool inside;           // the field is negative where the rays start
};

// The rays of a picture: from eye through corner + x right + y down, which is not of unit length.
struct PacketCamera {
  double eye[3], corner[3], right[3], down[3];
};

// Rays from one place, in packets of sixteen.
struct PacketRays {
  static constexpr int kLanes = 16;
  static constexpr int kPackets = 64;
  static constexpr int kRays = kLanes * kPackets;
  alignas(64) double direction[3][kRays];  // unit length
  alignas(64) double from[kRays];          // where the ray starts; changed by the tracer
  double origin[3];
  std::int32_t packets = 0;
  std::uint32_t active[kPackets];  // a packet; bit i: lane i is to be traced
};

enum PacketOutcome : std::int32_t {
  kMissed,
  kHit,
  kUnsure,  // to be done again in double
  kGoingOn  // within the tracer only: at the end of a segment
};

// Of rays that were active.
struct PacketHits {
  alignas(64) std::int32_t outcome[PacketRays::kRays];
  alignas(64) std::int32_t steps[PacketRays::kRays];
  alignas(64) float t[PacketRays::kRays];  // of a hit, beyond PacketRays::from
};

struct PacketKernel {
  // For each of 4 x 4 packets of 4 x 4 pixels, (x, y) the first, a length, at least `from`, up to
  // which its rays meet nothing after `from`, or +inf if they never do. `spread`: more than what a
  // unit direction in a packet differs from the middle one.
  void (*march_packets)(const PacketScene& scene, const PacketCamera& camera, int x, int y,
                        double spread, double from, double* starts);
  // Adds the rays through the centres of 4 x 4 pixels, (x, y) the first, starting at `from`.
  void (*add_rays)(const PacketCamera& camera, int x, int y, double from, PacketRays& rays);
  void (*trace)(const PacketScene& scene, PacketRays& rays, PacketHits& hits);
};

// The kernel for this machine.
const PacketKernel& packet_kernel();

SDFGRID_DECLARE_ISAS(extern const PacketKernel kPacketKernel)

}  // namespace sdfgrid
