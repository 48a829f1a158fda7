#include "sdfgrid/trace/field_march.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sdfgrid {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kShortProgram = 12;        // pruning more gains nothing
constexpr std::size_t kMostInstructions = 1000;  // more is too much to look at a whole stretch
// For fewer groups to prune again costs more than it gains, where their way is longer than they are
// wide apart, and where it is not.
constexpr int kFewAlong = 16;
constexpr int kFewAcross = 64;
// A beam ends where less than this share of its radius is free: single rays are faster from there.
constexpr float kShare = 0.5F;
constexpr auto kNoRay = static_cast<std::uint32_t>(-1);  // of a lane that is empty

Box box_of(const double (&lo)[3], const double (&hi)[3]) {
  return {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
}

// How far before them places may be counted from: then they are rounded no more than coordinates
// are.
double grain_of(double coordinate) { return std::ldexp(1.0, std::ilogb(coordinate + 1e-30) + 1); }

}  // namespace

double reach(const Box& box) {
  double far = 0;
  for (int a = 0; a < 3; ++a) far = std::max({far, std::fabs(box.lo[a]), std::fabs(box.hi[a])});
  return far;
}

Span clip(const Ray& ray, const Box& box) {
  Span s{0, kInfinity};
  for (int a = 0; a < 3; ++a) {
    const double inverse = 1 / ray.direction[a];
    double t0 = (box.lo[a] - ray.origin[a]) * inverse;
    double t1 = (box.hi[a] - ray.origin[a]) * inverse;
    if (t0 > t1) std::swap(t0, t1);
    if (std::isnan(t0) || std::isnan(t1)) continue;  // runs in the plane of a face
    s.from = std::max(s.from, t0);
    s.to = std::min(s.to, t1);
  }
  return s;
}

void Bundle::reset(std::size_t count) {
  size = count;
  rays.resize((count + RayLanes::kLanes - 1) / RayLanes::kLanes);
  depth.assign(rays.size() * RayLanes::kLanes, kInfinity);
  steps.assign(depth.size(), 0);
}

void Bundle::set(std::span<const Ray> of) {
  reset(of.size());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const Ray& ray = of[std::min(i, size - 1)];
    RayLanes& group = rays[i / RayLanes::kLanes];
    for (int a = 0; a < 3; ++a) {
      group.start[a][i % RayLanes::kLanes] = ray.origin[a];
      group.along[a][i % RayLanes::kLanes] = ray.direction[a];
    }
  }
}

void FieldMarch::reset(Bundle& bundle, const MarchRules& rules, std::size_t groups) {
  bundle_ = &bundle;
  rules_ = rules;
  if (rays_.size() < groups) rays_.resize(groups);
  if (beams_.size() < groups / kLanes + 1) {
    beams_.resize(groups / kLanes + 1);
    axes_.resize(beams_.size());
    for (std::size_t i = 0; i < beams_.size(); ++i) beams_[i].rays = &axes_[i];
  }
  groups_in_use_ = 0;
  clear_.resize(beams_.size() * kLanes);
  end_.resize(beams_.size() * kLanes);
  ray_of_.clear();
}

void FieldMarch::run(Bundle& bundle, const Field& field, const MarchRules& rules,
                     std::span<const Stretch> stretches) {
  const std::size_t groups = (stretches.size() + kLanes - 1) / kLanes;
  reset(bundle, rules, groups);
  if (packed_.size() < groups) packed_.resize(groups);
  packed_depth_.assign(groups * kLanes, kInfinity);
  if (groups > 0) {
    const glm::dvec3 p = beginning(stretches.front());
    grain_ = grain_of(reach({p, p}));
  }
  for (std::size_t i = 0; i < stretches.size(); i += kLanes) {
    add_group(stretches.subspan(i, std::min<std::size_t>(kLanes, stretches.size() - i)));
  }
  run(field);
}

void FieldMarch::run(Bundle& bundle, const Field& field, const MarchRules& rules, const Box& box) {
  reset(bundle, rules, bundle.rays.size());
  double from[kLanes];
  double to[kLanes];
  grain_ = grain_of(reach(box));
  double* depth = bundle.depth.data();
  for (const RayLanes& rays : bundle.rays) {
    kernel_.clip(rays, &box.lo.x, &box.hi.x, from, to);
    begin(rays, depth, from, to);
    depth += kLanes;
  }
  run(field);
}

void FieldMarch::run(const Field& field) {
  Part all{0, static_cast<std::uint32_t>(groups_in_use_), kInfinity, 0};
  for (std::size_t i = 0; i < groups_in_use_; ++i) {
    all.t0 = std::min(all.t0, clear_[i]);
    all.t1 = std::max(all.t1, end_[i]);
  }
  if (!(all.t0 < all.t1)) return;
  if (rules_.prune && field.size() > kShortProgram) {
    march(field, all);
  } else {
    trace(field, all, grain_);
  }
  finish();
}

// A beam's evaluations are shared out among its rays.
void FieldMarch::finish() {
  for (std::size_t group = 0; group < groups_in_use_; ++group) {
    const int led = beams_[group / kLanes].steps[group % kLanes];
    const int shared = (led + kLanes / 2) / kLanes;
    const std::int32_t* const steps = rays_[group].steps;
    const std::size_t first = group * kLanes;
    if (ray_of_.empty()) {
      for (int i = 0; i < kLanes; ++i) {
        bundle_->steps[first + i] += static_cast<std::uint32_t>(steps[i] + shared);
      }
      continue;
    }
    for (int i = 0; i < kLanes; ++i) {
      const std::uint32_t ray = ray_of_[first + i];
      if (ray == kNoRay) break;
      bundle_->steps[ray] += static_cast<std::uint32_t>(steps[i] + shared);
      bundle_->depth[ray] = std::min(bundle_->depth[ray], packed_depth_[first + i]);
    }
  }
}

// Where a stretch begins.
glm::dvec3 FieldMarch::beginning(const Stretch& stretch) const {
  const RayLanes& lanes = bundle_->rays[stretch.ray / kLanes];
  const std::size_t i = stretch.ray % kLanes;
  glm::dvec3 p;
  for (int a = 0; a < 3; ++a) p[a] = lanes.start[a][i] + stretch.from * lanes.along[a][i];
  return p;
}

// At most sixteen.
void FieldMarch::add_group(std::span<const Stretch> stretches) {
  const std::size_t n = stretches.size();
  double from[kLanes];
  double to[kLanes];
  RayLanes& rays = packed_[groups_in_use_];
  for (std::size_t i = 0; i < kLanes; ++i) {
    const Stretch& s = stretches[std::min(i, n - 1)];
    ray_of_.push_back(i < n ? s.ray : kNoRay);
    from[i] = s.from;
    to[i] = i < n ? std::min(s.to, bundle_->depth[s.ray]) : -kInfinity;
    const RayLanes& lanes = bundle_->rays[s.ray / kLanes];
    for (int a = 0; a < 3; ++a) {
      rays.start[a][i] = lanes.start[a][s.ray % kLanes];
      rays.along[a][i] = lanes.along[a][s.ray % kLanes];
    }
  }
  begin(rays, packed_depth_.data() + groups_in_use_ * kLanes, from, to);
}

// The next group sets out.
void FieldMarch::begin(const RayLanes& rays, double* depth, const double* from, const double* to) {
  const std::size_t group = groups_in_use_++;
  rays_[group].rays = &rays;
  rays_[group].depth = depth;
  const GroupWay way = kernel_.begin(rays_[group], from, to, grain_);
  clear_[group] = way.clear;
  end_[group] = way.end;
  kernel_.beam(rays, axes_[group / kLanes], beams_[group / kLanes],
               static_cast<int>(group % kLanes));
}

// Brings all rays of the part to its end or to their hit. All of them are free up to its beginning.
// What is pruned for it serves its halves, along the rays or across them, whichever is longer.
void FieldMarch::march(const Field& field, const Part& part) {
  const GroupRoom room =
      kernel_.room(beams_.data(), clear_.data(), end_.data(), static_cast<int>(part.begin),
                   static_cast<int>(part.end), part.t0, part.t1);
  if (room.groups == 0) return;
  const Box all = box_of(room.lo, room.hi);
  const double error = 2 * kFieldSlack * reach(all);
  const Box box = {all.lo - error, all.hi + error};
  const double length = part.t1 - part.t0;
  const glm::dvec3 across = box_of(room.far_lo, room.far_hi).size();
  const bool along = length > std::max({across.x, across.y, across.z});
  const bool single = part.end - part.begin == 1;
  const bool few =
      room.groups <= (along ? kFewAlong : kFewAcross) && field.size() <= kMostInstructions;
  const bool last = few || (along ? length < 1e-3 * part.t1 : single);
  const auto here = field.restricted(box, last ? kAnyLength : kMostInstructions);
  if (here) {
    const double nearest = rules_.sign > 0 ? here->range.lo : -here->range.hi;
    // All jump: whatever comes next starts at its end.
    if (nearest > 2 * rules_.tolerance * part.t1 + error) return;
    if (last || here->field.size() <= kShortProgram) {
      return trace(here->field, part, grain_of(reach(box)));
    }
  }
  const Field left = here ? here->field : field;
  Part first = part;
  Part second = part;
  if (along || single) {
    first.t1 = second.t0 = 0.5 * (part.t0 + part.t1);
  } else {
    first.end = second.begin = part.begin + (part.end - part.begin) / 2;
  }
  march(left, first);
  march(left, second);
}

// Steps of all rays of a part, from its beginning, up to where they are free, to its end. Places
// are counted from at most a grain before it, and from where they were if that will do.
void FieldMarch::trace(const Field& field, const Part& part, double grain) {
  const auto [begin, end, t0, t1] = part;
  groups_.clear();
  for (std::uint32_t i = begin; i < end; ++i) {
    if (clear_[i] < t1 && t0 < end_[i]) groups_.push_back(i);
  }
  if (groups_.empty()) return;
  double base = rays_[groups_.front()].base;
  if (!(base <= t0 && t0 - base <= grain)) base = grain * std::floor(t0 / grain);
  kernel_.rebase(rays_.data(), groups_.data(), static_cast<int>(groups_.size()), base);
  StepRule rule{rules_.sign,
                static_cast<float>(rules_.tolerance),
                static_cast<float>(rules_.tolerance * base),
                0,
                static_cast<float>(t1 - base),
                rules_.relax,
                rules_.convex};
  from_.assign(groups_.size(), static_cast<float>(t0 - base));
  if (rules_.beams && bundle_->size >= kLanes) lead(field, base, rule);  // one ray is its own beam
  list_ = groups_;
  steps(field, rays_, list_, rule, from_.data());
  for (const std::uint32_t i : groups_) {
    const GroupWay rest = kernel_.collect(rays_[i]);
    clear_[i] = rest.clear;
    end_[i] = rest.end;
  }
}

// How far the beams of the groups come: from_, of each group, which is where they begin at least.
void FieldMarch::lead(const Field& field, double base, StepRule rule) {
  beam_list_.clear();
  for (const std::uint32_t i : groups_) {
    const std::uint32_t b = i / kLanes;
    if (!beam_list_.empty() && beam_list_.back() == b) continue;
    beam_list_.push_back(b);
    std::fill_n(beams_[b].end, kLanes, RayGroup::kNever);
  }
  kernel_.rebase(beams_.data(), beam_list_.data(), static_cast<int>(beam_list_.size()), base);
  for (std::size_t k = 0; k < groups_.size(); ++k) {
    const std::uint32_t i = groups_[k];
    RayGroup& beam = beams_[i / kLanes];
    const std::uint32_t lane = i % kLanes;
    beam.clear[lane] = beam.next[lane] = std::max(static_cast<float>(clear_[i] - base), from_[k]);
    beam.end[lane] = static_cast<float>(end_[i] - base);
    beam.last[lane] = RayGroup::kNever;
    beam.slope[lane] = -1;
    beam.hit[lane] = RayGroup::kNotHit;
  }
  rule.convex = false;
  rule.share = kShare;
  starts_.assign(beam_list_.size(), from_.front());
  steps(field, beams_, beam_list_, rule, starts_.data());
  for (std::size_t k = 0; k < groups_.size(); ++k) {
    const RayGroup& beam = beams_[groups_[k] / kLanes];
    const std::uint32_t lane = groups_[k] % kLanes;
    from_[k] = std::min(beam.clear[lane], beam.hit[lane]);
  }
}

// Until all groups of the list have arrived at the limit.
void FieldMarch::steps(const Field& field, std::vector<RayGroup>& groups,
                       std::vector<std::uint32_t>& list, const StepRule& rule, const float* from) {
  const std::size_t column = list.size() * kLanes;
  columns_.resize(4 * list.size());
  float* const first = columns_.data()->lanes;
  float* const p[3] = {first, first + column, first + 2 * column};
  float* const values = first + 3 * column;
  int n =
      kernel_.place(groups.data(), list.data(), static_cast<int>(list.size()), from, rule.limit, p);
  while (n > 0) {
    field.evaluate(std::size_t(n) * kLanes, p[0], p[1], p[2], values);
    FreeWays ways{};
    if (rules_.bounds != nullptr && rule.share == 0) {
      ways = ways_of({list.data(), std::size_t(n)}, rule, values);
    }
    n = kernel_.step(groups.data(), list.data(), n, rule, values, ways, p);
  }
}

// How far the way is free around where rays are evaluated next, with the values there: through as
// many cells as LocalBounds follows a ray, each with its slope.
FreeWays FieldMarch::ways_of(std::span<const std::uint32_t> list, const StepRule& rule,
                             const float* values) {
  const std::size_t column = list.size() * kLanes;
  ways_.resize(3 * column);
  float* const ahead = ways_.data();
  float* const surface = ahead + column;
  float* const back = surface + column;
  for (std::size_t k = 0; k < column; ++k) {
    const RayGroup& g = rays_[list[k / kLanes]];
    const std::size_t i = k % kLanes;
    ahead[k] = surface[k] = back[k] = std::fabs(values[k]);
    if (!(g.clear[i] < std::min(g.end[i], rule.limit))) continue;
    const glm::dvec3 along(g.rays->along[0][i], g.rays->along[1][i], g.rays->along[2][i]);
    const glm::dvec3 start(g.rays->start[0][i], g.rays->start[1][i], g.rays->start[2][i]);
    const glm::dvec3 p = start + (g.base + double(g.next[i])) * along;
    const LocalBounds::Free free = rules_.bounds->free(p, along, double(ahead[k]));
    ahead[k] = static_cast<float>(free.ahead);
    surface[k] = static_cast<float>(free.surface);
    back[k] = static_cast<float>(free.back);
  }
  return {ahead, surface, back};
}

}  // namespace sdfgrid
