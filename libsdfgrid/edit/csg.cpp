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

constexpr int kBlock = 10;  // a brick's samples and one more on every side
constexpr int kBlockSamples = kBlock * kBlock * kBlock;

// The shape's values, voxels, at a brick's samples and `apron` (0 or 1) more on every side.
void shape_values(const BrushShape& shape, const Placement& p, const glm::ivec3& brick,
                  double voxel, int apron, float* d) {
  float x[kBlockSamples];
  float y[kBlockSamples];
  float z[kBlockSamples];
  const int edge = 8 + 2 * apron;
  const int count = edge * edge * edge;
  // The shape scaled by f about its origin has the distances f d(x / f).
  const glm::dvec3 scale = p.flip * (voxel / p.pressure);
  const auto per_voxel = static_cast<float>(p.pressure / voxel);
  const glm::vec3 from((8.0 * glm::dvec3(brick) - p.from) * scale);
  const glm::vec3 step(scale);
  int s = 0;
  for (int i = -apron; i < 8 + apron; ++i) {
    for (int j = -apron; j < 8 + apron; ++j) {
      for (int k = -apron; k < 8 + apron; ++k, ++s) {
        x[s] = from.x + step.x * static_cast<float>(i);
        y[s] = from.y + step.y * static_cast<float>(j);
        z[s] = from.z + step.z * static_cast<float>(k);
      }
    }
  }
  shape.distances(x, y, z, d, static_cast<std::size_t>(count));
  for (s = 0; s < count; ++s) d[s] *= per_voxel;
}

// Calls visit(s, d, sides) for a brick's samples: d points to the sample's value, and
// sides(axis, step) says whether there is one beside it (step -1 or 1) and how far it is on.
template <class Visit>
void for_samples(const float* values, int apron, const Visit& visit) {
  const int edge = 8 + 2 * apron;
  const int steps[3] = {edge * edge, edge, 1};
  for (int s = 0; s < kBrickSamples; ++s) {
    const int at[3] = {(s >> 6) + apron, (s >> 3 & 7) + apron, (s & 7) + apron};
    const float* d = values + at[0] * steps[0] + at[1] * steps[1] + at[2];
    visit(s, d, [&](int axis, int step) {
      const int there = at[axis] + step;
      return there < 0 || there >= edge ? 0 : step * steps[axis];
    });
  }
}

// Divides a brick's values by their slope where it is below one. A bound that is a tenth of the
// distance to a brush would otherwise count as near ten times as far away as the brush is, and move
// the surface of the model there. Along each axis the larger of both sides' differences counts, so
// that beside a crease of the brush the result is still a bound; but where the brush's surface lies
// between two samples, the difference of those two, for that is where it must be.
void divide_by_slope(const float* values, int apron, float* out) {
  constexpr float kLeastSlope = 1.0F / 64;
  for_samples(values, apron, [&](int s, const float* d, const auto& beside) {
    float squared = 0;
    for (int axis = 0; axis < 3; ++axis) {
      float larger = 0;
      float across = 0;
      for (const int step : {-1, 1}) {
        const int there = beside(axis, step);
        const float difference = std::abs(d[there] - *d);
        larger = std::max(larger, difference);
        if ((d[there] < 0) != (*d < 0)) across = std::max(across, difference);
      }
      const float slope = across > 0 ? across : larger;
      squared += slope * slope;
    }
    out[s] = *d / std::clamp(std::sqrt(squared), kLeastSlope, 1.0F);
  });
}

// `apart`, if not null: the samples with none beside them on the other side of the brush's surface.
void shape_distances(const BrushShape& shape, double voxel, const StrokePlan& plan,
                     const PlannedBrick& planned, float* distances, std::uint64_t* apart) {
  float values[kBlockSamples];
  float least[kBlockSamples];
  float d[kBrickSamples];
  const int apron = apart != nullptr ? 1 : 0;
  for (std::uint32_t i = planned.begin; i < planned.end; ++i) {
    const Placement& p = plan.placements[plan.reaching[i]];
    shape_values(shape, p, planned.brick, voxel, apron, values);
    const float* brush = values;  // of the brick alone
    if (shape.shallow) {
      divide_by_slope(values, apron, d);
      brush = d;
    } else if (apron > 0) {
      for_samples(values, apron, [&](int s, const float* value, const auto&) { d[s] = *value; });
      brush = d;
    }
    for (int s = 0; s < kBrickSamples; ++s) {
      distances[s] = i == planned.begin ? brush[s] : std::min(distances[s], brush[s]);
    }
    for (int s = 0; apart != nullptr && s < kBlockSamples; ++s) {
      least[s] = i == planned.begin ? values[s] : std::min(least[s], values[s]);
    }
  }
  if (apart == nullptr) return;
  std::fill(apart, apart + kBrickWords, 0);
  for_samples(least, apron, [&](int s, const float* value, const auto& beside) {
    bool alone = true;
    for (int n = 0; n < 6; ++n) {
      alone = alone && (value[beside(n >> 1, (n & 1) * 2 - 1)] < 0) == (*value < 0);
    }
    if (alone) apart[s >> 6] |= std::uint64_t{1} << (s & 63);
  });
}

// Samples further from the model's surface have none beside them on its other side.
constexpr float kBeside = 1.05F;  // voxels

// Whether a brush of mere bounds may move the model's surface in a brick where it makes none.
bool may_move_surface(const Stroke& stroke, const StrokePlan& plan, const PlannedBrick& planned,
                      const GridBrick& before, double voxel) {
  const BrushShape* shape = stroke.brush.shape.get();
  if (shape == nullptr || shape->exact || stroke.smooth > 0 || plan.clipped) return false;
  if (before.values == nullptr || planned.begin == planned.end) return false;
  bool pressed = false;  // a stamp, whose band is then narrower than the grid's
  for (std::uint32_t i = planned.begin; i < planned.end; ++i) {
    pressed = pressed || plan.placements[plan.reaching[i]].pressure < 1;
  }
  const float reach = kBeside * static_cast<float>(voxel);
  return (shape->shallow || pressed) &&
         std::any_of(before.values, before.values + kBrickSamples,
                     [&](float value) { return std::abs(value) <= reach; });
}

// Beside the model's surface, and with no surface of the brush beside it, a sample keeps the
// model's value: the brush's, a bound, would move the model's surface. Which of the two surfaces is
// nearer is measured: those samples are put into `measure`.
void keep_surface(const CombineInput& in, const std::uint64_t* apart, float* distances,
                  std::uint64_t* measure) {
  const bool unite = in.op == CombineOp::unite;
  const float flip = in.op == CombineOp::subtract ? -1.0F : 1.0F;
  for (int s = 0; s < kBrickSamples; ++s) {
    const std::uint64_t bit = std::uint64_t{1} << (s & 63);
    const float model = in.before[s] / in.voxel;
    const float brush = flip * distances[s];
    if ((apart[s >> 6] & bit) == 0 || std::abs(model) > kBeside) continue;
    const bool bound =
        unite ? model >= 0 && brush >= 0 && brush < model : model < 0 && brush < 0 && brush > model;
    if (!bound) continue;
    distances[s] = flip * (unite ? 1e6F : -1e6F);
    measure[s >> 6] |= bit;
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

namespace {

// As brush_distances; `apart` as in shape_distances.
void distances_to_brush(const Stroke& stroke, const StrokePlan& plan, const PlannedBrick& planned,
                        const EditContext& context, float* distances, std::uint64_t* apart) {
  const double voxel = context.lattice.voxel;
  if (planned.begin == planned.end) {  // beyond the brush, for an intersection
    std::fill(distances, distances + kBrickSamples, 1e9F);
  } else if (stroke.brush.shape) {
    shape_distances(*stroke.brush.shape, voxel, plan, planned, distances, apart);
  } else {
    ball_distances(plan, planned, distances);
  }
  if (plan.clipped) {
    float range[kBrickSamples];
    range_distances(context, planned.brick, range);
    for (int s = 0; s < kBrickSamples; ++s) distances[s] = std::max(distances[s], range[s]);
  }
}

}  // namespace

void brush_distances(const Stroke& stroke, const StrokePlan& plan, const PlannedBrick& planned,
                     const EditContext& context, float* distances) {
  distances_to_brush(stroke, plan, planned, context, distances, nullptr);
}

void combine_brick(const Stroke& stroke, const StrokePlan& plan, const PlannedBrick& planned,
                   const EditContext& context, BrickEdit& edit) {
  alignas(64) float distances[kBrickSamples];
  std::uint64_t apart[kBrickWords];
  std::uint64_t measure[kBrickWords] = {};
  const bool careful = may_move_surface(stroke, plan, planned, edit.before, context.lattice.voxel);
  distances_to_brush(stroke, plan, planned, context, distances, careful ? apart : nullptr);
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
  if (careful) keep_surface(in, apart, distances, measure);
  combine_kernel().combine(in, edit.made);
  for (int w = 0; w < kBrickWords; ++w) edit.made.suspect[w] |= measure[w] & edit.made.active[w];
}

}  // namespace sdfgrid
