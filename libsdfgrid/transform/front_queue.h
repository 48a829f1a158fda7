// transform/front_queue.h: the front of a marching method, nearest sample first: exactly so (a
// binary heap), or to within the width of a bucket, in constant time (the untidy queue of L.
// Yatziv, A. Bartesaghi and G. Sapiro, *O(N) implementation of the fast marching algorithm*, 2006).
// Not installed.
//
// A sample is pushed again whenever its distance falls; who pops skips what was accepted before.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace sdfgrid {

// Distances from low on and below high.
struct DistanceRange {
  float low;
  float high;
};

class HeapQueue {
 public:
  void push(float distance, std::uint32_t sample) {
    heap_.emplace_back(distance, sample);
    std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
  }
  // What may be accepted together: one sample. False if nothing is left.
  bool pop(std::vector<std::uint32_t>& samples) {
    samples.clear();
    if (heap_.empty()) return false;
    std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
    samples.push_back(heap_.back().second);
    heap_.pop_back();
    return true;
  }
  // The distances of samples that were popped together.
  [[nodiscard]] static DistanceRange together() { return {0, 0}; }

 private:
  std::vector<std::pair<float, std::uint32_t>> heap_;  // ties go by number: no chance in the order
};

class BucketQueue {
 public:
  enum class Order {
    first_in_first_out,
    last_in_first_out,  // broken by wide buckets; kept to show that (docs/stability.md)
  };

  // No distance pushed may be more than `span` above that of the last sample popped.
  BucketQueue(double width, double span, Order order)
      : per_width_(static_cast<float>(1 / width)),
        buckets_(std::bit_ceil(static_cast<std::size_t>(span / width) + 3)),
        order_(order) {}

  void push(float distance, std::uint32_t sample) {
    // What should have come earlier comes now.
    auto number = static_cast<std::int64_t>(distance * per_width_);
    number = std::max(number, current_);
    const auto ring = static_cast<std::int64_t>(buckets_.size());
    number = std::min(number, current_ + ring - 1);
    bucket(number).push_back(sample);
    ++count_;
  }

  // A whole bucket, in the order of pushing; what is pushed into it later comes next. Last in,
  // first out takes one at a time. False if nothing is left.
  bool pop(std::vector<std::uint32_t>& samples) {
    samples.clear();
    if (count_ == 0) return false;
    while (bucket(current_).empty()) ++current_;
    auto& now = bucket(current_);
    if (order_ == Order::last_in_first_out) {
      samples.push_back(now.back());
      now.pop_back();
    } else {
      samples.swap(now);
    }
    count_ -= samples.size();
    return true;
  }
  [[nodiscard]] DistanceRange together() const {
    if (order_ == Order::last_in_first_out) return {0, 0};
    const auto low = static_cast<float>(current_);
    return {low / per_width_, (low + 1) / per_width_};
  }

 private:
  std::vector<std::uint32_t>& bucket(std::int64_t number) {
    return buckets_[static_cast<std::size_t>(number) & (buckets_.size() - 1)];
  }

  float per_width_;
  std::vector<std::vector<std::uint32_t>> buckets_;  // a ring; their number is a power of two
  Order order_;
  std::int64_t current_ = 0;  // number of the bucket that is being emptied
  std::size_t count_ = 0;
};

}  // namespace sdfgrid
