#include "sdfgrid/transform/marching.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "sdfgrid/core/memory.h"
#include "sdfgrid/transform/march_kernel.h"

namespace sdfgrid {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kSideBit = 1U << 31;
constexpr std::size_t kPart = 1024;   // samples of a bucket at a time
constexpr std::size_t kAhead = 12;    // samples between fetching and using
constexpr std::size_t kPadding = 16;  // written beyond the end of a list

std::uint32_t side_bit(float value) { return std::bit_cast<std::uint32_t>(value) & kSideBit; }

// The kernel's integers are signed; samples are below 2^31.
const std::int32_t* ints(const std::uint32_t* p) {
  return reinterpret_cast<const std::int32_t*>(p);  // NOLINT
}

}  // namespace

// What a part of a bucket asks for. Lists are written one entry further than they are long.
template <class Field>
struct March<Field>::Work {
  std::vector<std::uint32_t> neighbors;  // samples that are not final, and ...
  std::vector<std::uint32_t> sides;      // ... the sign bit of the one that they are beside
  std::vector<std::uint32_t> again;      // samples of the bucket with others of it beside them
  std::vector<std::uint32_t> again_sides;
  std::vector<float> distances;
  std::size_t neighbor_count = 0;
  std::size_t again_count = 0;

  Work()
      : neighbors(6 * kPart + kPadding),
        sides(6 * kPart + kPadding),
        again(kPart + kPadding),
        again_sides(kPart + kPadding),
        distances(6 * kPart) {}
};

template <class Field>
March<Field>::March(const MarchOptions& options, Field field)
    : options_(options), field_(std::move(field)) {}

template <class Field>
void March<Field>::reserve() {
  const std::size_t samples = field_.samples();
  if (values_.size() == samples) return;
  constexpr std::uint32_t kQuietNan = 0x7fc00000U;
  if (values_.empty()) {
    values_.reserve(samples);
    prefer_large_pages(values_.data(), samples * sizeof(float));
  }
  values_.resize(samples, std::bit_cast<float>(kQuietNan | kNotFinal));
  if (options_.sources) sources_.resize(samples);
}

template <class Field>
void March<Field>::seed(std::uint32_t sample, float distance, std::uint32_t source) {
  values_[sample] = std::bit_cast<float>(even_bits(distance));
  if (options_.sources) sources_[sample] = source;
  seeds_.push_back(sample);
}

template <class Field>
void March<Field>::block(std::uint32_t sample) {
  values_[sample] = kInfinite;
}

template <class Field>
void March<Field>::prefetch(std::uint32_t sample) const {
  for (int axis = 0; axis < 2; ++axis) {
    for (const int by : {-1, 1}) __builtin_prefetch(&values_[field_.step(sample, axis, by)]);
  }
}

template <class Field>
float March<Field>::limit(std::uint32_t side) const {
  return static_cast<float>(side != 0 ? options_.in_limit : options_.out_limit);
}

template <class Field>
bool March<Field>::grows(std::uint32_t sample) const {
  const float value = values_[sample];
  return options_.grow && std::abs(value) < limit(side_bit(value));
}

template <class Field>
std::uint32_t March<Field>::neighbor(std::uint32_t sample, int direction, bool grow) {
  const int axis = direction >> 1;
  const int by = (direction & 1) != 0 ? 1 : -1;
  std::uint32_t there = field_.step(sample, axis, by);
  if (grow && Field::nowhere(there)) {
    there = field_.step_making(sample, axis, by);
    reserve();
  }
  return there;
}

template <class Field>
template <class Queue>
bool March<Field>::offer(Queue& queue, std::uint32_t sample, std::uint32_t side, float distance) {
  const std::uint32_t bits = even_bits(distance);
  const auto own = std::bit_cast<std::uint32_t>(values_[sample]) & ~(kSideBit | kNotFinal);
  // As whole numbers, what is not a number is further than anything.
  if (bits >= own || distance > limit(side)) return false;
  values_[sample] = std::bit_cast<float>(bits | side | kNotFinal);
  queue.push(distance, sample);
  return true;
}

// Offers `candidate` to the neighbours of an accepted sample.
template <class Field>
template <class Queue, class Candidate>
void March<Field>::advance(Queue& queue, std::uint32_t sample, const Candidate& candidate) {
  const std::uint32_t side = side_bit(values_[sample]);
  const bool grow = grows(sample);
  for (int direction = 0; direction < 6; ++direction) {
    const std::uint32_t there = neighbor(sample, direction, grow);
    if (Field::nowhere(there) || is_final(there)) continue;
    if (offer(queue, there, side, candidate(there, sample))) sources_[there] = sources_[sample];
  }
}

template <class Field>
template <class Run>
void March<Field>::with_queue(double longest_step, const Run& run) {
  reserve();
  if (options_.bucket_width > 0) {
    const double span = longest_step + 4 * options_.bucket_width;  // untidiness adds to a step
    BucketQueue queue(options_.bucket_width, span, options_.bucket_order);
    run(queue);
  } else {
    HeapQueue queue;
    run(queue);
  }
}

// One sample after the other, nearest first.
template <class Field>
template <class Queue, class Advance>
void March<Field>::empty(Queue& queue, const Advance& advance, const Job& job) {
  // Seeds are final; the front starts around them.
  for (const std::uint32_t seed : seeds_) advance(seed);
  std::vector<std::uint32_t> samples;
  while (queue.pop(samples)) {
    job.checkpoint();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (i + kAhead < samples.size()) prefetch(samples[i + kAhead]);
      if (is_final(samples[i])) continue;
      finish(samples[i]);
      advance(samples[i]);
    }
  }
}

// Lists what is to be solved because of `accepted`.
template <class Field>
void March<Field>::look_around(std::span<const std::uint32_t> accepted, DistanceRange together,
                               Work& work) {
  const auto low = std::bit_cast<std::uint32_t>(together.low);
  const auto range = std::bit_cast<std::uint32_t>(together.high) - low;
  std::size_t count = 0;
  std::size_t again = 0;
  for (std::size_t i = 0; i < accepted.size(); ++i) {
    if (i + kAhead < accepted.size()) prefetch(accepted[i + kAhead]);
    const std::uint32_t sample = accepted[i];
    const std::uint32_t side = side_bit(values_[sample]);
    const bool grow = grows(sample);
    std::uint32_t any_together = 0;
    for (int direction = 0; direction < 6; ++direction) {
      const std::uint32_t there = neighbor(sample, direction, grow);
      if (Field::nowhere(there)) continue;
      // Without branches: neither can be foretold.
      const auto bits = std::bit_cast<std::uint32_t>(values_[there]);
      const bool is_together = (bits & ~kSideBit) - low < range;
      work.neighbors[count] = there;
      work.sides[count] = side;
      count += bits & kNotFinal;
      any_together |= ~bits & static_cast<std::uint32_t>(is_together);
    }
    work.again[again] = sample;
    work.again_sides[again] = side;
    again += any_together & 1;
  }
  work.neighbor_count = count;
  work.again_count = again;
}

template <class Field>
void March<Field>::solve(std::span<const std::uint32_t> samples,
                         std::span<const std::uint32_t> sides,
                         std::vector<float>& distances) const {
  MarchStencil stencil{};
  stencil.values = values_.data();
  stencil.second_order = options_.order == 2;
  for (int axis = 0; axis < 3; ++axis) {
    const double h = options_.spacing[axis];
    stencil.weight[axis] = static_cast<float>(1 / (h * h));
  }
  MarchKernel::Solve* kernel = nullptr;
  if constexpr (std::is_same_v<Field, DenseField>) {
    std::copy_n(field_.stride(), 3, stencil.stride);
    kernel = march_kernel().dense;
  } else {
    stencil.bricks = ints(field_.neighbors());
    kernel = march_kernel().bricks;
  }
  kernel(stencil, ints(samples.data()), ints(sides.data()), static_cast<int>(samples.size()),
         distances.data());
}

template <class Field>
void March<Field>::solve_again(Work& work) {
  const auto samples = std::span(work.again).first(work.again_count);
  solve(samples, work.again_sides, work.distances);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    float& value = values_[samples[i]];
    if (work.distances[i] < std::abs(value)) {
      value = std::bit_cast<float>(even_bits(work.distances[i]) | work.again_sides[i]);
    }
  }
}

// Whole buckets, in parts; see marching.h.
template <class Field>
template <class Queue>
void March<Field>::march(Queue& queue, const Job& job) {
  Work work;
  std::vector<std::uint32_t> samples = seeds_;
  DistanceRange together{0, 0};
  do {
    for (std::size_t i = 0; i < samples.size(); i += kPart) {
      job.checkpoint();
      const auto part = std::span(samples).subspan(i, std::min(kPart, samples.size() - i));
      look_around(part, together, work);
      solve_again(work);
      const auto neighbors = std::span(work.neighbors).first(work.neighbor_count);
      solve(neighbors, work.sides, work.distances);
      for (std::size_t n = 0; n < neighbors.size(); ++n) {
        offer(queue, neighbors[n], work.sides[n], work.distances[n]);
      }
    }
    if (!queue.pop(samples)) break;
    together = queue.together();
    accept(samples);
  } while (true);
}

template <class Field>
void March<Field>::accept(std::vector<std::uint32_t>& samples) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i + kAhead < samples.size()) __builtin_prefetch(&values_[samples[i + kAhead]]);
    const std::uint32_t sample = samples[i];
    const auto bits = std::bit_cast<std::uint32_t>(values_[sample]);
    values_[sample] = std::bit_cast<float>(bits & ~kNotFinal);
    samples[count] = sample;
    count += bits & kNotFinal;
  }
  samples.resize(count);
}

template <class Field>
void March<Field>::run(const Job& job) {
  const glm::dvec3& h = options_.spacing;
  // Second order may add to a step.
  with_queue(2 * std::max({h.x, h.y, h.z}), [&](auto& queue) { march(queue, job); });
}

template <class Field>
void March<Field>::run_sources(const SourceDistance& distance, const Job& job) {
  const auto candidate = [&](std::uint32_t sample, std::uint32_t from) {
    return distance(field_.index(sample), sources_[from]);
  };
  const glm::dvec3& h = options_.spacing;
  with_queue(2 * std::max({h.x, h.y, h.z}), [&](auto& queue) {
    empty(
        queue, [&](std::uint32_t sample) { advance(queue, sample, candidate); }, job);
  });
}

template <class Field>
void March<Field>::run_steps(std::span<const MaskStep> steps, const Job& job) {
  double longest = 0;
  for (const MaskStep& step : steps) longest = std::max(longest, step.length);
  with_queue(longest, [&](auto& queue) {
    const auto advance = [&](std::uint32_t sample) {
      const float here = values_[sample];
      const std::uint32_t side = side_bit(here);
      for (const MaskStep& step : steps) {
        const float there = std::abs(here) + static_cast<float>(step.length);
        if (there > limit(side)) continue;
        std::uint32_t to = sample;
        for (int axis = 0; axis < 3; ++axis) {
          to = options_.grow ? field_.step_making(to, axis, step.offset[axis])
                             : field_.step(to, axis, step.offset[axis]);
        }
        reserve();
        if (Field::nowhere(to) || is_final(to)) continue;
        offer(queue, to, side, there);
      }
    };
    empty(queue, advance, job);
  });
}

template class March<BrickField>;
template class March<DenseField>;

}  // namespace sdfgrid
