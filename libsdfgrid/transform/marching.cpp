#include "sdfgrid/transform/marching.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sdfgrid {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();
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
  if (values_.size() == samples) return;
  constexpr std::uint32_t kQuietNan = 0x7fc00000U;
  values_.resize(samples, std::bit_cast<float>(kQuietNan | kNotFinal));
  if (options_.sources) sources_.resize(samples);
}

void March::seed(std::uint32_t sample, float distance, std::uint32_t source) {
  set(sample, distance, true);
  if (options_.sources) sources_[sample] = source;
  seeds_.push_back(sample);
}

void March::block(std::uint32_t sample) { set(sample, kInfinite, true); }

float March::solve(std::uint32_t sample, float side) const {
  AxisTerm terms[3];
  for (int axis = 0; axis < 3; ++axis) {
    // What is not known and what is on the other side compares false.
    const float below = known(field_.step(sample, axis, -1)) * side;
    const float above = known(field_.step(sample, axis, 1)) * side;
    const float b = below >= 0 ? below : kInfinite;
    const float a = above >= 0 ? above : kInfinite;
    const float first = std::min(a, b);
    const bool some = first < kInfinite;
    terms[axis] = {some ? first : 0, some ? weight_[axis] : 0, some ? first : -kInfinite};
    if (options_.order == 2) {
      const float second = known(field_.step(sample, axis, b <= a ? -2 : 2)) * side;
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
  __builtin_prefetch(&values_[sample]);
  for (int axis = 0; axis < 2; ++axis) {
    for (const int by : {-3, -2, -1, 1, 2, 3}) {
      __builtin_prefetch(&values_[field_.step(sample, axis, by)]);
    }
  }
}

float March::limit(float side) const {
  return static_cast<float>(side < 0 ? options_.in_limit : options_.out_limit);
}

template <class Queue>
void March::offer(Queue& queue, std::uint32_t sample, std::uint32_t from, float side,
                  float distance) {
  // Not a number is no shorter.
  if (distance >= std::abs(values_[sample]) || distance > limit(side)) return;
  set(sample, side * distance, false);
  if (options_.sources) sources_[sample] = sources_[from];
  queue.push(distance, sample);
}

template <class Queue, class Candidate>
void March::advance(Queue& queue, std::uint32_t sample, const Candidate& candidate) {
  const float side = std::signbit(values_[sample]) ? -1.0F : 1.0F;
  const bool grow = options_.grow && std::abs(values_[sample]) < limit(side);
  for (int direction = 0; direction < 6; ++direction) {
    const int axis = direction >> 1;
    const int by = (direction & 1) != 0 ? 1 : -1;
    std::uint32_t neighbor = field_.step(sample, axis, by);
    if (BrickField::nowhere(neighbor)) {
      if (!grow) continue;
      neighbor = field_.step_making(sample, axis, by);
      reserve();
    }
    if (is_final(neighbor)) continue;
    offer(queue, neighbor, sample, side, candidate(neighbor, sample, side));
  }
}

template <class Queue, class Advance>
void March::empty(Queue& queue, const Advance& advance, const Job& job) {
  // Seeds are final; the front starts around them.
  for (const std::uint32_t seed : seeds_) advance(queue, seed);
  std::size_t accepted = 0;
  std::uint32_t sample = 0;
  while (queue.pop(sample)) {
    if (const std::uint32_t next = queue.ahead(kAhead); next != 0) prefetch(next);
    if (is_final(sample)) continue;
    set(sample, values_[sample], true);
    advance(queue, sample);
    if (++accepted % kSamplesPerCheckpoint == 0) job.checkpoint();
  }
}

template <class Advance>
void March::with_queue(double longest_step, const Advance& advance, const Job& job) {
  reserve();
  if (options_.bucket_width > 0) {
    const double span = longest_step + 4 * options_.bucket_width;  // untidiness adds to a step
    BucketQueue queue(options_.bucket_width, span, options_.bucket_order);
    empty(queue, advance, job);
  } else {
    HeapQueue queue;
    empty(queue, advance, job);
  }
}

void March::run(const Job& job) {
  const auto candidate = [this](std::uint32_t sample, std::uint32_t, float side) {
    return solve(sample, side);
  };
  const glm::dvec3& h = options_.spacing;
  // Second order may add to a step.
  with_queue(
      2 * std::max({h.x, h.y, h.z}),
      [&](auto& queue, std::uint32_t sample) { advance(queue, sample, candidate); }, job);
}

void March::run_sources(const SourceDistance& distance, const Job& job) {
  const auto candidate = [&](std::uint32_t sample, std::uint32_t from, float) {
    return distance(field_.index(sample), sources_[from]);
  };
  const glm::dvec3& h = options_.spacing;
  with_queue(
      2 * std::max({h.x, h.y, h.z}),
      [&](auto& queue, std::uint32_t sample) { advance(queue, sample, candidate); }, job);
}

void March::run_steps(std::span<const MaskStep> steps, const Job& job) {
  double longest = 0;
  for (const MaskStep& step : steps) longest = std::max(longest, step.length);
  with_queue(
      longest,
      [&](auto& queue, std::uint32_t sample) {
        const float here = values_[sample];
        const float side = std::signbit(here) ? -1.0F : 1.0F;
        for (const MaskStep& step : steps) {
          const float there = side * here + static_cast<float>(step.length);
          if (there > limit(side)) continue;
          std::uint32_t to = sample;
          for (int axis = 0; axis < 3; ++axis) {
            to = options_.grow ? field_.step_making(to, axis, step.offset[axis])
                               : field_.step(to, axis, step.offset[axis]);
          }
          reserve();
          if (BrickField::nowhere(to) || is_final(to)) continue;
          offer(queue, to, sample, side, there);
        }
      },
      job);
}

}  // namespace sdfgrid
