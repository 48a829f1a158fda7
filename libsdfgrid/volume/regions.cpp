#include "sdfgrid/volume/regions.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace sdfgrid {
namespace {

enum Mark : std::uint8_t { kOutside, kUnseen, kSeen, kLargest };

// Walks through the region of `start`, which turns from `from` to `to`. Returns its size.
std::size_t fill(const glm::ivec3& dims, std::size_t start, Mark from, Mark to,
                 std::vector<std::uint8_t>& marks, std::vector<std::size_t>& stack) {
  const std::size_t nx = dims.x;
  const std::size_t layer = nx * dims.y;
  std::size_t size = 0;
  const auto take = [&](std::size_t n) {
    if (marks[n] != from) return;
    marks[n] = to;
    ++size;
    stack.push_back(n);
  };
  take(start);
  while (!stack.empty()) {
    const std::size_t n = stack.back();
    stack.pop_back();
    if (n % nx > 0) take(n - 1);
    if (n % nx + 1 < nx) take(n + 1);
    if (n % layer >= nx) take(n - nx);
    if (n % layer + nx < layer) take(n + nx);
    if (n >= layer) take(n - layer);
    if (n + layer < marks.size()) take(n + layer);
  }
  return size;
}

}  // namespace

std::size_t keep_largest_region(Volume& volume, const IsosurfaceOptions& options, const Job& job) {
  std::vector<std::uint8_t> marks = mask_above(volume, options.iso, job);
  for (std::uint8_t& mark : marks) {
    mark = (mark != 0) == options.inside_above ? kUnseen : kOutside;
  }
  std::vector<std::size_t> stack;
  std::size_t regions = 0;
  std::size_t largest = 0;
  std::size_t start_of_largest = 0;
  for (std::size_t n = 0; n < marks.size(); ++n) {
    if (n % (std::size_t{1} << 20U) == 0) {
      job.checkpoint();
      job.report("regions", static_cast<double>(n) / static_cast<double>(marks.size()));
    }
    if (marks[n] != kUnseen) continue;
    ++regions;
    const std::size_t size = fill(volume.dims, n, kUnseen, kSeen, marks, stack);
    if (size <= largest) continue;
    largest = size;
    start_of_largest = n;
  }
  if (regions < 2) return 0;
  (void)fill(volume.dims, start_of_largest, kSeen, kLargest, marks, stack);
  const SampleRange range = sample_range(volume, job);
  std::visit(
      [&](auto& values) {
        using T = std::decay_t<decltype(values[0])>;
        const auto outermost = static_cast<T>(options.inside_above ? range.lo : range.hi);
        for (std::size_t n = 0; n < values.size(); ++n) {
          if (marks[n] == kSeen) values[n] = outermost;
        }
      },
      volume.samples);
  return regions - 1;
}

}  // namespace sdfgrid
