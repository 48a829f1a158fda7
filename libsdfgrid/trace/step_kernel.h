// trace/step_kernel.h: the steps of sphere tracing, sixteen rays at a time, between
// field_march.cpp and step_kernel.cpp, which is compiled once for each instruction set. Plain data
// only (not installed).
//
// Places along rays are floats, counted from a base that follows the rays and is kept in double: a
// place is then rounded in proportion to what is left of the way, not to where the camera stands.
#pragma once

#include <cstdint>

#include "sdfgrid/core/kernel.h"
#include "sdfgrid/trace/packet_kernel.h"

namespace sdfgrid {

// What float evaluation may be off, in proportion to a coordinate, and what a place along a ray, in
// proportion to its distance from the base: three roundings of each of three coordinates.
inline constexpr double kFieldSlack = 1.5e-6;
inline constexpr float kPlaceSlack = 2.5e-7F;

// Sixteen rays.
struct alignas(64) RayLanes {
  static constexpr int kLanes = 16;
  double start[3][kLanes];
  double along[3][kLanes];  // unit length
};

// Sixteen rays, or beams (rays with a radius), on their way. A lane is not done while clear < end.
// Lengths along a ray are counted from `base`.
struct alignas(64) RayGroup {
  static constexpr int kLanes = RayLanes::kLanes;
  static constexpr float kNever = -1e30F;
  static constexpr float kNotHit = 1e30F;

  // Columns first, so that none lies across two lines of the cache.
  float origin[3][kLanes];  // its place at the base
  float direction[3][kLanes];
  float clear[kLanes];  // the way up to here is known to be free
  float next[kLanes];   // where the field is evaluated next: beyond `clear` only if it may be taken
                        // back
  float end[kLanes];    // kNever: nothing more is to be done
  float last[kLanes];   // where the field was evaluated last, or kNever, and
  float value[kLanes];  // what it was there
  float slope[kLanes];  // of the field along the ray, smoothed
  float hit[kLanes];    // kNotHit if there is none
  float width[kLanes];  // the radius is width + widening * place
  float widening[kLanes];
  std::int32_t steps[kLanes];  // evaluations
  double base;
  const RayLanes* rays;
  double* depth;  // of their first hits so far, not counted from the base; none of beams
};

// What is the same for all lanes.
struct StepRule {
  float sign;       // of the field where the rays begin
  float tolerance;  // a hit is where less is free than tolerance * place + near,
  float near;       // the tolerance at the base,
  float share;      // or less than this share of a beam's radius
  float limit;      // steps end here
  bool relax;       // as R. Ban and G. Valasek (2023)
  bool convex;      // the field's value is a convex function along any ray
};

// How far the way is free around where each lane stands, where that is more than the value: ahead,
// as long as the slope there stays what it is, and back. All null if it is not.
struct FreeWays {
  const float* ahead;
  const float* surface;
  const float* back;
};

// What a group's rays have before them: all are free up to `clear`; nothing if that is not before
// the end. Not counted from the base.
struct GroupWay {
  double clear, end;
};

// Where groups run: a box around their rays, and one around where they end.
struct GroupRoom {
  double lo[3], hi[3], far_lo[3], far_hi[3];
  int groups;  // that go on
};

// `list` has the numbers of n groups; positions and values lie 16 beside each other for each of the
// list, in that order.
struct StepKernel {
  // The rays through the centres of 4 x 4 pixels, (x, y) the first.
  void (*look)(const PacketCamera& camera, int x, int y, RayLanes& rays);
  // Where each ray is in a box, not before its start: from > to if it is not.
  void (*clip)(const RayLanes& rays, const double lo[3], const double hi[3], double* from,
               double* to);
  // Makes a lane of `beams` the beam around rays, whose radius is width + widening * place, and
  // that of `axes` its axis.
  void (*beam)(const RayLanes& rays, RayLanes& axes, RayGroup& beams, int lane);
  // Sets out: the group's rays are known, and those are to be traced whose `from` is less than
  // their `to`, between these. Places count from the last multiple of `grain` before them.
  GroupWay (*begin)(RayGroup& group, const double* from, const double* to, double grain);
  // Counts places from `base` on.
  void (*rebase)(RayGroup* groups, const std::uint32_t* list, int n, double base);
  // Makes lanes free up to `from` (of each group of the list), and writes where those are to be
  // evaluated whose groups have not all arrived at the limit. Those groups stay in the list; their
  // number.
  int (*place)(RayGroup* groups, std::uint32_t* list, int n, const float* from, float limit,
               float* const p[3]);
  // Takes in the values at the positions; then as place().
  int (*step)(RayGroup* groups, std::uint32_t* list, int n, const StepRule& rule,
              const float* values, const FreeWays& ways, float* const p[3]);
  // Lowers the depths of the group's rays to what they have hit; what is left before them.
  GroupWay (*collect)(RayGroup& group);
  // Of the groups from `first` to before `last` between t0 and t1, lane i of beam j the beam of
  // group 16 j + i; ways in columns.
  GroupRoom (*room)(const RayGroup* beams, const double* clear, const double* end, int first,
                    int last, double t0, double t1);
  // Depths and evaluations of 4 x 4 pixels into the rows of a picture that is `width` wide.
  void (*write)(const double* depth, const std::uint32_t* steps, float* depths,
                std::uint16_t* counts, long width);
};

// The kernel for this machine.
const StepKernel& step_kernel();

SDFGRID_DECLARE_ISAS(extern const StepKernel kStepKernel)

}  // namespace sdfgrid
