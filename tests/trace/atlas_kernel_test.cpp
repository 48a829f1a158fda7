// The vector kernel of the atlas against plain loops, on every instruction set of this machine.
#include "sdfgrid/grid/atlas_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>
#include <vector>

#include "sdfgrid/core/isa.h"
#include "sdfgrid/grid/atlas.h"

namespace sdfgrid {
namespace {

constexpr int kEdge = Atlas::kEdge;
constexpr int kBrick = Atlas::kBrick;
constexpr float kMargin = 0.01F;

std::vector<const AtlasKernel*> kernels() {
  std::vector<const AtlasKernel*> all = {&baseline::kAtlasKernel};
#if defined(__x86_64__)
  if (active_isa() >= Isa::avx2) all.push_back(&avx2::kAtlasKernel);
  if (active_isa() >= Isa::avx512) all.push_back(&avx512::kAtlasKernel);
#endif
  return all;
}

int place(int x, int y, int z) { return (x * kEdge + y) * kEdge + z; }

// Planes, noise, and both with few crossing cells or none.
std::vector<std::vector<float>> sample_sets() {
  std::vector<std::vector<float>> sets;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> any(-1, 1);
  for (int n = 0; n < 40; ++n) {
    const float a = any(random);
    const float b = any(random);
    const float c = any(random);
    const float offset = 5 * any(random);
    const float noise = n % 4 == 0 ? 1.0F : 0.02F * any(random);
    std::vector<float> samples(Atlas::kSamples);
    for (int i = 0; i < Atlas::kSamples; ++i) {
      const int x = i / (kEdge * kEdge) - 4;
      const int y = i / kEdge % kEdge - 4;
      const int z = i % kEdge - 4;
      samples[i] = a * float(x) + b * float(y) + c * float(z) + offset + noise * any(random);
    }
    sets.push_back(samples);
  }
  sets.emplace_back(Atlas::kSamples, 2.0F);
  sets.emplace_back(Atlas::kSamples, -2.0F);
  sets.back()[place(3, 7, 1)] = std::numeric_limits<float>::quiet_NaN();
  return sets;
}

bool crossing(const std::vector<float>& s, int x, int y, int z) {
  int above = 0;
  int below = 0;
  for (int n = 0; n < 8; ++n) {
    const float v = s[place(x + (n >> 2), y + (n >> 1 & 1), z + (n & 1))];
    above += v > kMargin ? 1 : 0;
    below += v < -kMargin ? 1 : 0;
  }
  return above != 8 && below != 8;
}

TEST(AtlasKernel, SurveyIsThatOfPlainLoops) {
  for (const auto& s : sample_sets()) {
    float step[3] = {};
    for (int x = 0; x < kEdge; ++x) {
      for (int y = 0; y < kEdge; ++y) {
        for (int z = 0; z < kEdge; ++z) {
          const float v = s[place(x, y, z)];
          if (x < kBrick) step[0] = std::max(step[0], std::abs(s[place(x + 1, y, z)] - v));
          if (y < kBrick) step[1] = std::max(step[1], std::abs(s[place(x, y + 1, z)] - v));
          if (z < kBrick) step[2] = std::max(step[2], std::abs(s[place(x, y, z + 1)] - v));
        }
      }
    }
    const bool finite = std::all_of(s.begin(), s.end(), [](float v) { return std::isfinite(v); });
    for (const AtlasKernel* kernel : kernels()) {
      SampleSurvey survey{};
      kernel->survey(s.data(), kMargin, survey);
      for (int i = 0; i < 512; ++i) {
        ASSERT_EQ((survey.crossing[i >> 6] >> (i & 63) & 1) != 0,
                  crossing(s, i >> 6, i >> 3 & 7, i & 7));
      }
      EXPECT_EQ(std::isfinite(survey.low), finite);
      EXPECT_EQ(std::isfinite(survey.high), finite);
      if (!finite) continue;
      EXPECT_EQ(survey.low, *std::min_element(s.begin(), s.end()));
      EXPECT_EQ(survey.high, *std::max_element(s.begin(), s.end()));
      for (int a = 0; a < 3; ++a) EXPECT_EQ(survey.step[a], step[a]);
    }
  }
}

// By looking at every cube of cells ahead.
int hop(const std::vector<float>& s, int octant, const int (&cell)[3]) {
  for (int edge = 1; edge <= kBrick; ++edge) {
    for (int n = 0; n < edge * edge * edge; ++n) {
      int at[3] = {n / (edge * edge), n / edge % edge, n % edge};
      bool within = true;
      for (int a = 0; a < 3; ++a) {
        at[a] = (octant >> (2 - a) & 1) != 0 ? cell[a] - at[a] : cell[a] + at[a];
        within = within && at[a] >= 0 && at[a] < kBrick;
      }
      if (within && crossing(s, at[0], at[1], at[2])) return edge - 1;
    }
  }
  return kBrick;
}

TEST(AtlasKernel, HopsAreTheEdgesOfEmptyCubes) {
  for (const auto& s : sample_sets()) {
    for (const AtlasKernel* kernel : kernels()) {
      SampleSurvey survey{};
      kernel->survey(s.data(), kMargin, survey);
      std::vector<std::uint32_t> hops(Atlas::kHops);
      kernel->hops(survey.crossing, hops.data());
      std::uint64_t again[8];
      kernel->crossing_of(hops.data(), again);
      EXPECT_TRUE(std::equal(std::begin(again), std::end(again), survey.crossing));
      for (int i = 0; i < Atlas::kOctants * kBrick * kBrick * kBrick; ++i) {
        const int octant = i / (kBrick * kBrick * kBrick);
        const int stored[3] = {i / 64 % 8, i / 8 % 8, i % 8};
        int cell[3];
        for (int a = 0; a < 3; ++a) {
          cell[a] = (octant >> (2 - a) & 1) != 0 ? kBrick - 1 - stored[a] : stored[a];
        }
        const std::uint32_t word = hops[(octant * kBrick + stored[0]) * kBrick + stored[1]];
        ASSERT_EQ(int(word >> (4 * stored[2]) & 15U), hop(s, octant, cell));
      }
    }
  }
}

TEST(AtlasKernel, CopiesThePartsOfALeaf) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> any(-3, 3);
  std::vector<float> values(kBrick * kBrick * kBrick);
  for (float& v : values) v = any(random);
  const double factor = 1 / 0.37;
  for (const AtlasKernel* kernel : kernels()) {
    std::uint64_t negative[8];
    kernel->negatives(values.data(), negative);
    for (int i = 0; i < 512; ++i) {
      ASSERT_EQ((negative[i >> 6] >> (i & 63) & 1) != 0, values[i] < 0);
    }
    for (int part = 0; part < 8; ++part) {
      const std::vector<float> before(Atlas::kSamples, 7.0F);
      std::vector<float> expected = before;
      for (int i = 0; i < 512; ++i) {
        const int at[3] = {i >> 6, i >> 3 & 7, i & 7};
        bool in_part = true;
        int to[3];
        for (int a = 0; a < 3; ++a) {
          const bool beyond = (part >> (2 - a) & 1) != 0;
          in_part = in_part && (!beyond || at[a] == 0);
          to[a] = beyond ? kBrick : at[a];
        }
        if (in_part) {
          expected[place(to[0], to[1], to[2])] = static_cast<float>(values[i] * factor);
        }
      }
      std::vector<float> samples = before;
      EXPECT_TRUE(kernel->copy(values.data(), factor, part, samples.data())) << part;
      EXPECT_EQ(samples, expected) << part;
      EXPECT_FALSE(kernel->copy(values.data(), factor, part, samples.data())) << part;
      // The last sample of the part is looked at, too.
      samples[place(part & 4 ? 8 : 7, part & 2 ? 8 : 7, part & 1 ? 8 : 7)] += 1;
      EXPECT_TRUE(kernel->copy(values.data(), factor, part, samples.data())) << part;
      EXPECT_EQ(samples, expected) << part;
    }
  }
}

}  // namespace
}  // namespace sdfgrid
