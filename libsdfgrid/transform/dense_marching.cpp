#include "sdfgrid/transform/dense_marching.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

#include "sdfgrid/core/error.h"
#include "sdfgrid/transform/dense_seeds.h"
#include "sdfgrid/transform/marching.h"

namespace sdfgrid {
namespace {

class DenseMarch {
 public:
  DenseMarch(const DenseSeeds& seeds, TransformOptions options)
      : samples_(seeds),
        options_(std::move(options)),
        march_(march_options(), DenseField(seeds.dims)) {}

  void run(std::span<float> distance, const Job& job) {
    march_.reserve();
    for_each_row(job, [&](int x, int y) { seed(x, y); });
    block_border();
    if (options_.method == TransformMethod::closest_point) {
      const glm::vec3 spacing(samples_.spacing());
      march_.run_sources(
          [&](const glm::ivec3& at, std::uint32_t source) {
            return glm::distance(glm::vec3(at) * spacing, points_[source]);
          },
          job);
    } else {
      march_.run(job);
    }
    for_each_row(job, [&](int x, int y) {
      const std::uint32_t first = march_.field().sample({x, y, 0});
      const std::size_t n = samples_.number({x, y, 0});
      for (std::uint32_t z = 0; z < static_cast<std::uint32_t>(samples_.dims().z); ++z) {
        distance[n + z] = finish_distance(march_.value(first + z), samples_.inside(n + z),
                                          samples_.unit(), options_);
      }
    });
  }

 private:
  [[nodiscard]] MarchOptions march_options() const {
    MarchOptions march;
    march.order = options_.method == TransformMethod::fmm2 ? 2 : 1;
    march.spacing = samples_.spacing();
    march.bucket_width = options_.bucket_width;
    march.sources = options_.method == TransformMethod::closest_point;
    const double limit = options_.window > 0 ? options_.window : 1e30;
    march.out_limit = options_.side == TransformSide::inside ? 0 : limit;
    march.in_limit = options_.side == TransformSide::outside ? 0 : limit;
    return march;
  }

  // Visits the rows along z.
  template <class Visit>
  void for_each_row(const Job& job, const Visit& visit) const {
    for (int x = 0; x < samples_.dims().x; ++x) {
      job.checkpoint();
      for (int y = 0; y < samples_.dims().y; ++y) visit(x, y);
    }
  }

  void block_border() {
    constexpr int kBorder = DenseField::kBorder;
    const glm::ivec3& dims = samples_.dims();
    for (int x = -kBorder; x < dims.x + kBorder; ++x) {
      for (int y = -kBorder; y < dims.y + kBorder; ++y) {
        const bool row = x < 0 || y < 0 || x >= dims.x || y >= dims.y;
        for (int z = -kBorder; z < dims.z + kBorder; ++z) {
          if (!row && z == 0) z = dims.z;
          march_.block(march_.field().sample({x, y, z}));
        }
      }
    }
  }

  void seed(int x, int y) {
    may_seed_.resize(static_cast<std::size_t>(samples_.dims().z));
    samples_.seed_row(x, y, may_seed_.data());
    for (int z = 0; z < samples_.dims().z; ++z) {
      const glm::ivec3 at(x, y, z);
      SurfaceSeed seed{};
      if (may_seed_[static_cast<std::size_t>(z)] == 0 || !samples_.seed(at, seed)) continue;
      // A zero keeps its side by its sign.
      const float signed_distance =
          std::copysign(seed.distance, samples_.inside(samples_.number(at)) ? -1.0F : 1.0F);
      march_.seed(march_.field().sample(at), signed_distance,
                  static_cast<std::uint32_t>(points_.size()));
      if (options_.method != TransformMethod::closest_point) continue;
      points_.push_back(glm::vec3(at) * glm::vec3(samples_.spacing()) + seed.to_point);
    }
  }

  SignedSamples samples_;
  TransformOptions options_;
  March<DenseField> march_;
  std::vector<std::uint8_t> may_seed_;  // of one row
  std::vector<glm::vec3> points_;       // of the surface, nearest to each seed
};

}  // namespace

void march_dense(const DenseSeeds& seeds, const TransformOptions& options,
                 std::span<float> distance, const Job& job) {
  if (DenseField::samples(seeds.dims) > DenseField::kMostSamples) {
    throw Error(ErrorKind::usage, "marching takes volumes of up to 2^31 samples; use meijster");
  }
  DenseMarch(seeds, options).run(distance, job);
}

}  // namespace sdfgrid
