// trace/box_kernel.h: which of sixteen beams may meet a box (internal to trace/): plain data,
// shared with the kernel.
#pragma once

#include <cstdint>

#include "sdfgrid/core/kernel.h"

namespace sdfgrid {

// Sixteen beams: around the axis from `origin` each is as wide as width + widening * t at t.
struct alignas(64) BeamLanes {
  static constexpr int kLanes = 16;
  double origin[3][kLanes], inverse[3][kLanes];  // 1 / direction of the axis
  double width[kLanes], widening[kLanes];
  double deepest[kLanes];  // what is beyond does not matter
};

struct BeamsMet {
  std::uint32_t beams;  // bit i: beam i
  double nearest;       // where the first of them may
};

// Of the beams whose bits are set those that may meet a box. `farthest` is at least the distance
// from any of their origins to any point of it: a ray is in the box no later than there, and its
// beam's axis then no farther from the box than the beam is wide there.
using MeetBox = BeamsMet (*)(const BeamLanes& beams, const double lo[3], const double hi[3],
                             double farthest, std::uint32_t asked);

// The kernel for this machine.
MeetBox meet_box();

SDFGRID_DECLARE_ISAS(extern const MeetBox kMeetBox)

}  // namespace sdfgrid
