#include "sdfgrid/trace/field_trace.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"

namespace sdfgrid {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kTile = 32;          // pixels a side of a bundle
constexpr int kBlock = 4 * kTile;  // of a square for which the program is pruned first
constexpr int kMostSteps = 5000;
constexpr double kMomentum = 0.3;         // how much of a step's slope goes into the next one's
constexpr double kFloatSlack = 1.5e-6;    // of a coordinate: what float evaluation may be off
constexpr std::size_t kShortProgram = 8;  // pruning more gains nothing

// Where the ray is in the box: from > to if it is not.
struct Span {
  double from, to;
};
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

double largest(const glm::dvec3& v) {
  return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

}  // namespace

// Rays on their way. Of each the way up to `clear` is known to be free; the field is evaluated next
// at `next`, which is more only if the step is relaxed.
class FieldTracer::Bundle {
 public:
  Bundle(const FieldTracer& tracer, std::span<const Ray> rays, double tolerance)
      : tracer_(tracer), rays_(rays), tolerance_(tolerance), states_(rays.size()) {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Span s = clip(rays[i], tracer.region_);
      State& state = states_[i];
      state.end = s.to;
      state.done = !(s.from < s.to);
      state.clear = state.next = s.from;
      if (state.done) continue;
      from_ = std::min(from_, s.from);
      to_ = std::max(to_, s.to);
    }
  }

  void run(const Field& field) {
    if (!(from_ < to_)) return;
    // Whether the rays start inside.
    const glm::vec3 start(rays_[0].origin);
    sign_ = field(start) < 0 ? -1.0F : 1.0F;
    march(field, from_, to_);
  }

  void results(std::span<float> depth, std::span<std::uint16_t> steps) const {
    for (std::size_t i = 0; i < states_.size(); ++i) {
      depth[i] = static_cast<float>(states_[i].hit);
      if (!steps.empty()) {
        steps[i] = static_cast<std::uint16_t>(std::min(states_[i].steps, 65535));
      }
    }
  }

 private:
  struct State {
    double clear = 0;
    double next = 0;
    double end = 0;
    double hit = kInfinity;
    double last = 0;    // where the field was evaluated last, and
    double value = 0;   // what it was there: only if `relaxed`
    double slope = -1;  // of the field along the ray, smoothed
    bool relaxed = false;
    bool done = false;
    int steps = 0;
  };

  // The box of all rays from t0 to t1; those that are done count no more.
  [[nodiscard]] Box box_of(double t0, double t1) const {
    Box box;
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      const State& s = states_[i];
      if (s.done || s.clear >= t1) continue;
      const Ray& ray = rays_[i];
      box.add(ray.origin + std::max(t0, s.clear) * ray.direction);
      box.add(ray.origin + std::min(t1, s.end) * ray.direction);
    }
    if (box.empty()) return box;
    const double slack = kFloatSlack * (largest(box.lo) + largest(box.hi));
    return {box.lo - slack, box.hi + slack};
  }

  // Brings all rays to t1 or to their hit. All of them are free up to t0.
  void march(const Field& field, double t0, double t1) {
    const Box box = box_of(t0, t1);
    if (box.empty()) return;
    if (!tracer_.options_.prune) return trace(field, t1);
    const ValueRange range = field.range(box);
    const double nearest = sign_ > 0 ? range.lo : -range.hi;
    if (nearest > 2 * tolerance_ * t1 + kFloatSlack * (largest(box.lo) + largest(box.hi))) {
      return jump(t1);
    }
    const Field here = field.pruned(box);
    // Shorter stretches than the bundle is wide cost more than they gain.
    const glm::dvec3 size = box.size();
    const double across = size.x + size.y + size.z - (t1 - t0);
    if (here.size() <= kShortProgram || t1 - t0 < std::max(2 * across, 1e-3 * t1)) {
      return trace(here, t1);
    }
    const double middle = 0.5 * (t0 + t1);
    march(here, t0, middle);
    march(here, middle, t1);
  }

  void jump(double t1) {
    for (State& s : states_) {
      if (s.done || s.clear >= t1) continue;
      s.clear = s.next = t1;
      s.relaxed = false;
      s.done = t1 >= s.end;
    }
  }

  // Steps of all rays before t1, a batch a time.
  void trace(const Field& field, double t1) {
    active_.clear();
    for (std::size_t i = 0; i < states_.size(); ++i) {
      State& s = states_[i];
      s.next = std::max(s.clear, std::min(s.next, t1));
      if (!s.done && s.clear < t1) active_.push_back(i);
    }
    while (!active_.empty()) {
      columns_.resize(4 * active_.size());
      const std::size_t n = active_.size();
      float* const x = columns_.data();
      for (std::size_t k = 0; k < n; ++k) {
        const Ray& ray = rays_[active_[k]];
        const glm::dvec3 p = ray.origin + states_[active_[k]].next * ray.direction;
        for (int a = 0; a < 3; ++a) x[a * n + k] = static_cast<float>(p[a]);
      }
      field.evaluate(n, x, x + n, x + 2 * n, x + 3 * n);
      std::size_t left = 0;
      for (std::size_t k = 0; k < n; ++k) {
        const std::size_t i = active_[k];
        step(rays_[i], states_[i], double(sign_) * double(x[3 * n + k]), t1);
        if (!states_[i].done && states_[i].clear < t1) active_[left++] = i;
      }
      active_.resize(left);
    }
  }

  // How far the way is free from t on, ahead or back, where the field's value is `r`.
  [[nodiscard]] double free_way(const Ray& ray, double t, double r, double direction) const {
    const double reach = std::fabs(r);
    if (tracer_.bounds_ == nullptr) return reach;
    const glm::dvec3 p = ray.origin + t * ray.direction;
    const LocalBounds::Cell cell = tracer_.bounds_->at(p);
    if (!(cell.slope < 1)) return reach;
    const double leaves = clip({p, direction * ray.direction}, cell.box).to;
    return std::max(reach, std::min(reach / cell.slope, leaves));
  }

  // Takes in that the field is `r` at s.next.
  void step(const Ray& ray, State& s, double r, double t1) const {
    ++s.steps;
    const double t = s.next;
    const double error = kFloatSlack * largest(ray.origin + t * ray.direction);
    if (s.relaxed && t > s.clear) {
      // The way between is free if what both ends know of it meets.
      if (r < 0 || t - free_way(ray, t, r, -1) > s.clear) {
        s.next = s.clear;
        s.slope = -1;
        s.relaxed = false;
        return;
      }
    }
    const double ahead = std::max(free_way(ray, t, r, 1), 0.5 * error);
    if (r < 0 || ahead < tolerance_ * t + error) {
      s.hit = r < 0 ? t : t + ahead;
      s.done = true;
      return;
    }
    if (s.relaxed) {
      const double slope = (r - s.value) / (t - s.last);
      s.slope += kMomentum * (std::clamp(slope, -1.0, 0.99) - s.slope);
    }
    s.clear = t + ahead;
    s.last = t;
    s.value = r;
    s.relaxed = tracer_.options_.relax;
    // Beyond t1 this program does not hold: only what is certain goes there.
    const double relaxed = tracer_.options_.relax ? t + 2 * ahead / (1 - s.slope) : s.clear;
    s.next = std::max(s.clear, std::min(relaxed, t1));
    s.done = s.clear >= s.end || s.steps >= kMostSteps;
  }

  const FieldTracer& tracer_;
  std::span<const Ray> rays_;
  double tolerance_;
  std::vector<State> states_;
  std::vector<std::size_t> active_;
  std::vector<float> columns_;
  float sign_ = 1;
  double from_ = kInfinity;
  double to_ = 0;
};

FieldTracer::FieldTracer(const Field& field, const Box& region, FieldTraceOptions options)
    : field_(field), region_(region), options_(options) {
  if (region.empty() || !std::isfinite(largest(region.lo)) || !std::isfinite(largest(region.hi))) {
    throw Error(ErrorKind::usage, "rays need a region with an end to be traced in");
  }
  if (!options.local_bounds) return;
  auto bounds = std::make_unique<LocalBounds>(field_, region_);
  // Worth their time only where the field is less steep than a distance.
  constexpr int kProbes = 8;
  bool gentle = false;
  for (int i = 0; i < kProbes * kProbes * kProbes && !gentle; ++i) {
    const glm::dvec3 at(i / (kProbes * kProbes), i / kProbes % kProbes, i % kProbes);
    gentle = bounds->at(region.lo + region.size() * (at + 0.5) / double(kProbes)).slope < 0.9;
  }
  if (gentle) bounds_ = std::move(bounds);
}

void FieldTracer::trace(std::span<const Ray> rays, double tolerance, std::span<float> depth,
                        std::span<std::uint16_t> steps) const {
  constexpr std::size_t kBundle = std::size_t{kTile} * kTile;
  for (std::size_t i = 0; i < rays.size(); i += kBundle) {
    const std::size_t n = std::min(kBundle, rays.size() - i);
    Bundle bundle(*this, rays.subspan(i, n), tolerance);
    bundle.run(field_);
    bundle.results(depth.subspan(i, n), steps.empty() ? steps : steps.subspan(i, n));
  }
}

namespace {

std::vector<Ray> rays_of(const RayGenerator& generator, const PixelSquare& square) {
  std::vector<Ray> rays;
  for (int y = 0; y < square.height; ++y) {
    for (int x = 0; x < square.width; ++x) {
      rays.push_back(generator.ray(square.x + x + 0.5, square.y + y + 0.5));
    }
  }
  return rays;
}

}  // namespace

// A box around all of the region that is seen through a square of pixels.
Box FieldTracer::seen_through(const RayGenerator& generator, const glm::dvec3& eye,
                              const PixelSquare& square) const {
  const glm::dvec3 farthest = glm::max(glm::abs(region_.lo - eye), glm::abs(region_.hi - eye));
  Box box;
  box.add(eye);
  for (const int x : {square.x, square.x + square.width}) {
    for (const int y : {square.y, square.y + square.height}) {
      // These are one unit deep, so that all points between them are in the box.
      const glm::dvec3 through =
          generator.corner() + double(x) * generator.right() + double(y) * generator.down();
      box.add(eye + 1.01 * glm::length(farthest) * through);
    }
  }
  const double slack = kFloatSlack * (largest(region_.lo) + largest(region_.hi));
  box.lo = glm::max(box.lo, region_.lo) - slack;
  box.hi = glm::min(box.hi, region_.hi) + slack;
  return box;
}

HitBuffer FieldTracer::trace_primary(const Camera& camera, const Job& job) const {
  HitBuffer hits;
  hits.width = camera.width;
  hits.height = camera.height;
  const auto pixels = static_cast<std::size_t>(camera.width) * camera.height;
  hits.depth.assign(pixels, std::numeric_limits<float>::infinity());
  hits.steps.assign(pixels, 0);
  const RayGenerator generator(camera);
  const double tolerance = 0.02 * glm::length(generator.right());
  const auto tile = [&](const Field& field, const PixelSquare& square) {
    const std::vector<Ray> rays = rays_of(generator, square);
    std::vector<float> depth(rays.size());
    std::vector<std::uint16_t> steps(rays.size());
    Bundle bundle(*this, rays, tolerance);
    bundle.run(field);
    bundle.results(depth, steps);
    for (int y = 0; y < square.height; ++y) {
      const std::size_t row = std::size_t(square.y + y) * camera.width + square.x;
      std::copy_n(depth.begin() + y * square.width, square.width, hits.depth.begin() + row);
      std::copy_n(steps.begin() + y * square.width, square.width, hits.steps.begin() + row);
    }
  };
  const int across = (camera.width + kBlock - 1) / kBlock;
  const int down = (camera.height + kBlock - 1) / kBlock;
  parallel_for(std::size_t(across) * down, 1, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int left = static_cast<int>(i % across) * kBlock;
      const int top = static_cast<int>(i / across) * kBlock;
      const int right = std::min(left + kBlock, camera.width);
      const int bottom = std::min(top + kBlock, camera.height);
      const Box box = seen_through(generator, camera.eye, {left, top, right - left, bottom - top});
      const Field here = options_.prune ? field_.pruned(box) : field_;
      for (int y = top; y < bottom; y += kTile) {
        job.checkpoint();
        for (int x = left; x < right; x += kTile) {
          tile(here, {x, y, std::min(kTile, right - x), std::min(kTile, bottom - y)});
        }
      }
    }
  });
  return hits;
}

}  // namespace sdfgrid
