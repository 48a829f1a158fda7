// Roots by multiplications against the machine's own, on every instruction set of this machine.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "field/roots_kernel.h"
#include "sdfgrid/core/isa.h"

namespace sdfgrid {
namespace {

constexpr int kBlock = 4096;
constexpr float kLeast = 0x1p-96F;
constexpr float kMost = std::numeric_limits<float>::max();

std::vector<const RootsKernel*> kernels() {
  std::vector<const RootsKernel*> all = {&baseline::kRootsKernel};
#if defined(__x86_64__)
  if (active_isa() >= Isa::avx2) all.push_back(&avx2::kRootsKernel);
  if (active_isa() >= Isa::avx512) all.push_back(&avx512::kRootsKernel);
#endif
  return all;
}

// As lanes.h says.
float expected(float a) { return a >= kLeast ? std::sqrt(std::fmin(a, kMost)) : 0.0F; }

// Of the floats whose bits are first, first + stride and so on; how many roots differ.
long wrong(const RootsKernel& kernel, std::uint32_t first, std::uint32_t last,
           std::uint32_t stride) {
  std::vector<float> a(kBlock);
  std::vector<float> root(kBlock);
  long count = 0;
  for (std::uint64_t at = first; at <= last; at += std::uint64_t{kBlock} * stride) {
    for (int i = 0; i < kBlock; ++i) {
      a[i] = std::bit_cast<float>(static_cast<std::uint32_t>(at + std::uint64_t{stride} * i));
    }
    kernel.inner_root(kBlock, a.data(), root.data());
    for (int i = 0; i < kBlock; ++i) {
      count +=
          std::bit_cast<std::uint32_t>(root[i]) != std::bit_cast<std::uint32_t>(expected(a[i]));
    }
  }
  return count;
}

// Two octaves whole, which is all there is but for factors of 4 that change no digit; then every
// 331st float of all, whatever its sign.
TEST(Roots, ByMultiplicationsAreRoundedAsTheMachineRoundsThem) {
  for (const RootsKernel* kernel : kernels()) {
    const auto octaves = [&](float from, float to) {
      return wrong(*kernel, std::bit_cast<std::uint32_t>(from), std::bit_cast<std::uint32_t>(to),
                   1);
    };
    EXPECT_EQ(octaves(1, 4), 0);
    EXPECT_EQ(octaves(0.25F * kMost, kMost), 0);
    EXPECT_EQ(octaves(0.5F * kLeast, 8 * kLeast), 0);
    EXPECT_EQ(wrong(*kernel, 0, 0xffffffffU, 331), 0);
  }
}

}  // namespace
}  // namespace sdfgrid
