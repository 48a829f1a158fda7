// trace/packet_beam.h: sixteen beams of rays at once up to where they may meet the surface; for
// packet_kernel.cpp only (not installed). What beam.cpp does between bricks, between cells too.
#pragma once

#include "sdfgrid/trace/packet_tables.h"

namespace sdfgrid::SDFGRID_ISA {

// Added to the beams' radius: more than all rounding of places in float within kReach cells.
inline constexpr float kBeamSlack = 1e-3F;
inline constexpr float kBeamReach = 256;
// Most beams end sooner; those that do not may stop anywhere.
inline constexpr int kBeamRounds = 32;

struct BeamEnds {
  F16 t;     // since the start: before this no ray of the beam leaves empty space
  I16 gone;  // none ever does
};

// Where a border that moves as at + speed * t reaches `limit`, if it moves that way.
inline F16 reaches(F16 at, F16 speed, F16 limit) {
  return select(speed > 0.0F, (limit - at) / speed, splat(1e30F));
}

// axes: the beams' middle rays. The rays of a beam are less than radius + spread * t apart from it.
inline BeamEnds march(const PacketScene& scene, const Rays& axes, F16 radius, float spread) {
  BeamEnds ends{splat(0.0F), splat(0)};
  I16 marching = splat(-1);
  for (int round = 0; round < kBeamRounds && any(marching); ++round) {
    I16 rear[3];
    I16 first[3];  // cells before this are beyond the tables
    F16 back[3];   // the rear border
    for (int a = 0; a < 3; ++a) {
      first[a] = axes.limit[a] - scene.dims[a] * 8;
      back[a] = axes.origin[a] - radius + ends.t * (axes.direction[a] - spread);
      rear[a] = max(to_int(floor(back[a])), first[a]);
      const I16 beyond = rear[a] >= axes.limit[a];
      // It stays so if no ray of the beam runs back.
      ends.gone |= marching & beyond & (axes.direction[a] >= spread);
      marching &= ~beyond;
    }
    const Ahead ahead = look_ahead(scene, axes, rear, marching);
    F16 exit = splat(1e30F);
    for (int a = 0; a < 3; ++a) {
      // Beyond the tables all is empty.
      const I16 start = select(ahead.in_brick, rear[a], rear[a] - ahead.along[a]);
      const F16 lo = select(start <= first[a], splat(-1e30F), to_float(start));
      const F16 hi = select(ahead.past[a] >= axes.limit[a], splat(1e30F), to_float(ahead.past[a]));
      const F16 front = axes.origin[a] + radius;
      exit = min(exit, reaches(front, axes.direction[a] + spread, hi));
      exit = min(exit, reaches(radius - axes.origin[a], spread - axes.direction[a], -lo));
    }
    marching &= ~ahead.blocked & (exit > ends.t);
    ends.gone |= marching & (exit > 1e29F);
    marching &= ~ends.gone;
    ends.t = select(marching, exit, ends.t);
    marching &= exit < kBeamReach;
  }
  return ends;
}

}  // namespace sdfgrid::SDFGRID_ISA
