#include "sdfgrid/edit/stroke_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/paint.h"

namespace sdfgrid {
namespace {

constexpr double kHalfDiagonal = 6.0621778;  // from a brick's middle to its corner samples, voxels
constexpr double kBytesPerBrick = 2200;

void check_number(bool good, const char* what, double value) {
  if (!good) throw Error(ErrorKind::usage, fmt::format("{} is {:g}", what, value));
}

void check_stroke(const Stroke& stroke) {
  if (stroke.path.empty()) throw Error(ErrorKind::usage, "the stroke's path has no points");
  const auto positive = [](double v) { return std::isfinite(v) && v > 0; };
  if (!stroke.brush.shape) {
    check_number(positive(stroke.brush.radius), "the brush's radius must be above zero; it",
                 stroke.brush.radius);
  }
  check_number(positive(stroke.spacing), "the spacing of dabs must be above zero; it",
               stroke.spacing);
  check_number(std::isfinite(stroke.smooth) && stroke.smooth >= 0,
               "the width of the blend must not be negative; it", stroke.smooth);
  check_number(positive(stroke.strength) && stroke.strength <= 1,
               "the strength must be above 0 and at most 1; it", stroke.strength);
  check_number(stroke.material >= 0 && stroke.material <= kMostMaterial,
               "the material must be 0 to 255; it", stroke.material);
  for (const PathPoint& p : stroke.path) {
    for (int a = 0; a < 3; ++a) {
      check_number(std::isfinite(p.at[a]), "a coordinate of the path must be finite; one", p.at[a]);
    }
    check_number(positive(p.pressure) && p.pressure <= 1,
                 "the pressure must be above 0 and at most 1; one", p.pressure);
  }
}

class Planner {
 public:
  Planner(const Stroke& stroke, const Lattice& lattice, const PlanLimits& limits)
      : stroke_(stroke), lattice_(lattice), limits_(limits) {
    const BrushShape* shape = stroke.brush.shape.get();
    const double radius = shape ? 0.5 * glm::length(shape->bounds.size()) : stroke.brush.radius;
    radius_ = radius / lattice.voxel;
    whole_ = is_csg(stroke.op) || stroke.op == StrokeOp::paint;
    if (whole_) shape_ = shape;
  }

  StrokePlan plan() {
    place_along_path();
    mirror();
    warn();
    check_size();
    find_bricks();
    return std::move(plan_);
  }

 private:
  void place_along_path();
  void place_at_points();
  void place_dabs(bool swept);
  void mirror();
  void warn();
  void check_size() const;
  void find_bricks();
  bool continues(std::uint32_t first, std::uint32_t second) const;
  void reach(const Placement& p, glm::dvec3& lo, glm::dvec3& hi) const;

  const Stroke& stroke_;
  const Lattice& lattice_;
  const PlanLimits& limits_;
  double radius_;                      // voxels; of a shape half its box's diagonal
  bool whole_ = false;                 // the brush itself acts, not a tool as far as its radius
  const BrushShape* shape_ = nullptr;  // in whose box the stroke stays; else it is balls
  StrokePlan plan_;
};

void Planner::place_at_points() {
  for (const PathPoint& point : stroke_.path) {
    Placement p;
    p.from = p.to = lattice_.to_index(point.at);
    p.pressure = point.pressure;
    p.radius_from = p.radius_to = stroke_.brush.shape ? radius_ : radius_ * p.pressure;
    plan_.placements.push_back(p);
  }
  plan_.dabs = plan_.placements.size();
}

// Balls that act themselves are swept from point to point; all else is put down in dabs.
void Planner::place_along_path() {
  if (stroke_.at_points) return place_at_points();
  const bool swept = whole_ && !stroke_.brush.shape;
  place_dabs(swept);
  if (!swept) return;
  plan_.placements.clear();
  const auto& path = stroke_.path;
  for (std::size_t i = 0; i + 1 < std::max<std::size_t>(path.size(), 2); ++i) {
    const PathPoint& a = path[i];
    const PathPoint& b = path[std::min(i + 1, path.size() - 1)];
    Placement p;
    p.from = lattice_.to_index(a.at);
    p.to = lattice_.to_index(b.at);
    p.radius_from = radius_ * a.pressure;
    p.radius_to = radius_ * b.pressure;
    plan_.placements.push_back(p);
  }
}

// Dabs at equal distances along the whole path, the first and the last point among them; for a
// swept ball they are only counted.
void Planner::place_dabs(bool swept) {
  double length = 0;
  std::vector<double> at = {0.0};
  for (std::size_t i = 1; i < stroke_.path.size(); ++i) {
    length += glm::length(stroke_.path[i].at - stroke_.path[i - 1].at) / lattice_.voxel;
    at.push_back(length);
  }
  const double steps = std::ceil(length / (stroke_.spacing * radius_) - 1e-9);
  constexpr double kMostDabs = 1e7;
  if (!(steps < kMostDabs)) {
    throw Error(ErrorKind::usage, fmt::format("the stroke has about {:.3g} dabs, more than {:.0e}; "
                                              "use a larger spacing or a shorter path",
                                              steps, kMostDabs));
  }
  const auto count = static_cast<std::size_t>(std::max(steps, 0.0)) + 1;
  plan_.dabs = count;
  if (swept) return;
  std::size_t segment = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double s =
        count > 1 ? length * static_cast<double>(i) / static_cast<double>(count - 1) : 0;
    while (segment + 2 < at.size() && at[segment + 1] < s) ++segment;
    const PathPoint& a = stroke_.path[segment];
    const PathPoint& b = stroke_.path[std::min(segment + 1, stroke_.path.size() - 1)];
    const double span = at.size() > 1 ? at[segment + 1] - at[segment] : 0;
    const double t = span > 0 ? std::min((s - at[segment]) / span, 1.0) : 0;
    Placement p;
    p.from = p.to = lattice_.to_index(glm::mix(a.at, b.at, t));
    p.pressure = glm::mix(a.pressure, b.pressure, t);
    p.radius_from = p.radius_to = stroke_.brush.shape ? radius_ : radius_ * p.pressure;
    plan_.placements.push_back(p);
  }
}

void Planner::mirror() {
  for (const MirrorPlane& plane : stroke_.mirror) {
    const int a = plane.axis;
    const double at = 2 * (plane.at - lattice_.origin[a]) / lattice_.voxel;
    const std::size_t count = plan_.placements.size();
    for (std::size_t i = 0; i < count; ++i) {
      Placement p = plan_.placements[i];
      p.from[a] = at - p.from[a];
      p.to[a] = at - p.to[a];
      p.flip[a] = -p.flip[a];
      plan_.placements.push_back(p);
    }
    plan_.dabs *= 2;
  }
}

void Planner::reach(const Placement& p, glm::dvec3& lo, glm::dvec3& hi) const {
  if (shape_ != nullptr) {
    const glm::dvec3 a = p.flip * shape_->bounds.lo / lattice_.voxel;
    const glm::dvec3 b = p.flip * shape_->bounds.hi / lattice_.voxel;
    lo = p.from + glm::min(a, b) - limits_.margin;
    hi = p.from + glm::max(a, b) + limits_.margin;
    return;
  }
  const double r = std::max(p.radius_from, p.radius_to) + limits_.margin;
  lo = glm::min(p.from, p.to) - r;
  hi = glm::max(p.from, p.to) + r;
}

void Planner::warn() {
  double smallest = radius_;
  for (const Placement& p : plan_.placements) {
    smallest = std::min({smallest, p.radius_from, p.radius_to});
    glm::dvec3 lo;
    glm::dvec3 hi;
    reach(p, lo, hi);
    for (int a = 0; a < 3; ++a) {
      if (lo[a] < limits_.range.lo[a] || hi[a] > limits_.range.hi[a]) plan_.clipped = true;
    }
  }
  if (smallest < 1) {
    plan_.warnings.push_back(
        fmt::format("the brush's radius is {:.3g} voxel; below one voxel a brush leaves little or "
                    "no trace between the samples",
                    smallest));
  }
  if (plan_.clipped) {
    const glm::dvec3 lo = lattice_.to_world(limits_.range.lo);
    const glm::dvec3 hi = lattice_.to_world(limits_.range.hi);
    plan_.warnings.push_back(fmt::format(
        "it reaches beyond the grid's range, {:.4g} {:.4g} {:.4g} to {:.4g} {:.4g} {:.4g}, and was "
        "cut off there",
        lo.x, lo.y, lo.z, hi.x, hi.y, hi.z));
  }
}

void Planner::check_size() const {
  double bricks = 0;
  glm::dvec3 lo(1e300);
  glm::dvec3 hi(-1e300);
  const auto bricks_of = [](const glm::dvec3& samples) {
    const glm::dvec3 size = samples / 8.0 + 2.0;
    return size.x * size.y * size.z;
  };
  for (const Placement& p : plan_.placements) {
    glm::dvec3 from;
    glm::dvec3 to;
    reach(p, from, to);
    lo = glm::min(lo, from);
    hi = glm::max(hi, to);
    const double r = std::max(p.radius_from, p.radius_to) + limits_.margin + kHalfDiagonal;
    bricks += shape_ != nullptr
                  ? bricks_of(to - from)
                  : (4.18879 * r * r * r + 3.14159 * r * r * glm::length(p.to - p.from)) / 512;
  }
  const double most = std::min(bricks, bricks_of(hi - lo));  // dabs overlap
  if (most <= limits_.max_bricks) return;
  throw Error(ErrorKind::usage,
              fmt::format("a stroke of radius {:.3g} voxels would touch about {:.2g} bricks "
                          "({:.2g} GB), more than {:.2g}; use a smaller brush or a coarser grid",
                          radius_, most, most * kBytesPerBrick * 1e-9, limits_.max_bricks));
}

// Bricks as one number, in the order x, y, z.
constexpr int kKeyBits = 21;
constexpr int kKeyOffset = 1 << (kKeyBits - 1);
std::uint64_t key_of(const glm::ivec3& b) {
  return (static_cast<std::uint64_t>(b.x + kKeyOffset) << 2 * kKeyBits) |
         (static_cast<std::uint64_t>(b.y + kKeyOffset) << kKeyBits) |
         static_cast<std::uint64_t>(b.z + kKeyOffset);
}

void Planner::find_bricks() {
  struct Pair {
    std::uint64_t key;
    std::uint32_t placement;
    glm::ivec3 brick;
  };
  std::vector<Pair> pairs;
  const glm::ivec3 first = limits_.range.lo >> 3;
  const glm::ivec3 last = limits_.range.hi >> 3;
  for (std::uint32_t i = 0; i < plan_.placements.size(); ++i) {
    const Placement& p = plan_.placements[i];
    glm::dvec3 from;
    glm::dvec3 to;
    reach(p, from, to);
    const double r = std::max(p.radius_from, p.radius_to) + limits_.margin + kHalfDiagonal;
    const glm::ivec3 lo =
        glm::max(first, glm::ivec3(glm::clamp(glm::floor(from / 8.0), -1e6, 1e6)));
    const glm::ivec3 hi = glm::min(last, glm::ivec3(glm::clamp(glm::floor(to / 8.0), -1e6, 1e6)));
    for (int x = lo.x; x <= hi.x; ++x) {
      for (int y = lo.y; y <= hi.y; ++y) {
        for (int z = lo.z; z <= hi.z; ++z) {
          const glm::dvec3 middle = 8.0 * glm::dvec3(x, y, z) + 3.5;
          if (shape_ == nullptr && distance_to_segment(middle, p.from, p.to) > r) continue;
          pairs.push_back({key_of({x, y, z}), i, {x, y, z}});
        }
      }
    }
  }
  if (plan_.placements.size() > 1) {
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
      return a.key != b.key ? a.key < b.key : a.placement < b.placement;
    });
  }
  plan_.reaching.reserve(pairs.size());
  for (const Pair& pair : pairs) {
    const auto at = static_cast<std::uint32_t>(plan_.reaching.size());
    if (plan_.bricks.empty() || plan_.bricks.back().brick != pair.brick) {
      plan_.bricks.push_back({pair.brick, at, at, false});
    }
    PlannedBrick& brick = plan_.bricks.back();
    if (at > brick.begin && !continues(plan_.reaching.back(), pair.placement)) {
      brick.overlapping = true;
    }
    plan_.reaching.push_back(pair.placement);
    brick.end = at + 1;
  }
}

// Whether a swept ball goes on from one placement to the other with hardly a bend, so that the
// lesser of their distances is right to a quarter of a percent inside, too.
bool Planner::continues(std::uint32_t first, std::uint32_t second) const {
  const Placement& a = plan_.placements[first];
  const Placement& b = plan_.placements[second];
  if (second != first + 1 || a.to != b.from) return false;
  const glm::dvec3 u = a.to - a.from;
  const glm::dvec3 v = b.to - b.from;
  const double lengths = glm::length(u) * glm::length(v);
  constexpr double kHardlyBent = 0.99;  // cosine of 8 degrees
  const double growth = (a.radius_to - a.radius_from) * glm::length(v) -
                        (b.radius_to - b.radius_from) * glm::length(u);
  return glm::dot(u, v) >= kHardlyBent * lengths && std::abs(growth) <= 0.1 * lengths;
}

}  // namespace

double distance_to_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 e = b - a;
  const double l2 = glm::dot(e, e);
  const double t = l2 > 0 ? std::clamp(glm::dot(p - a, e) / l2, 0.0, 1.0) : 0.0;
  return glm::length(p - a - t * e);
}

StrokePlan plan_stroke(const Stroke& stroke, const Lattice& lattice, const PlanLimits& limits) {
  check_stroke(stroke);
  return Planner(stroke, lattice, limits).plan();
}

}  // namespace sdfgrid
