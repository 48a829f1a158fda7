#include "sdfgrid/transform/marching.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sdfgrid {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t kAhead = 8;  // samples between fetching and using
constexpr std::uint32_t kSamplesPerCheckpoint = 1U << 16;

// What one axis says: weight * (T - value)^2 is its part of |grad T|^2.
struct AxisTerm {
  float value;
  float weight;   // zero if the axis says nothing
  float nearest;  // the neighbour's own distance, below which T may not fall
};

// The solution T of: the sum of all terms is 1; less than `lowest` if there is none.
float solve_all(const AxisTerm terms[3], float origin) {
  float a = 0;
  float b = 0;
  float c = -1;
  for (int i = 0; i < 3; ++i) {
    // Relative to a value nearby, so that squares of far distances do not eat the digits.
    const float v = terms[i].value - origin;
    a += terms[i].weight;
    b += terms[i].weight * v;
    c += terms[i].weight * v * v;
  }
  const float root = b * b - a * c;
  return root < 0 ? -kInfinite : origin + (b + std::sqrt(root)) / a;
}

// The upwind solution: a term whose neighbour is later than the solution does not take part.
float solve_terms(AxisTerm terms[3]) {
  for (int left = 3; left > 0; --left) {
    int latest = 0;
    for (int i = 1; i < 3; ++i) {
      if (terms[i].nearest > terms[latest].nearest) latest = i;
    }
    const float last = terms[latest].nearest;
    if (last == -kInfinite) break;
    const float t = solve_all(terms, last);
    if (t >= last) return t;
    terms[latest] = {0, 0, -kInfinite};
  }
  return kInfinite;
}

}  // namespace

March::March(const MarchOptions& options) : options_(options) {
  for (int axis = 0; axis < 3; ++axis) {
    weight_[axis] = static_cast<float>(1 / (options.spacing[axis] * options.spacing[axis]));
  }
}

void March::reserve() {
  const std::size_t samples = static_cast<std::size_t>(field_.size()) * 512;
  if (known_.size() == samples) return;
  known_.resize(samples, kUnknown);
  trial_.resize(samples, kInfinite);
  if (options_.sources) sources_.resize(samples);
}

void March::seed(std::uint32_t sample, float distance, std::uint32_t source) {
  known_[sample] = trial_[sample] = distance;
  if (options_.sources) sources_[sample] = source;
  seeds_.push_back(sample);
}

void March::block(std::uint32_t sample) { known_[sample] = kInfinite; }

float March::solve(std::uint32_t sample, float side) const {
  AxisTerm terms[3];
  for (int axis = 0; axis < 3; ++axis) {
    // What is not known and what is on the other side compares false.
    const float below = known_[field_.step(sample, axis, -1)] * side;
    const float above = known_[field_.step(sample, axis, 1)] * side;
    const float b = below >= 0 ? below : kInfinite;
    const float a = above >= 0 ? above : kInfinite;
    const float first = std::min(a, b);
    const bool some = first < kInfinite;
    terms[axis] = {some ? first : 0, some ? weight_[axis] : 0, some ? first : -kInfinite};
    if (options_.order == 2) {
      const float second = known_[field_.step(sample, axis, b <= a ? -2 : 2)] * side;
      const bool smooth = second >= 0 && second <= first && some;
      terms[axis].value = smooth ? (4 * first - second) * (1.0F / 3) : terms[axis].value;
      terms[axis].weight *= smooth ? 2.25F : 1.0F;
    }
  }
  return solve_terms(terms);
}

// Fetches what advance() of a sample will read: the front is as large as the surface, and each
// bucket goes over all of it.
void March::prefetch(std::uint32_t sample) const {
  __builtin_prefetch(&known_[sample]);
  for (int axis = 0; axis < 2; ++axis) {
    for (const int by : {-1, 1}) {
      const std::uint32_t neighbor = field_.step(sample, axis, by);
      __builtin_prefetch(&known_[neighbor]);
      __builtin_prefetch(&trial_[neighbor]);
      __builtin_prefetch(&known_[field_.step(sample, axis, 2 * by)]);
      __builtin_prefetch(&known_[field_.step(sample, axis, 3 * by)]);
    }
  }
  __builtin_prefetch(&trial_[sample]);
}

template <class Queue, class Candidate>
void March::advance(Queue& queue, std::uint32_t sample, const Candidate& candidate) {
  const bool inside = std::signbit(known_[sample]);
  const float side = inside ? -1.0F : 1.0F;
  const auto limit = static_cast<float>(inside ? options_.in_limit : options_.out_limit);
  for (int direction = 0; direction < 6; ++direction) {
    const int axis = direction >> 1;
    const int by = (direction & 1) != 0 ? 1 : -1;
    std::uint32_t neighbor = field_.step(sample, axis, by);
    if (BrickField::nowhere(neighbor)) {
      if (!options_.grow || std::abs(known_[sample]) >= limit) continue;
      neighbor = field_.step_making(sample, axis, by);
      reserve();
    }
    if (!std::isnan(known_[neighbor])) continue;
    const float t = candidate(neighbor, sample, side);
    if (t >= std::abs(trial_[neighbor]) || t > limit) continue;
    trial_[neighbor] = side * t;
    if (options_.sources) sources_[neighbor] = sources_[sample];
    queue.push(t, neighbor);
  }
}

template <class Queue, class Candidate>
void March::empty(Queue& queue, const Candidate& candidate, const Job& job) {
  // Seeds are final; the front starts around them.
  for (const std::uint32_t seed : seeds_) advance(queue, seed, candidate);
  std::uint32_t accepted = 0;
  std::uint32_t sample = 0;
  while (queue.pop(sample)) {
    if (const std::uint32_t next = queue.ahead(kAhead); next != 0) prefetch(next);
    if (!std::isnan(known_[sample])) continue;
    known_[sample] = trial_[sample];
    advance(queue, sample, candidate);
    if (++accepted % kSamplesPerCheckpoint == 0) job.checkpoint();
  }
}

template <class Candidate>
void March::run_with(const Candidate& candidate, const Job& job) {
  reserve();
  if (options_.bucket_width > 0) {
    // A step along the longest spacing, and what untidiness and second order may add to it.
    const glm::dvec3& h = options_.spacing;
    const double span = 2 * std::max({h.x, h.y, h.z}) + 4 * options_.bucket_width;
    BucketQueue queue(options_.bucket_width, span, options_.bucket_order);
    empty(queue, candidate, job);
  } else {
    HeapQueue queue;
    empty(queue, candidate, job);
  }
}

void March::run(const Job& job) {
  run_with([this](std::uint32_t sample, std::uint32_t, float side) { return solve(sample, side); },
           job);
}

void March::run_sources(const SourceDistance& distance, const Job& job) {
  run_with([&](std::uint32_t sample, std::uint32_t from,
               float) { return distance(field_.index(sample), sources_[from]); },
           job);
}

}  // namespace sdfgrid
