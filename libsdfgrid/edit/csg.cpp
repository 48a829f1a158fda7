// Union, difference and intersection of one brick with a brush; declared in brick_edit.h.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "sdfgrid/edit/brick_edit.h"

namespace sdfgrid {
namespace {

CombineOp combine_op(StrokeOp op) {
  if (op == StrokeOp::unite) return CombineOp::unite;
  return op == StrokeOp::subtract ? CombineOp::subtract : CombineOp::intersect;
}

// The part of a long segment that is nearest to samples of a brick: as a whole it would be too long
// for single precision.
Placement near_brick(const Placement& p, const glm::dvec3& first_sample) {
  constexpr double kLong = 4096;  // voxels
  const glm::dvec3 axis = p.to - p.from;
  const double length = glm::length(axis);
  const double growth = std::abs(p.radius_to - p.radius_from);
  if (length <= kLong || length <= 2 * growth) return p;
  const double t = glm::dot(first_sample + 3.5 - p.from, axis) / (length * length);
  const double away = distance_to_segment(first_sample + 3.5, p.from, p.to);
  // The nearest point is beside a sample's foot by the distance times the tangent of the cone's
  // half angle, which is less than one.
  const double half = (2 * (away + 8) + 16) / length;
  const double begin = std::clamp(t - half, 0.0, 1.0);
  const double end = std::clamp(t + half, 0.0, 1.0);
  Placement part = p;
  part.from = p.from + begin * axis;
  part.to = p.from + end * axis;
  part.radius_from = glm::mix(p.radius_from, p.radius_to, begin);
  part.radius_to = glm::mix(p.radius_from, p.radius_to, end);
  return part;
}

RoundSegment make_segment(const Placement& whole, const glm::dvec3& first_sample) {
  const Placement p = near_brick(whole, first_sample);
  RoundSegment s{};
  glm::dvec3 axis = p.to - p.from;
  double growth = p.radius_to - p.radius_from;
  double length = glm::length(axis);
  glm::dvec3 a = p.from;
  double radius = p.radius_from;
  if (length <= std::abs(growth) || length < 1e-9) {  // one ball holds the other
    if (growth > 0) {
      a = p.to;
      radius = p.radius_to;
    }
    length = 0;
  }
  for (int i = 0; i < 3; ++i) s.a[i] = static_cast<float>(a[i] - first_sample[i]);
  s.radius = static_cast<float>(radius);
  if (length == 0) return s;
  const double sine = -growth / length;  // of the cone's half angle
  for (int i = 0; i < 3; ++i) s.axis[i] = static_cast<float>(axis[i]);
  s.over_length2 = static_cast<float>(1 / (length * length));
  s.across = static_cast<float>(sine / (length * std::sqrt(1 - sine * sine)));
  s.growth = static_cast<float>(growth);
  return s;
}

// Bounds on the distances from a brick's samples to a ball, voxels.
struct Bounds {
  double least, most;
};
Bounds bounds_of(const Placement& p, const glm::dvec3& first_sample) {
  constexpr double kHalfDiagonal = 6.0622;
  const double d = distance_to_segment(first_sample + 3.5, p.from, p.to);
  return {d - kHalfDiagonal - std::max(p.radius_from, p.radius_to),
          d + kHalfDiagonal - std::min(p.radius_from, p.radius_to)};
}

// The least of the distances to the balls that reach the brick, voxels. Those are left out of which
// another is nearer to every sample.
void ball_distances(const StrokePlan& plan, const PlannedBrick& planned, float* distances) {
  constexpr std::int32_t kTogether = 16;
  constexpr double kRounding = 1e-3;
  const glm::dvec3 first = 8.0 * glm::dvec3(planned.brick);
  double most = 1e300;
  const bool single = planned.end - planned.begin == 1;
  for (std::uint32_t i = planned.begin; i < planned.end && !single; ++i) {
    most = std::min(most, bounds_of(plan.placements[plan.reaching[i]], first).most);
  }
  RoundSegment segments[kTogether];
  alignas(64) float more[kBrickSamples];
  float* out = distances;
  std::int32_t count = 0;
  const auto sweep = [&] {
    combine_kernel().sweep(segments, count, out);
    for (int i = 0; out == more && i < kBrickSamples; ++i) {
      distances[i] = std::min(distances[i], more[i]);
    }
    out = more;
    count = 0;
  };
  for (std::uint32_t i = planned.begin; i < planned.end; ++i) {
    const Placement& p = plan.placements[plan.reaching[i]];
    if (!single && bounds_of(p, first).least > most + kRounding) continue;
    segments[count++] = make_segment(p, first);
    if (count == kTogether) sweep();
  }
  if (count > 0) sweep();
}

// Divides a brick's values (voxels) by their slope where it is below one. A bound that is a tenth
// of the distance to a brush would otherwise count as near ten times as far away as the brush is,
// and move the surface of the model there. Along each axis the larger of both sides' differences
// counts, so that beside a crease of the brush the result is still a bound.
void divide_by_slope(float* d) {
  constexpr float kLeastSlope = 1.0F / 64;
  float scaled[kBrickSamples];
  for (int s = 0; s < kBrickSamples; ++s) {
    float squared = 0;
    for (const int step : {64, 8, 1}) {
      const int at = s / step & 7;
      const float before = at > 0 ? std::abs(d[s] - d[s - step]) : 0.0F;
      const float behind = at < 7 ? std::abs(d[s + step] - d[s]) : 0.0F;
      const float larger = std::max(before, behind);
      squared += larger * larger;
    }
    scaled[s] = d[s] / std::clamp(std::sqrt(squared), kLeastSlope, 1.0F);
  }
  std::copy_n(scaled, kBrickSamples, d);
}

void shape_distances(const BrushShape& shape, double voxel, const StrokePlan& plan,
                     const PlannedBrick& planned, float* distances) {
  float x[kBrickSamples];
  float y[kBrickSamples];
  float z[kBrickSamples];
  float d[kBrickSamples];
  for (std::uint32_t i = planned.begin; i < planned.end; ++i) {
    const Placement& p = plan.placements[plan.reaching[i]];
    // The shape scaled by f about its origin has the distances f d(x / f).
    const glm::dvec3 scale = p.flip * (voxel / p.pressure);
    const auto per_voxel = static_cast<float>(p.pressure / voxel);
    const glm::vec3 from((8.0 * glm::dvec3(planned.brick) - p.from) * scale);
    const glm::vec3 step(scale);
    for (int s = 0; s < kBrickSamples; ++s) {
      x[s] = from.x + step.x * static_cast<float>(s >> 6);
      y[s] = from.y + step.y * static_cast<float>(s >> 3 & 7);
      z[s] = from.z + step.z * static_cast<float>(s & 7);
    }
    shape.distances(x, y, z, d, kBrickSamples);
    for (float& distance : d) distance *= per_voxel;
    if (shape.shallow) divide_by_slope(d);
    for (int s = 0; s < kBrickSamples; ++s) {
      distances[s] = i == planned.begin ? d[s] : std::min(distances[s], d[s]);
    }
  }
}

}  // namespace

void range_distances(const EditContext& context, const glm::ivec3& brick, float* distances) {
  const double band = std::max(context.limits.outside, -context.limits.inside);
  const double margin = band / context.lattice.voxel + 1;
  const glm::vec3 lo(glm::dvec3(context.range.lo) + margin);
  const glm::vec3 hi(glm::dvec3(context.range.hi) - margin);
  for (int s = 0; s < kBrickSamples; ++s) {
    const glm::vec3 p(8 * brick + glm::ivec3(s >> 6, s >> 3 & 7, s & 7));
    const glm::vec3 beyond = glm::max(lo - p, p - hi);
    const float farthest = std::max({beyond.x, beyond.y, beyond.z});
    distances[s] = farthest < 0 ? farthest : glm::length(glm::max(beyond, glm::vec3(0.0F)));
  }
}

void brush_distances(const Stroke& stroke, const StrokePlan& plan, const PlannedBrick& planned,
                     const EditContext& context, float* distances) {
  const double voxel = context.lattice.voxel;
  if (planned.begin == planned.end) {  // beyond the brush, for an intersection
    std::fill(distances, distances + kBrickSamples, 1e9F);
  } else if (stroke.brush.shape) {
    shape_distances(*stroke.brush.shape, voxel, plan, planned, distances);
  } else {
    ball_distances(plan, planned, distances);
  }
  if (plan.clipped) {
    float range[kBrickSamples];
    range_distances(context, planned.brick, range);
    for (int s = 0; s < kBrickSamples; ++s) distances[s] = std::max(distances[s], range[s]);
  }
}

void combine_brick(const Stroke& stroke, const StrokePlan& plan, const PlannedBrick& planned,
                   const EditContext& context, BrickEdit& edit) {
  alignas(64) float distances[kBrickSamples];
  brush_distances(stroke, plan, planned, context, distances);
  CombineInput in{};
  in.op = combine_op(stroke.op);
  in.brush = distances;
  in.before = edit.before.values;
  in.constant = edit.before.constant;
  in.voxel = static_cast<float>(context.lattice.voxel);
  in.smooth = static_cast<float>(stroke.smooth);
  in.inside = context.limits.inside;
  in.outside = context.limits.outside;
  in.bound_inside = planned.overlapping || plan.clipped;
  edit.made.after = edit.after;
  combine_kernel().combine(in, edit.made);
}

}  // namespace sdfgrid
