// transform/marching.h: fast marching (J. Sethian, *A fast marching level set method*, 1996; second
// order: *Fast marching methods*, SIAM Review 41, 1999) and closest-point marching over bricks
// (not installed).
//
// Lengths are in units of the smallest spacing. Every value carries its side's sign, and stencils
// take values of one side only, so that none crosses the surface.
//
// A bucket is accepted as a whole: its samples' neighbours are solved sixteen at a time. Those of
// its samples that have a neighbour in the same bucket are solved once more first, for that one may
// be upwind of them: without this, second order is lost along the directions in which that happens.
#pragma once

#include <bit>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/transform/brick_field.h"
#include "sdfgrid/transform/chamfer_mask.h"
#include "sdfgrid/transform/dense_field.h"
#include "sdfgrid/transform/front_queue.h"

namespace sdfgrid {

struct MarchOptions {
  int order = 2;                   // 1 or 2, of the stencils
  glm::dvec3 spacing{1.0};         // each >= 1
  double bucket_width = 1.0 / 16;  // 0: a binary heap
  BucketQueue::Order bucket_order = BucketQueue::Order::first_in_first_out;
  double out_limit = 1e30;  // nothing further is accepted outside ...
  double in_limit = 1e30;   // ... and inside
  bool sources = false;     // closest-point marching: every sample has a source
  bool grow = false;        // bricks are made where the front leaves them (BrickField)
};

// The distance from a sample (by index) to source `source`: a point, a triangle.
using SourceDistance = std::function<float(const glm::ivec3& index, std::uint32_t source)>;

// Over a BrickField or a DenseField.
template <class Field = BrickField>
class March {
 public:
  explicit March(const MarchOptions& options, Field field = {});

  // The samples; bricks are made by the caller. reserve() then makes room for seed() and block().
  Field& field() { return field_; }
  [[nodiscard]] const Field& field() const { return field_; }
  void reserve();
  // A signed distance that is known, from `source`.
  void seed(std::uint32_t sample, float distance, std::uint32_t source = 0);
  // The front may not enter: beyond the volume's borders.
  void block(std::uint32_t sample);

  // Solves |grad T| = 1 from all seeds. Throws Error{cancelled}.
  void run(const Job& job);
  // Shortest ways in steps of a mask (E. Dijkstra 1959).
  void run_steps(std::span<const MaskStep> steps, const Job& job);
  // Each sample takes the nearest of the sources of its accepted neighbours.
  void run_sources(const SourceDistance& distance, const Job& job);

  // Signed distance of a sample; not a number where the front did not come.
  [[nodiscard]] float value(std::uint32_t sample) const { return known(sample); }
  [[nodiscard]] std::uint32_t source(std::uint32_t sample) const { return sources_[sample]; }

 private:
  static constexpr std::uint32_t kNotFinal = 1;
  [[nodiscard]] bool is_final(std::uint32_t sample) const {
    return (std::bit_cast<std::uint32_t>(values_[sample]) & kNotFinal) == 0;
  }
  [[nodiscard]] float known(std::uint32_t sample) const {
    const float v = values_[sample];
    return (std::bit_cast<std::uint32_t>(v) & kNotFinal) == 0
               ? v
               : std::numeric_limits<float>::quiet_NaN();
  }
  // A number's bits, rounded to those that have the last one free: to cut it off would add up.
  [[nodiscard]] static std::uint32_t even_bits(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return (bits + (bits >> 1 & 1U)) & ~kNotFinal;
  }
  void finish(std::uint32_t sample) {
    values_[sample] =
        std::bit_cast<float>(std::bit_cast<std::uint32_t>(values_[sample]) & ~kNotFinal);
  }

  // The most a sample inside (or outside) may be away.
  [[nodiscard]] float limit(std::uint32_t side) const;
  // The neighbour in a direction (0 to 5), made where it is missing if `grow`.
  std::uint32_t neighbor(std::uint32_t sample, int direction, bool grow);
  [[nodiscard]] bool grows(std::uint32_t sample) const;
  // Takes a shorter distance of a sample, and puts it on the front. False if it is no shorter.
  template <class Queue>
  bool offer(Queue& queue, std::uint32_t sample, std::uint32_t side, float distance);
  template <class Queue, class Candidate>
  void advance(Queue& queue, std::uint32_t sample, const Candidate& candidate);
  template <class Queue, class Advance>
  void empty(Queue& queue, const Advance& advance, const Job& job);
  template <class Run>
  void with_queue(double longest_step, const Run& run);
  void prefetch(std::uint32_t sample) const;

  struct Work;
  void look_around(std::span<const std::uint32_t> accepted, DistanceRange together, Work& work);
  void solve(std::span<const std::uint32_t> samples, std::span<const std::uint32_t> sides,
             std::vector<float>& distances) const;
  void solve_again(Work& work);
  template <class Queue>
  void march(Queue& queue, const Job& job);
  // Makes those final that are not, and drops the others.
  void accept(std::vector<std::uint32_t>& samples);

  MarchOptions options_;
  Field field_;
  // Signed distances, and whether they are final: then the last bit of the number is 0. One array
  // for both, as the front is larger than the cache. NaN, not final, at first; infinite if blocked.
  std::vector<float> values_;
  std::vector<std::uint32_t> sources_;  // as values_, in closest-point marching
  std::vector<std::uint32_t> seeds_;
};

extern template class March<BrickField>;
extern template class March<DenseField>;

}  // namespace sdfgrid
