// transform/transform.h: distance transforms of dense volumes, many methods behind one signature.
//
// Sample (i, j, k) of a volume of nx x ny x nz samples is number (i * ny + j) * nz + k, the order
// of a numpy array [i, j, k]; it sits at (i, j, k) * spacing. Distances are in world units, the
// units of the spacing. docs/methods.md has the paper, the error bound and the failures of each
// method.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "sdfgrid/core/job.h"

namespace sdfgrid {

enum class TransformMethod {
  meijster,      // exact between samples; the surface itself is known to half a voxel only
  feature,       // nearest sample beside the surface, and from it the distance to its surface point
  chamfer345,    // steps of 3, 4 and 5 thirds
  chamfer3,      // the best real steps of 3^3
  chamfer5,      // the best real steps of 5^3
  chamfer_mask,  // steps of the caller's
  fmm,           // fast marching, first order
  fmm2,          // fast marching, second order
  closest_point,  // fast marching that carries the nearest point of the surface
  antialiased,    // from the planes through partly covered voxels
};

struct TransformMethodInfo {
  TransformMethod method;
  std::string_view name;  // the word of the command line
  std::string_view help;  // half a sentence
  bool volumes;           // distance_transform() takes it
  bool meshes;            // so does convert_mesh()
  bool buckets = false;   // TransformOptions::bucket_width counts
  bool steps = false;     // TransformOptions::steps must be given
};

// All methods, in the order in which help lists them.
[[nodiscard]] std::span<const TransformMethodInfo> transform_methods();

[[nodiscard]] std::string_view transform_name(TransformMethod method);

enum class TransformSide {
  both,     // signed: negative inside
  outside,  // distance to the nearest sample inside; zero there
  inside,   // distance to the nearest sample outside; zero there
};

// What DenseSeeds::values mean.
enum class SeedKind {
  level,     // any function that is negative inside and crosses zero at the surface
  distance,  // signed distances in world units, right beside the surface; elsewhere the sign counts
  coverage,  // how much of each voxel is inside, 0 to 1
};

// The volume: either `mask` or `values` has dims.x * dims.y * dims.z entries, the other is empty.
struct DenseSeeds {
  glm::ivec3 dims{0};  // each >= 1
  glm::dvec3 spacing{1.0};
  std::span<const std::uint8_t> mask{};  // not zero: inside
  std::span<const float> values{};       // all finite
  SeedKind kind = SeedKind::level;
};

// One step of a chamfer mask: from a sample to all those at (+-x, +-y, +-z) and permutations.
struct ChamferStep {
  glm::ivec3 offset;  // x >= y >= z >= 0, at most 3, no common factor
  double length;      // > 0, in voxels
};

struct TransformOptions {
  TransformMethod method = TransformMethod::meijster;
  TransformSide side = TransformSide::both;
  // Distances beyond this, in voxels of the smallest spacing, are cut to it; 0: none is.
  double window = 0;
  // Of the queue of the marching methods, in voxels of the smallest spacing: 0, a binary heap, or
  // kLeastBucket to kMostBucket.
  double bucket_width = 1.0 / 16;
  std::vector<ChamferStep> steps{};  // for chamfer_mask
};
inline constexpr double kLeastBucket = 1e-4;  // below, the empty ones take more than the heap
inline constexpr double kMostBucket = 16;

// Throws Error{usage} for options that make no sense for any input.
void check(const TransformOptions& options);

// Distances from every sample to the surface between samples inside and outside, by sign:
// - of a mask, between samples: d to the nearest sample on the other side; for `both`, half of the
//   smallest spacing less, as the surface lies between them, and negative inside;
// - of values, to their zero (coverage: to one half) as finely as the method can tell; the method
//   antialiased takes coverage, cut to 0 and 1, and masks as such without partly covered voxels.
// Samples without any surface get +infinity, or -infinity inside, or plus and minus the window.
// Writes dims.x * dims.y * dims.z distances in the order above; `distance` may not overlap the
// seeds. The same bytes at any number of threads. Throws Error{usage} for options or sizes that
// make no sense or that the method does not take, Error{input} for a value that is not finite,
// Error{cancelled} (then `distance` holds nothing of use).
void distance_transform(const DenseSeeds& seeds, const TransformOptions& options,
                        std::span<float> distance, const Job& job);

}  // namespace sdfgrid
