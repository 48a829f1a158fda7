#include "sdfgrid/trace/field_march.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sdfgrid {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kMostSteps = 5000;
constexpr double kMomentum = 0.3;         // how much of a step's slope goes into the next one's
constexpr std::size_t kShortProgram = 8;  // pruning more gains nothing

double largest(const glm::dvec3& v) {
  return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

}  // namespace

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

Bundle::Bundle(std::span<const Ray> of)
    : rays(of), depth(of.size(), kInfinity), steps(of.size(), 0) {}

void FieldMarch::run(const Field& field, const MarchRules& rules,
                     std::span<const Stretch> stretches) {
  rules_ = rules;
  states_.clear();
  double from = kInfinity;
  double to = 0;
  for (const Stretch& stretch : stretches) {
    const double end = std::min(stretch.to, bundle_.depth[stretch.ray]);
    if (!(stretch.from < end)) continue;
    State& s = states_.emplace_back();
    s.ray = stretch.ray;
    s.clear = s.next = stretch.from;
    s.end = end;
    from = std::min(from, stretch.from);
    to = std::max(to, end);
  }
  if (states_.empty()) return;
  if (rules.prune && field.size() > kShortProgram) {
    march(field, from, to);
  } else {
    trace(field, to);
  }
  for (const State& s : states_) bundle_.steps[s.ray] += static_cast<std::uint32_t>(s.steps);
}

// The box of all rays from t0 to t1; those that are done count no more.
Box FieldMarch::box_of(double t0, double t1) const {
  Box box;
  for (const State& s : states_) {
    if (s.done || s.clear >= t1) continue;
    const Ray& ray = bundle_.rays[s.ray];
    box.add(ray.origin + std::max(t0, s.clear) * ray.direction);
    box.add(ray.origin + std::min(t1, s.end) * ray.direction);
  }
  if (box.empty()) return box;
  const double slack = kFieldSlack * (largest(box.lo) + largest(box.hi));
  return {box.lo - slack, box.hi + slack};
}

// Brings all rays to t1 or to their hit. All of them are free up to t0.
void FieldMarch::march(const Field& field, double t0, double t1) {
  const Box box = box_of(t0, t1);
  if (box.empty()) return;
  constexpr std::size_t kMostInstructions = 1000;  // more is too much to look at a whole stretch
  // Shorter stretches than the bundle is wide cost more than they gain.
  const glm::dvec3 size = box.size();
  const double across = size.x + size.y + size.z - (t1 - t0);
  const bool last = t1 - t0 < std::max(2 * across, 1e-3 * t1);
  const auto here = field.restricted(box, last ? kAnyLength : kMostInstructions);
  if (here) {
    const double nearest = rules_.sign > 0 ? here->range.lo : -here->range.hi;
    if (nearest > 2 * rules_.tolerance * t1 + kFieldSlack * (largest(box.lo) + largest(box.hi))) {
      return jump(t1);
    }
    if (last || here->field.size() <= kShortProgram) return trace(here->field, t1);
  }
  const Field left = here ? here->field : field;
  const double middle = 0.5 * (t0 + t1);
  march(left, t0, middle);
  march(left, middle, t1);
}

void FieldMarch::jump(double t1) {
  for (State& s : states_) {
    if (s.done || s.clear >= t1) continue;
    s.clear = s.next = t1;
    s.relaxed = s.known = false;
    s.done = t1 >= s.end;
  }
}

// Steps of all rays before t1, a batch a time.
void FieldMarch::trace(const Field& field, double t1) {
  active_.clear();
  for (std::size_t i = 0; i < states_.size(); ++i) {
    State& s = states_[i];
    s.next = std::max(s.clear, std::min(s.next, t1));
    if (!s.done && s.clear < t1) active_.push_back(static_cast<std::uint32_t>(i));
  }
  while (!active_.empty()) {
    columns_.resize(4 * active_.size());
    const std::size_t n = active_.size();
    float* const x = columns_.data();
    for (std::size_t k = 0; k < n; ++k) {
      const State& s = states_[active_[k]];
      const Ray& ray = bundle_.rays[s.ray];
      const glm::dvec3 p = ray.origin + s.next * ray.direction;
      for (int a = 0; a < 3; ++a) x[a * n + k] = static_cast<float>(p[a]);
    }
    field.evaluate(n, x, x + n, x + 2 * n, x + 3 * n);
    std::size_t left = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const float far = std::max({std::fabs(x[k]), std::fabs(x[n + k]), std::fabs(x[2 * n + k])});
      State& s = states_[active_[k]];
      step(s, double(rules_.sign) * double(x[3 * n + k]), kFieldSlack * double(far), t1);
      if (!s.done && s.clear < t1) active_[left++] = active_[k];
    }
    active_.resize(left);
  }
}

// How far the way is free from t on, ahead or back, where the field's value is `r`: not beyond the
// cell in which the slope holds, though the surface may be farther.
FieldMarch::Free FieldMarch::free_way(const Ray& ray, double t, double r, double direction) const {
  const double reach = std::fabs(r);
  if (rules_.bounds == nullptr) return {reach, reach};
  const glm::dvec3 p = ray.origin + t * ray.direction;
  const LocalBounds::Cell cell = rules_.bounds->at(p);
  if (!(cell.slope < 1)) return {reach, reach};
  const double leaves = clip({p, direction * ray.direction}, cell.box).to;
  const double surface = reach / cell.slope;
  return {std::max(reach, std::min(surface, leaves)), surface};
}

// Whether a relaxed step to s.next must be taken back: the way between is free if what both of its
// ends know of it meets.
bool FieldMarch::taken_back(State& s, double r) const {
  if (r >= 0 && s.next - free_way(bundle_.rays[s.ray], s.next, r, -1).way <= s.clear) return false;
  s.next = s.clear;
  s.slope = -1;
  s.relaxed = false;
  return true;
}

// How far the way ahead of s.next is free. A convex function lies above the line through two of its
// values, beyond them: infinite if that does not fall.
FieldMarch::Free FieldMarch::ahead_of(const State& s, double r, double error) const {
  const Free ahead = free_way(bundle_.rays[s.ray], s.next, r, 1);
  if (!rules_.convex || !s.known) return ahead;
  const double fall = (s.value - r + 2 * error) / (s.next - s.last);
  const double above = fall > 0 ? (r - error) / fall : kInfinity;
  return {std::max(ahead.way, above), std::max(ahead.surface, above)};
}

// Takes in that the field is `r` at s.next.
void FieldMarch::step(State& s, double r, double error, double t1) {
  ++s.steps;
  const double t = s.next;
  if (s.relaxed && t > s.clear && taken_back(s, r)) return;
  const Free known = ahead_of(s, r, error);
  const double ahead = std::max(known.way, 0.5 * error);
  if (r < 0 || known.surface < rules_.tolerance * t + error) {
    double& depth = bundle_.depth[s.ray];
    depth = std::min(depth, r < 0 ? t : t + ahead);
    s.done = true;
    return;
  }
  s.clear = t + ahead;
  double next = s.clear;
  if (rules_.relax && !rules_.convex) {
    if (s.known && s.relaxed) {
      const double slope = (r - s.value) / (t - s.last);
      s.slope += kMomentum * (std::clamp(slope, -1.0, 0.99) - s.slope);
    }
    next = t + 2 * ahead / (1 - s.slope);
    s.relaxed = true;
  }
  // Beyond t1 this program does not hold, beyond the end no local bound: only what is certain goes
  // there.
  s.next = std::max(s.clear, std::min(next, std::min(t1, s.end)));
  s.last = t;
  s.value = r;
  s.known = true;
  s.done = s.clear >= s.end || s.steps >= kMostSteps;
}

}  // namespace sdfgrid
