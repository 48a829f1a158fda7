#include "sdfgrid/transform/dense_marching.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "sdfgrid/transform/dense_seeds.h"
#include "sdfgrid/transform/marching.h"

namespace sdfgrid {
namespace {

class DenseMarch {
 public:
  DenseMarch(const DenseSeeds& seeds, const TransformOptions& options)
      : samples_(seeds), options_(options), march_(march_options()) {}

  void run(std::span<float> distance, const Job& job) {
    make_bricks();
    for (std::uint32_t brick = 1; brick < march_.field().size(); ++brick) {
      if (brick % 256 == 0) job.checkpoint();
      seed_brick(brick);
    }
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
    for (std::uint32_t brick = 1; brick < march_.field().size(); ++brick) {
      if (brick % 256 == 0) job.checkpoint();
      for_each_sample(brick, [&](std::uint32_t sample, const glm::ivec3& at) {
        const std::size_t n = samples_.number(at);
        distance[n] =
            finish_distance(march_.value(sample), samples_.inside(n), samples_.unit(), options_);
      });
    }
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

  void make_bricks() {
    const glm::ivec3 bricks = (samples_.dims() + 7) / 8;
    for (int x = 0; x < bricks.x; ++x) {
      for (int y = 0; y < bricks.y; ++y) {
        for (int z = 0; z < bricks.z; ++z) march_.field().make({x, y, z});
      }
    }
    march_.reserve();
  }

  // Visits the samples of a brick that are in the volume, and blocks the others.
  template <class Visit>
  void for_each_sample(std::uint32_t brick, const Visit& visit) {
    const glm::ivec3 lo = march_.field().coordinate(brick) * 8;
    std::uint32_t sample = brick * 512;
    for (int x = 0; x < 8; ++x) {
      for (int y = 0; y < 8; ++y) {
        for (int z = 0; z < 8; ++z, ++sample) {
          const glm::ivec3 at = lo + glm::ivec3(x, y, z);
          if (samples_.has(at)) {
            visit(sample, at);
          } else {
            march_.block(sample);
          }
        }
      }
    }
  }

  void seed_brick(std::uint32_t brick) {
    for_each_sample(brick, [&](std::uint32_t sample, const glm::ivec3& at) {
      SurfaceSeed seed{};
      if (!samples_.seed(at, seed)) return;
      // A zero keeps its side by its sign.
      const float signed_distance =
          std::copysign(seed.distance, samples_.inside(samples_.number(at)) ? -1.0F : 1.0F);
      march_.seed(sample, signed_distance, static_cast<std::uint32_t>(points_.size()));
      if (options_.method != TransformMethod::closest_point) return;
      points_.push_back(glm::vec3(at) * glm::vec3(samples_.spacing()) + seed.to_point);
    });
  }

  SignedSamples samples_;
  TransformOptions options_;
  March march_;
  std::vector<glm::vec3> points_;  // of the surface, nearest to each seed
};

}  // namespace

void march_dense(const DenseSeeds& seeds, const TransformOptions& options,
                 std::span<float> distance, const Job& job) {
  DenseMarch(seeds, options).run(distance, job);
}

}  // namespace sdfgrid
