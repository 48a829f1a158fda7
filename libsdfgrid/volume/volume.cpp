#include "sdfgrid/volume/volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <mutex>
#include <type_traits>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"

namespace sdfgrid {
namespace {

constexpr std::size_t kGrain = std::size_t{1} << 18;

// In the order of Samples' alternatives.
const std::array<const char*, 10> kTypeNames = {"uint8", "int8",   "uint16", "int16",   "uint32",
                                                "int32", "uint64", "int64",  "float32", "float64"};

// out[n] = make(sample n) for all n.
template <class Out, class Make>
std::vector<Out> transformed(const Samples& samples, const Job& job, const Make& make) {
  std::vector<Out> out;
  std::visit(
      [&](const auto& values) {
        out.resize(values.size());
        parallel_for(values.size(), kGrain, job, [&](std::size_t begin, std::size_t end) {
          for (std::size_t n = begin; n < end; ++n) out[n] = make(values[n]);
        });
      },
      samples);
  return out;
}

}  // namespace

bool Volume::axis_aligned() const { return axes == glm::dmat3(1.0); }

bool Volume::orthogonal() const {
  constexpr double kTolerance = 1e-3;
  return std::abs(glm::dot(axes[0], axes[1])) < kTolerance &&
         std::abs(glm::dot(axes[1], axes[2])) < kTolerance &&
         std::abs(glm::dot(axes[2], axes[0])) < kTolerance;
}

std::string type_name(const Samples& samples) { return kTypeNames[samples.index()]; }

const std::vector<std::string>& type_names() {
  static const std::vector<std::string> all(kTypeNames.begin(), kTypeNames.end());
  return all;
}

Samples samples_of_type(const std::string& name) {
  static const std::array<Samples, 10> kEmpty = {
      std::vector<std::uint8_t>(),  std::vector<std::int8_t>(),   std::vector<std::uint16_t>(),
      std::vector<std::int16_t>(),  std::vector<std::uint32_t>(), std::vector<std::int32_t>(),
      std::vector<std::uint64_t>(), std::vector<std::int64_t>(),  std::vector<float>(),
      std::vector<double>()};
  for (std::size_t i = 0; i < kTypeNames.size(); ++i) {
    if (name == kTypeNames[i]) return kEmpty[i];
  }
  throw Error(ErrorKind::usage, "'" + name + "' is no type of samples; uint8 or float32 are");
}

std::size_t bytes_per_sample(const Samples& samples) {
  return std::visit([](const auto& values) { return sizeof(values[0]); }, samples);
}

std::vector<float> as_floats(const Samples& samples, const Job& job) {
  return transformed<float>(samples, job, [](auto value) { return static_cast<float>(value); });
}

SampleRange sample_range(const Volume& volume, const Job& job) {
  SampleRange range{INFINITY, -INFINITY};
  std::mutex mutex;
  std::visit(
      [&](const auto& values) {
        parallel_for(values.size(), kGrain, job, [&](std::size_t begin, std::size_t end) {
          const auto [lo, hi] = std::minmax_element(values.begin() + begin, values.begin() + end);
          const std::lock_guard lock(mutex);
          range.lo = std::min(range.lo, static_cast<double>(*lo));
          range.hi = std::max(range.hi, static_cast<double>(*hi));
        });
      },
      volume.samples);
  return range;
}

std::vector<std::uint8_t> mask_of_label(const Volume& volume, double label, const Job& job) {
  return transformed<std::uint8_t>(volume.samples, job, [label](auto value) {
    return static_cast<std::uint8_t>(static_cast<double>(value) == label);
  });
}

std::vector<std::uint8_t> mask_of_nonzero(const Volume& volume, const Job& job) {
  return transformed<std::uint8_t>(volume.samples, job,
                                   [](auto value) { return std::uint8_t(value != 0); });
}

std::vector<std::uint8_t> mask_above(const Volume& volume, double iso, const Job& job) {
  return transformed<std::uint8_t>(volume.samples, job, [iso](auto value) {
    return static_cast<std::uint8_t>(static_cast<double>(value) >= iso);
  });
}

}  // namespace sdfgrid
