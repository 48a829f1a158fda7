#include "sdfgrid/transform/antialiased.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/transform/coverage_surface.h"
#include "sdfgrid/transform/dense_feature.h"
#include "sdfgrid/transform/dense_seeds.h"

namespace sdfgrid {
namespace {

// Distance that a sample has at least on its side of the surface, in units: it is not on it.
constexpr float kLeast = 1e-6F;

class Antialiased {
 public:
  Antialiased(const DenseSeeds& seeds, TransformOptions options)
      : samples_(seeds), options_(std::move(options)), nearest_(count(seeds.dims)) {}

  void run(std::span<float> distance, const Job& job) {
    find_patches(job);
    find_neighbors();
    find_nearest_sites(samples_.dims(), samples_.spacing(), sites_, nearest_, job);
    const auto rows =
        static_cast<std::size_t>(samples_.dims().x) * static_cast<std::size_t>(samples_.dims().y);
    parallel_for(rows, 64, job, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        const auto ny = static_cast<std::size_t>(samples_.dims().y);
        glm::ivec3 at(row / ny, row % ny, 0);
        for (; at.z < samples_.dims().z; ++at.z) {
          const std::size_t n = samples_.number(at);
          const bool inside = samples_.inside(n);
          distance[n] =
              finish_distance(to_surface(at, n, inside), inside, samples_.unit(), options_);
        }
      }
    });
  }

 private:
  static std::size_t count(const glm::ivec3& dims) {
    return static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) *
           static_cast<std::size_t>(dims.z);
  }

  [[nodiscard]] Site site_of(const glm::ivec3& at, const SurfacePatch& patch) const {
    const glm::vec3 middle(at);
    const glm::vec3 point = patch.point / glm::vec3(samples_.spacing());
    return {at, glm::clamp(point, middle - 0.5F, middle + 0.5F)};
  }

  void find_patches(const Job& job) {
    const auto slabs = static_cast<std::size_t>(samples_.dims().x);
    std::vector<std::vector<SurfacePatch>> patches(slabs);
    std::vector<std::vector<Site>> sites(slabs);
    parallel_for(slabs, 1, job, [&](std::size_t begin, std::size_t end) {
      for (std::size_t x = begin; x < end; ++x) {
        for (int y = 0; y < samples_.dims().y; ++y) {
          for (int z = 0; z < samples_.dims().z; ++z) {
            const glm::ivec3 at(x, y, z);
            const auto patch = surface_patch(samples_, at);
            if (!patch) continue;
            patches[x].push_back(*patch);
            sites[x].push_back(site_of(at, *patch));
          }
        }
      }
    });
    for (std::size_t x = 0; x < slabs; ++x) {
      patches_.insert(patches_.end(), patches[x].begin(), patches[x].end());
      sites_.insert(sites_.end(), sites[x].begin(), sites[x].end());
    }
  }

  // The patches of the voxels around each patch's.
  void find_neighbors() {
    std::fill(nearest_.begin(), nearest_.end(), kNoFeature);
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      nearest_[samples_.number(sites_[i].at)] = static_cast<std::uint32_t>(i);
    }
    first_.reserve(sites_.size() + 1);
    for (const Site& site : sites_) {
      first_.push_back(static_cast<std::uint32_t>(neighbors_.size()));
      for (int n = 0; n < 27; ++n) {
        const glm::ivec3 there = site.at + glm::ivec3(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
        if (n == 13 || !samples_.has(there)) continue;
        const std::uint32_t other = nearest_[samples_.number(there)];
        if (other != kNoFeature) neighbors_.push_back(other);
      }
    }
    first_.push_back(static_cast<std::uint32_t>(neighbors_.size()));
  }

  // The distance to the patch whose middle is nearest: down the surface from the one that was
  // found. Not a number without a surface.
  [[nodiscard]] float to_surface(const glm::ivec3& at, std::size_t n, bool inside) const {
    if (nearest_[n] == kNoFeature) return std::numeric_limits<float>::quiet_NaN();
    const glm::vec3 here = glm::vec3(at) * glm::vec3(samples_.spacing());
    std::uint32_t best = nearest_[n];
    float least = square_to(here, best);
    for (std::uint32_t from = kNoFeature; from != best;) {
      from = best;
      for (std::uint32_t i = first_[from]; i < first_[from + 1]; ++i) {
        const float square = square_to(here, neighbors_[i]);
        if (square >= least) continue;
        least = square;
        best = neighbors_[i];
      }
    }
    return distance_to(here, patches_[best], inside);
  }

  [[nodiscard]] float square_to(const glm::vec3& p, std::uint32_t patch) const {
    const glm::vec3 d = p - patches_[patch].point;
    return glm::dot(d, d);
  }

  // Straight to the ball that has the patch's curvature, where that meets it within the patch; else
  // to the rim of the flat patch.
  [[nodiscard]] float distance_to(const glm::vec3& p, const SurfacePatch& patch,
                                  bool inside) const {
    const glm::vec3 d = p - patch.point;
    const float height = glm::dot(d, patch.normal);
    const float square = glm::dot(d, d);
    const float beside = std::sqrt(std::max(square - height * height, 0.0F));
    const float radius = patch.radius;
    const float k = patch.curvature;
    const float shrink = 1 + k * height;  // from beside the patch's middle to beside it on the ball
    float signed_distance = height;
    if (beside <= radius * shrink) {
      signed_distance = (2 * height + k * square) /
                        (1 + std::sqrt(std::max(1 + 2 * k * height + k * k * square, 0.0F)));
    } else if (beside > radius) {
      const float rim = beside - radius;
      signed_distance = std::copysign(std::sqrt(height * height + rim * rim), height);
    }
    return std::max(inside ? -signed_distance : signed_distance, kLeast);
  }

  SignedSamples samples_;
  TransformOptions options_;
  std::vector<Site> sites_;
  std::vector<SurfacePatch> patches_;     // by site
  std::vector<std::uint32_t> neighbors_;  // of site i from first_[i] to first_[i + 1]
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> nearest_;
};

}  // namespace

void antialiased_transform(const DenseSeeds& seeds, const TransformOptions& options,
                           std::span<float> distance, const Job& job) {
  if (seeds.mask.empty() && seeds.kind != SeedKind::coverage) {
    throw Error(ErrorKind::usage, "the antialiased method takes masks and coverage");
  }
  Antialiased(seeds, options).run(distance, job);
}

}  // namespace sdfgrid
