#include "sdfgrid/edit/stroke_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/paint.h"

namespace sdfgrid {
namespace {

constexpr double kHalfDiagonal = 6.0621778;  // from a brick's middle to its corner samples, voxels
constexpr double kBytesPerBrick = 2200;
// Beyond that single precision holds a distance to the brush to less than 0.01 voxel.
constexpr double kLargestRadius = 1e5;  // voxels
constexpr std::size_t kMostDabs = 10'000'000;
constexpr std::size_t kMostImages = 1 << 12;  // of the path, by mirrors
constexpr double kFarthest = 1e9;             // voxels from the grid's origin that a place may be

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
  for (const MirrorPlane& plane : stroke.mirror) {
    check_number(std::isfinite(plane.at), "the place of a mirror must be finite; one", plane.at);
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
  bool same(const Placement& a, const Placement& b) const;
  void add_images(const std::vector<Placement>& images);
  void warn();
  struct Reach {
    double all, in_range;  // bricks
  };
  Reach reached() const;
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
    p.radius_from = p.radius_to = radius_ * p.pressure;
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
// swept ball, which needs none, they are only counted.
void Planner::place_dabs(bool swept) {
  double length = 0;
  std::vector<double> at = {0.0};
  for (std::size_t i = 1; i < stroke_.path.size(); ++i) {
    length += glm::length(stroke_.path[i].at - stroke_.path[i - 1].at) / lattice_.voxel;
    at.push_back(length);
  }
  const double steps = std::ceil(length / (stroke_.spacing * radius_) - 1e-9);
  if (swept) {
    plan_.dabs = static_cast<std::size_t>(std::clamp(steps, 0.0, 1e15)) + 1;
    return;
  }
  if (!(steps < double(kMostDabs))) {
    throw Error(ErrorKind::usage, fmt::format("the stroke has about {:.3g} dabs, more than {:.0e}; "
                                              "use a larger spacing or a shorter path",
                                              steps, double(kMostDabs)));
  }
  const auto count = static_cast<std::size_t>(std::max(steps, 0.0)) + 1;
  plan_.dabs = count;
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
    p.radius_from = p.radius_to = radius_ * p.pressure;
    plan_.placements.push_back(p);
  }
}

// Whether two places hold the same balls; of shapes whether they are the same, too.
bool Planner::same(const Placement& a, const Placement& b) const {
  constexpr double kSame = 1e-6;  // voxels
  const auto near = [](const glm::dvec3& p, const glm::dvec3& q) {
    return glm::length(p - q) <= kSame;
  };
  if (shape_ != nullptr && a.flip != b.flip) return false;
  if (a.pressure != b.pressure) return false;
  const bool there = near(a.from, b.from) && near(a.to, b.to) && a.radius_from == b.radius_from &&
                     a.radius_to == b.radius_to;
  const bool back = near(a.from, b.to) && near(a.to, b.from) && a.radius_from == b.radius_to &&
                    a.radius_to == b.radius_from;
  return there || back;
}

// Adds those that are not there yet: a dab on its own mirror plane acts once.
void Planner::add_images(const std::vector<Placement>& images) {
  // By one number that equal places share to rounding.
  const auto key = [](const Placement& p) {
    return glm::dot(p.from + p.to, glm::dvec3(0.531, 0.707, 0.467));
  };
  std::vector<std::pair<double, std::size_t>> there;
  for (std::size_t i = 0; i < plan_.placements.size(); ++i) {
    there.emplace_back(key(plan_.placements[i]), i);
  }
  std::sort(there.begin(), there.end());
  for (const Placement& image : images) {
    constexpr double kRounding = 1e-5;
    const double at = key(image);
    bool found = false;
    for (auto i = std::lower_bound(there.begin(), there.end(),
                                   std::pair(at - kRounding, std::size_t{0}));
         !found && i != there.end() && i->first <= at + kRounding; ++i) {
      found = same(plan_.placements[i->second], image);
    }
    if (!found) plan_.placements.push_back(image);
  }
}

void Planner::mirror() {
  plan_.starts = {plan_.placements.front().from};
  const std::size_t single = plan_.placements.size();
  for (const MirrorPlane& plane : stroke_.mirror) {
    const int a = plane.axis;
    const double at = 2 * (plane.at - lattice_.origin[a]) / lattice_.voxel;
    const auto count = static_cast<std::uint32_t>(plan_.starts.size());
    for (std::uint32_t i = 0; i < count; ++i) {
      glm::dvec3 start = plan_.starts[i];
      start[a] = at - start[a];
      plan_.starts.push_back(start);
    }
    std::vector<Placement> images = plan_.placements;
    for (Placement& p : images) {
      p.from[a] = at - p.from[a];
      p.to[a] = at - p.to[a];
      p.flip[a] = -p.flip[a];
      p.image += count;
    }
    add_images(images);
    if (plan_.placements.size() <= kMostDabs && plan_.starts.size() <= kMostImages) continue;
    throw Error(ErrorKind::usage, "the mirrors repeat the stroke too often; use fewer of them");
  }
  plan_.dabs = plan_.dabs * plan_.placements.size() / single;
}

void Planner::reach(const Placement& p, glm::dvec3& lo, glm::dvec3& hi) const {
  if (shape_ != nullptr) {
    const glm::dvec3 scale = p.flip * (p.pressure / lattice_.voxel);
    const glm::dvec3 a = scale * shape_->bounds.lo;
    const glm::dvec3 b = scale * shape_->bounds.hi;
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
    const glm::dvec3 largest = glm::max(glm::abs(lo), glm::abs(hi)) / lattice_.voxel;
    const double voxels = std::max({largest.x, largest.y, largest.z, 1.0});
    // So many that neighbouring voxels do not look the same.
    const int digits = std::clamp(static_cast<int>(std::log10(voxels)) + 2, 4, 17);
    plan_.warnings.push_back(fmt::format(
        "it reaches beyond the grid's range, {1:.{0}g} {2:.{0}g} {3:.{0}g} to {4:.{0}g} {5:.{0}g} "
        "{6:.{0}g}, and was cut off there",
        digits, lo.x, lo.y, lo.z, hi.x, hi.y, hi.z));
  }
}

// About how many bricks the stroke reaches: all of them, and those in the range.
Planner::Reach Planner::reached() const {
  const auto bricks_of = [](const glm::dvec3& lo, const glm::dvec3& hi) {
    if (glm::any(glm::greaterThan(lo, hi))) return 0.0;
    const glm::dvec3 size = (hi - lo) / 8.0 + 2.0;
    return size.x * size.y * size.z;
  };
  const glm::dvec3 first(limits_.range.lo);
  const glm::dvec3 last(limits_.range.hi);
  glm::dvec3 lo(1e300);
  glm::dvec3 hi(-1e300);
  Reach sum{0, 0};
  for (const Placement& p : plan_.placements) {
    glm::dvec3 from;
    glm::dvec3 to;
    reach(p, from, to);
    lo = glm::min(lo, from);
    hi = glm::max(hi, to);
    const double r = std::max(p.radius_from, p.radius_to) + limits_.margin + kHalfDiagonal;
    const double all =
        shape_ != nullptr
            ? bricks_of(from, to)
            : (4.18879 * r * r * r + 3.14159 * r * r * glm::length(p.to - p.from)) / 512;
    sum.all += all;
    sum.in_range += std::min(all, bricks_of(glm::max(from, first), glm::min(to, last)));
  }
  // Dabs overlap.
  return {std::min(sum.all, bricks_of(lo, hi)),
          std::min(sum.in_range, bricks_of(glm::max(lo, first), glm::min(hi, last)))};
}

void Planner::check_size() const {
  for (const Placement& p : plan_.placements) {
    const glm::dvec3 far = glm::max(glm::abs(p.from), glm::abs(p.to));
    const double farthest = std::max({far.x, far.y, far.z});
    if (farthest <= kFarthest) continue;
    throw Error(ErrorKind::usage,
                fmt::format("a place of the brush is {:.2g} voxels from the grid's origin, more "
                            "than {:.0e}; bring the path, or the mirror, nearer to the model",
                            farthest, kFarthest));
  }
  const Reach reach = reached();
  const bool large = radius_ > kLargestRadius;
  if (!large && reach.in_range <= limits_.max_bricks) return;
  const double most = large ? reach.all : reach.in_range;
  throw Error(
      ErrorKind::usage,
      fmt::format(
          "a stroke of radius {:.3g} voxels would touch about {:.2g} bricks ({:.2g} GB), "
          "more than {:.2g}{}; use a smaller brush or a coarser grid",
          radius_, most, most * kBytesPerBrick * 1e-9, limits_.max_bricks,
          large ? fmt::format(", and brushes have at most {:.0e} voxels", kLargestRadius) : ""));
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
