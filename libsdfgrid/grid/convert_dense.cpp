#include "sdfgrid/grid/convert_dense.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <glm/common.hpp>
#include <memory>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/memory.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/dense.h"
#include "sdfgrid/voxelize/nearest_triangle.h"
#include "sdfgrid/voxelize/node_bins.h"

namespace sdfgrid {
namespace {

constexpr double kSeedBand = 3;  // voxels; transforms read two

// The lattice points from `lo` to `hi`, inclusive.
struct IndexBox {
  glm::ivec3 lo;
  glm::ivec3 hi;
};

IndexBox index_box(const Box& bounds, const Lattice& lattice, double margin) {
  const glm::dvec3 wide(std::ceil(margin));
  return {glm::ivec3(glm::floor(lattice.to_index(bounds.lo)) - wide),
          glm::ivec3(glm::ceil(lattice.to_index(bounds.hi)) + wide)};
}

Volume empty_volume(const IndexBox& box, const Lattice& lattice) {
  Volume volume;
  volume.dims = box.hi - box.lo + 1;
  volume.spacing = glm::dvec3(lattice.voxel);
  volume.origin = lattice.to_world(glm::dvec3(box.lo));
  return volume;
}

void check_memory(const Volume& volume, double bytes_per_sample, std::size_t max_memory) {
  const glm::dvec3 dims(volume.dims);
  check_allowed(dims.x * dims.y * dims.z * bytes_per_sample, max_memory,
                fmt::format("{} x {} x {} samples", volume.dims.x, volume.dims.y, volume.dims.z),
                "use a larger voxel, no --dense");
}

// Calls row(y, z) for all rows along x (of samples, of bricks), from many threads.
template <class Row>
void for_each_row(const glm::ivec3& dims, const Job& job, const Row& row) {
  constexpr std::size_t kRowsPerTask = 8;
  const std::size_t rows = static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(dims.z);
  parallel_for("dense", rows, kRowsPerTask, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      job.checkpoint();
      row(static_cast<int>(r % static_cast<std::size_t>(dims.y)),
          static_cast<int>(r / static_cast<std::size_t>(dims.y)));
    }
  });
}

// Exact distances, a brick of 8^3 samples at a time: those triangles that may be nearest to one of
// them are found around the brick's centre, and tried by the converter's vector arithmetic.
class ExactFiller {
 public:
  ExactFiller(const NearestTriangle& nearest, const glm::ivec3& lo, double voxel, Volume& volume)
      : nearest_(nearest),
        lo_(lo),
        voxel_(voxel),
        known_(static_cast<float>(0.999 * kSeedBand * voxel)),
        volume_(volume),
        values_(std::get<std::vector<float>>(volume.samples)) {}

  // The brick from sample `first` of the volume on. Samples in the band have their distance; others
  // get theirs, and keep their sign.
  void fill(const glm::ivec3& first) {
    constexpr int kHalf = kBrickEdge / 2;
    constexpr std::size_t kMost = 8192;  // triangles; with more a sample alone is quicker
    if (all_known(first)) return;
    const glm::dvec3 center = glm::dvec3(lo_ + first) + 0.5 * (kBrickEdge - 1);
    const double radius = kHalf * std::sqrt(3.0);
    const double middle = nearest_.distance(center, nearest_one_);
    triangles_.clear();
    nearest_.collect(center, middle + 2 * radius, triangles_);
    const bool many = triangles_.size() > kMost;
    if (!many) find_nearest(center);
    for (int s = 0; s < 512; ++s) {
      const glm::ivec3 at = first + glm::ivec3(s >> 6, s >> 3 & 7, s & 7);
      if (at.x >= volume_.dims.x || at.y >= volume_.dims.y || at.z >= volume_.dims.z) continue;
      float& value = values_[volume_.place(at)];
      if (std::abs(value) < known_) continue;
      const glm::dvec3 index(lo_ + at);
      const double d = many ? nearest_.distance(index, nearest_one_) : to_nearest(s, index);
      value = std::copysign(static_cast<float>(d * voxel_), value);
    }
  }

 private:
  [[nodiscard]] bool all_known(const glm::ivec3& first) const {
    const glm::ivec3 end = glm::min(first + kBrickEdge, volume_.dims);
    for (int z = first.z; z < end.z; ++z) {
      for (int y = first.y; y < end.y; ++y) {
        for (int x = first.x; x < end.x; ++x) {
          if (!(std::abs(values_[volume_.place({x, y, z})]) < known_)) return false;
        }
      }
    }
    return true;
  }
  void find_nearest(const glm::dvec3& center) {
    const std::size_t count = triangles_.size();
    frames_.resize(count);
    center_distance_.resize(32 * count);
    lists_.resize(32 * count);
    const double at[3] = {center.x, center.y, center.z};
    for (std::size_t i = 0; i < count; ++i) {
      brick_kernel().make_frame(nearest_.record(triangles_[i]), at, frames_[i]);
    }
    constexpr float kEverywhere = 1e6F;  // voxels
    brick_kernel().distances(frames_.data(), static_cast<std::int32_t>(count), kEverywhere,
                             Culling::exact, {center_distance_.data(), lists_.data()}, distances_);
  }
  // Again in double: far from the centre of a brick a frame's floats are a little off.
  [[nodiscard]] double to_nearest(int s, const glm::dvec3& index) const {
    const double at[3] = {index.x, index.y, index.z};
    const auto frame = static_cast<std::size_t>(distances_.nearest[s] >> 2);
    return std::sqrt(brick_kernel().squared_distance(nearest_.record(triangles_[frame]), at));
  }

  const NearestTriangle& nearest_;
  glm::ivec3 lo_;
  double voxel_;
  float known_;
  Volume& volume_;
  std::vector<float>& values_;
  std::uint32_t nearest_one_ = 0;  // to the centre of the last brick
  std::vector<std::uint32_t> triangles_;
  std::vector<TriangleFrame> frames_;
  std::vector<float> center_distance_;
  std::vector<std::int32_t> lists_;
  BrickDistances distances_;
};

void fill_exactly(const TriangleSoup& soup, const Lattice& lattice, const glm::ivec3& lo,
                  Volume& volume, const Job& job) {
  const NearestTriangle nearest(soup, lattice);
  const glm::ivec3 bricks = (volume.dims + (kBrickEdge - 1)) / kBrickEdge;
  for_each_row(bricks, job, [&](int y, int z) {
    const auto filler = std::make_unique<ExactFiller>(nearest, lo, lattice.voxel, volume);
    for (int x = 0; x < bricks.x; ++x) filler->fill(glm::ivec3(x, y, z) * kBrickEdge);
  });
}

// transform.h counts samples with the last axis fastest, volumes with the first.
void fill_by_transform(const TransformOptions& options, Volume& volume, const Job& job) {
  const auto& values = std::get<std::vector<float>>(volume.samples);
  DenseSeeds seeds;
  seeds.dims = {volume.dims.z, volume.dims.y, volume.dims.x};
  seeds.spacing = volume.spacing;
  seeds.values = values;
  seeds.kind = SeedKind::distance;
  std::vector<float> distances(volume.size());
  distance_transform(seeds, options, distances, job);
  volume.samples = std::move(distances);
}

void check_method(const TransformMethod& method, SignMethod sign) {
  const auto methods = transform_methods();
  const auto info = std::find_if(methods.begin(), methods.end(),
                                 [&](const auto& entry) { return entry.method == method; });
  if (!info->volumes || method == TransformMethod::antialiased) {
    throw Error(ErrorKind::usage, fmt::format("the method {} does no dense fields of meshes; use "
                                              "exact, fmm2 or cpm",
                                              info->name));
  }
  if (sign == SignMethod::no_sign) {
    throw Error(ErrorKind::usage, "dense fields without signs are made by the method exact only");
  }
}

}  // namespace

DenseConversion convert_dense(const TriangleSoup& soup, const ConvertOptions& options,
                              const Job& job) {
  if (options.transform) check_method(options.transform->method, options.sign);
  const Lattice lattice = choose_lattice(soup, options);
  const IndexBox box = index_box(bounds(soup), lattice, options.band.exwidth);
  DenseConversion result;
  result.distances = empty_volume(box, lattice);
  constexpr double kMarchingBytes = 24;
  check_memory(result.distances, options.transform ? kMarchingBytes : 2 * sizeof(float),
               options.max_memory);
  ConvertOptions narrow = options;
  narrow.transform.reset();
  narrow.band = {kSeedBand, kSeedBand};
  {
    const Conversion seeds = convert_mesh(soup, narrow, job);
    result.sign = seeds.sign;
    result.sign_reason = seeds.sign_reason;
    result.warnings = seeds.warnings;
    result.seconds = seeds.seconds;
    result.distances = to_volume(seeds.grid, box.lo, box.hi);
  }
  const auto start = std::chrono::steady_clock::now();
  if (options.transform) {
    check_method(options.transform->method, result.sign);
    fill_by_transform(*options.transform, result.distances, job);
  } else {
    fill_exactly(soup, lattice, box.lo, result.distances, job);
  }
  result.seconds.voxelize +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

Volume convert_dense(const Field& field, const FieldConvertOptions& options, const Job& job) {
  const Lattice lattice = choose_lattice(field, options);
  Volume volume = empty_volume(index_box(field.bounds(), lattice, options.band.exwidth), lattice);
  check_memory(volume, sizeof(float), options.max_memory);
  std::vector<float> values(volume.size());
  for_each_row(volume.dims, job, [&](int y, int z) {
    const auto count = static_cast<std::size_t>(volume.dims.x);
    std::vector<float> places(3 * count);
    for (std::size_t i = 0; i < count; ++i) {
      const glm::dvec3 at = volume.to_world({i, y, z});
      for (int a = 0; a < 3; ++a) {
        places[static_cast<std::size_t>(a) * count + i] = static_cast<float>(at[a]);
      }
    }
    field.evaluate(count, places.data(), places.data() + count, places.data() + 2 * count,
                   values.data() + volume.place({0, y, z}));
  });
  volume.samples = std::move(values);
  return volume;
}

}  // namespace sdfgrid
