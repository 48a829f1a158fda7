#include "sdfgrid/transform/transform.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/transform/antialiased.h"
#include "sdfgrid/transform/dense_chamfer.h"
#include "sdfgrid/transform/dense_marching.h"
#include "sdfgrid/transform/dense_seeds.h"
#include "sdfgrid/transform/meijster.h"

namespace sdfgrid {
namespace {

using Method = TransformMethod;
constexpr TransformMethodInfo kMethods[] = {
    {Method::meijster, "meijster", "exact distances between samples", true, true},
    {Method::feature, "feature", "the nearest surface point of the nearest seed", false, true},
    {Method::chamfer345, "chamfer345", "steps of 3, 4 and 5 thirds", true, true},
    {Method::chamfer3, "chamfer3", "the best real steps of 3^3", true, true},
    {Method::chamfer5, "chamfer5", "the best real steps of 5^3", true, true},
    {Method::chamfer_mask, "chamfer", "steps of your own (--mask)", true, true, false, true},
    {Method::fmm, "fmm", "fast marching, first order", true, true, true},
    {Method::fmm2, "fmm2", "fast marching, second order", true, true, true},
    {Method::closest_point, "cpm", "marching that carries the nearest surface point", true, true,
     true},
    {Method::antialiased, "antialiased", "planes through partly covered voxels", true, false},
};

std::size_t sample_count(const glm::ivec3& dims) {
  return static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) *
         static_cast<std::size_t>(dims.z);
}

void check(const DenseSeeds& seeds, const TransformOptions& options, std::size_t room) {
  const glm::ivec3& n = seeds.dims;
  if (n.x < 1 || n.y < 1 || n.z < 1 || n.x > (1 << 20) || n.y > (1 << 20) || n.z > (1 << 20)) {
    throw Error(ErrorKind::usage, fmt::format("a volume of {} x {} x {} samples", n.x, n.y, n.z));
  }
  const glm::dvec3& s = seeds.spacing;
  if (!(s.x > 0 && s.y > 0 && s.z > 0 && std::isfinite(s.x * s.y * s.z))) {
    throw Error(ErrorKind::usage,
                fmt::format("spacing {}, {}, {}: must be positive numbers", s.x, s.y, s.z));
  }
  const std::size_t count = sample_count(n);
  const bool masked = !seeds.mask.empty();
  if ((masked ? seeds.mask.size() : seeds.values.size()) != count ||
      (masked && !seeds.values.empty()) || room != count) {
    throw Error(ErrorKind::usage, "the seeds do not have as many samples as the volume");
  }
  check(options);
}

// Throws Error{input} naming the first value that is not finite.
void check_finite(const DenseSeeds& seeds, const Job& job) {
  const auto row = static_cast<std::size_t>(seeds.dims.z);
  parallel_for(seeds.values.size() / row, 256, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * row; i < end * row; ++i) {
      if (std::isfinite(seeds.values[i])) continue;
      const auto ny = static_cast<std::size_t>(seeds.dims.y);
      throw Error(
          ErrorKind::input,
          fmt::format("sample [{}, {}, {}] is not a finite number; replace such samples by a "
                      "value of the side that they are on",
                      i / row / ny, i / row % ny, i % row));
    }
  });
}

void run_meijster(const DenseSeeds& seeds, const TransformOptions& options,
                  std::span<float> distance, const Job& job) {
  MeijsterOptions meijster_options;
  meijster_options.dims = seeds.dims;
  meijster_options.spacing = seeds.spacing;
  meijster_options.side = options.side;
  meijster_options.window = options.window;
  if (options.side == TransformSide::both) {
    const glm::dvec3& s = seeds.spacing;
    meijster_options.shift = 0.5 * std::min({s.x, s.y, s.z});
  }
  const SignedSamples samples(seeds);
  const auto inside = [&](int i, int j, std::uint8_t* row) {
    samples.inside_row(samples.number({i, j, 0}), row);
  };
  meijster(inside, meijster_options, distance, job);
}

}  // namespace

std::span<const TransformMethodInfo> transform_methods() { return kMethods; }

std::string_view transform_name(TransformMethod method) {
  const auto* found = std::find_if(std::begin(kMethods), std::end(kMethods),
                                   [&](const auto& info) { return info.method == method; });
  return found == std::end(kMethods) ? "" : found->name;
}

void check(const TransformOptions& options) {
  if (!(options.window >= 0)) throw Error(ErrorKind::usage, "a window must not be negative");
  const double width = options.bucket_width;
  if (width != 0 && !(width >= kLeastBucket && width <= kMostBucket)) {
    throw Error(ErrorKind::usage,
                fmt::format("a bucket must be 0 (a heap), or {} to {} voxels wide", kLeastBucket,
                            kMostBucket));
  }
}

void distance_transform(const DenseSeeds& seeds, const TransformOptions& options,
                        std::span<float> distance, const Job& job) {
  check(seeds, options, distance.size());
  check_finite(seeds, job);
  switch (options.method) {
    case TransformMethod::meijster:
      return run_meijster(seeds, options, distance, job);
    case TransformMethod::fmm:
    case TransformMethod::fmm2:
    case TransformMethod::closest_point:
      return march_dense(seeds, options, distance, job);
    case TransformMethod::chamfer345:
    case TransformMethod::chamfer3:
    case TransformMethod::chamfer5:
    case TransformMethod::chamfer_mask:
      return chamfer_dense(seeds, options, distance, job);
    case TransformMethod::antialiased:
      return antialiased_transform(seeds, options, distance, job);
    case TransformMethod::feature:
      break;
  }
  throw Error(ErrorKind::usage, "the feature method is for meshes; volumes have cpm");
}

}  // namespace sdfgrid
