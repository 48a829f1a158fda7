#include "sdfgrid/transform/antialiased.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/transform/coverage_corner.h"
#include "sdfgrid/transform/coverage_surface.h"
#include "sdfgrid/transform/dense_feature.h"
#include "sdfgrid/transform/dense_seeds.h"

namespace sdfgrid {
namespace {

// Distance that a sample has at least on its side of the surface, in units: it is not on it.
constexpr float kLeast = 1e-6F;

constexpr float kExplained = 1;  // voxels around its own in which a corner holds, along each axis

// A voxel that the surface may pass, and what is known of the surface there.
struct Candidate {
  glm::ivec3 at;
  std::optional<SurfacePatch> patch;
  std::optional<Corner> corner;  // of two or three planes; then the patch is its nearest point
};

class Antialiased {
 public:
  Antialiased(const DenseSeeds& seeds, TransformOptions options)
      : samples_(seeds), options_(std::move(options)), nearest_(count(seeds.dims)) {}

  void run(std::span<float> distance, const Job& job) {
    find_candidates(job);
    find_corners(job);
    fill_holes();
    keep_patches();
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
          const float d = to_surface(at, n);
          distance[n] = finish_distance(d, std::isnan(d) ? samples_.inside(n) : d < 0,
                                        samples_.unit(), options_);
        }
      }
    });
  }

 private:
  static std::size_t count(const glm::ivec3& dims) {
    return static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) *
           static_cast<std::size_t>(dims.z);
  }

  [[nodiscard]] glm::vec3 place(const glm::ivec3& at) const {
    return glm::vec3(at) * glm::vec3(samples_.spacing());
  }
  // Whether a point is nearer than so many voxels to a sample, along each axis.
  [[nodiscard]] bool is_near(const glm::vec3& point, const glm::ivec3& at, float voxels) const {
    const glm::vec3 away = glm::abs(point / glm::vec3(samples_.spacing()) - glm::vec3(at));
    return std::max({away.x, away.y, away.z}) <= voxels;
  }

  void find_candidates(const Job& job) {
    const auto slabs = static_cast<std::size_t>(samples_.dims().x);
    std::vector<std::vector<Candidate>> found(slabs);
    parallel_for(slabs, 1, job, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint8_t> beside_surface(static_cast<std::size_t>(samples_.dims().z));
      for (std::size_t x = begin; x < end; ++x) {
        for (int y = 0; y < samples_.dims().y; ++y) {
          samples_.seed_row(static_cast<int>(x), y, beside_surface.data());
          for (int z = 0; z < samples_.dims().z; ++z) {
            const glm::ivec3 at(x, y, z);
            if (beside_surface[static_cast<std::size_t>(z)] == 0 &&
                !is_cut_by_surface(samples_, at)) {
              continue;
            }
            found[x].push_back({at, surface_patch(samples_, at), std::nullopt});
          }
        }
      }
    });
    for (auto& slab : found) {
      candidates_.insert(candidates_.end(), slab.begin(), slab.end());
      slab = {};
    }
  }

  // Numbers the candidates that have a patch, in nearest_.
  void map_candidates() {
    std::fill(nearest_.begin(), nearest_.end(), kNoFeature);
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      if (!candidates_[i].patch) continue;
      nearest_[samples_.number(candidates_[i].at)] = static_cast<std::uint32_t>(i);
    }
  }
  [[nodiscard]] const SurfacePatch* patch_at(const glm::ivec3& at) const {
    if (!samples_.has(at)) return nullptr;
    const std::uint32_t i = nearest_[samples_.number(at)];
    return i == kNoFeature ? nullptr : &*candidates_[i].patch;
  }

  // Where heights do not lie in a plane, the planes around may meet.
  void find_corners(const Job& job) {
    map_candidates();
    std::vector<std::optional<Corner>> corners(candidates_.size());
    parallel_for(candidates_.size(), 64, job, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (is_smooth_around(candidates_[i].at)) continue;
        corners[i] = find_corner(samples_, candidates_[i].at,
                                 [&](const glm::ivec3& at) { return patch_at(at); });
      }
    });
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      if (corners[i]) set_corner(*corners[i], candidates_[i]);
    }
  }

  // Without an edge the patches in the voxels around look the same way.
  [[nodiscard]] bool is_smooth_around(const glm::ivec3& at) const {
    constexpr float kSameWay = 0.966F;  // 15 degrees, half of what planes must differ to meet
    const SurfacePatch* first = nullptr;
    bool same_way = true;
    bool smooth = true;
    for (int n = 0; n < 27 && (same_way || smooth); ++n) {
      const SurfacePatch* patch = patch_at(at + around(n));
      if (patch == nullptr) continue;
      if (first == nullptr) first = patch;
      same_way = same_way && glm::dot(first->normal, patch->normal) > kSameWay;
      smooth = smooth && is_smooth(*patch);
    }
    return same_way || smooth;
  }

  void set_corner(const Corner& corner, Candidate& candidate) const {
    const bool rough = candidate.patch && candidate.patch->misfit >= 1;
    if (corner.count == 1 && !rough) return;
    const glm::vec3 here = place(candidate.at);
    const CornerFoot foot = nearest_on(corner, here);
    candidate.patch.reset();
    if (!is_near(foot.point, candidate.at, 0.55F)) return;
    const float radius = corner.count > 1 ? 0 : kEdgeRadius;  // a disc would stick out at the edge
    candidate.patch = SurfacePatch{foot.point, foot.normal, 0, radius, 1};
    if (corner.count > 1) candidate.corner = corner;
  }

  // No voxel beside one on the other side is without a patch near it.
  void fill_holes() {
    map_candidates();
    for (Candidate& candidate : candidates_) {
      bool alone = true;
      for (int n = 0; alone && n < 27; ++n) alone = patch_at(candidate.at + around(n)) == nullptr;
      if (alone) candidate.patch = crossing_patch(samples_, candidate.at);
    }
  }

  static glm::ivec3 around(int n) { return {n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1}; }

  void keep_patches() {
    for (const Candidate& candidate : candidates_) {
      if (!candidate.patch) continue;
      const glm::vec3 middle(candidate.at);
      const glm::vec3 point = candidate.patch->point / glm::vec3(samples_.spacing());
      sites_.push_back({candidate.at, glm::clamp(point, middle - 0.5F, middle + 0.5F)});
      patches_.push_back(*candidate.patch);
      corner_of_.push_back(candidate.corner ? static_cast<std::uint32_t>(corners_.size())
                                            : kNoFeature);
      if (candidate.corner) corners_.push_back(*candidate.corner);
    }
    candidates_ = {};
  }

  // The patches of the voxels around each patch's.
  void find_neighbors() {
    std::fill(nearest_.begin(), nearest_.end(), kNoFeature);
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      nearest_[samples_.number(sites_[i].at)] = static_cast<std::uint32_t>(i);
    }
    first_.reserve(sites_.size() + 1);
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      first_.push_back(static_cast<std::uint32_t>(neighbors_.size()));
      bool beside_corner = corner_of_[i] != kNoFeature;
      for (int n = 0; n < 27; ++n) {
        const glm::ivec3 there = sites_[i].at + around(n);
        if (n == 13 || !samples_.has(there)) continue;
        const std::uint32_t other = nearest_[samples_.number(there)];
        if (other == kNoFeature) continue;
        neighbors_.push_back(other);
        beside_corner = beside_corner || corner_of_[other] != kNoFeature;
      }
      beside_corner_.push_back(beside_corner ? 1 : 0);
    }
    first_.push_back(static_cast<std::uint32_t>(neighbors_.size()));
  }

  // The signed distance from a sample. Not a number without a surface.
  [[nodiscard]] float to_surface(const glm::ivec3& at, std::size_t n) const {
    if (nearest_[n] == kNoFeature) return std::numeric_limits<float>::quiet_NaN();
    const glm::vec3 here = place(at);
    const std::uint32_t nearest = nearest_middle(here, nearest_[n]);
    const float side = samples_.inside(n) ? -1.0F : 1.0F;
    // Beside an edge, a voxel's middle may be on the other side than the greater part of it.
    const bool either_side = is_partly_covered(coverage_at(samples_, at));
    constexpr int kMostHops = 4;
    std::uint32_t patch = nearest;
    for (int hop = 0; beside_corner_[patch] != 0 && hop < kMostHops; ++hop) {
      const Found found = corner_beside(here, patch, either_side ? 0 : side);
      if (found.explained) return found.foot.distance;
      // The corner says where its nearest point is; the patches there may know better.
      const std::uint32_t next = patch_near(found.foot.point);
      if (next == patch) break;
      patch = next;
    }
    if (square_to(here, nearest) < square_to(here, patch)) patch = nearest;
    return side * std::max(distance_to(here, patches_[patch], side), kLeast);
  }

  // The patch whose middle is nearest: down the surface from the one that was found.
  [[nodiscard]] std::uint32_t nearest_middle(const glm::vec3& p, std::uint32_t found) const {
    std::uint32_t best = found;
    float least = square_to(p, best);
    for (std::uint32_t from = kNoFeature; from != best;) {
      from = best;
      for (std::uint32_t i = first_[from]; i < first_[from + 1]; ++i) {
        const float square = square_to(p, neighbors_[i]);
        if (square >= least) continue;
        least = square;
        best = neighbors_[i];
      }
    }
    return best;
  }

  struct Found {
    CornerFoot foot;
    bool explained = false;  // the foot is where the corner explains the coverage
  };

  // Of the corners known in and beside a patch's voxel one that explains its foot, of most planes:
  // it has those of the others; else the nearest. There is one. `side` is -1 for a sample that is
  // within the solid, 1 outside, 0 if it may be either.
  [[nodiscard]] Found corner_beside(const glm::vec3& p, std::uint32_t patch, float side) const {
    Found found;
    int planes = -1;
    float least = 0;
    const auto consider = [&](std::uint32_t beside) {
      if (corner_of_[beside] == kNoFeature) return;
      const Corner& corner = corners_[corner_of_[beside]];
      const CornerFoot foot = nearest_on(corner, p);
      const bool explained =
          foot.distance * side >= 0 && is_near(foot.point, sites_[beside].at, kExplained);
      const int rank = explained ? corner.count : 0;
      const float square = square_to(p, beside);
      if (rank < planes || (rank == planes && square >= least)) return;
      found = {foot, explained};
      planes = rank;
      least = square;
    };
    consider(patch);
    for (std::uint32_t i = first_[patch]; i < first_[patch + 1]; ++i) consider(neighbors_[i]);
    return found;
  }

  // A patch near a point of the surface.
  [[nodiscard]] std::uint32_t patch_near(const glm::vec3& point) const {
    const glm::ivec3 at(glm::round(point / glm::vec3(samples_.spacing())));
    return nearest_[samples_.number(glm::clamp(at, glm::ivec3(0), samples_.dims() - 1))];
  }

  [[nodiscard]] float square_to(const glm::vec3& p, std::uint32_t patch) const {
    const glm::vec3 d = p - patches_[patch].point;
    return glm::dot(d, d);
  }

  // From a sample on this side (-1 inside, 1 outside), below zero on the other. Straight to the
  // ball that has the patch's curvature, where that meets it within the patch; else to the rim of
  // the flat patch.
  [[nodiscard]] static float distance_to(const glm::vec3& p, const SurfacePatch& patch,
                                         float side) {
    const glm::vec3 d = p - patch.point;
    const float height = glm::dot(d, patch.normal);
    const float square = glm::dot(d, d);
    const float beside = std::sqrt(std::max(square - height * height, 0.0F));
    const float radius = patch.radius;
    const float k = patch.curvature;
    const float shrink = 1 + k * height;  // from beside the patch's middle to beside it on the ball
    if (beside <= radius * shrink) {
      return side * (2 * height + k * square) /
             (1 + std::sqrt(std::max(1 + 2 * k * height + k * k * square, 0.0F)));
    }
    if (beside <= radius) return side * height;
    const float rim = beside - radius;
    return std::sqrt(height * height + rim * rim);
  }

  SignedSamples samples_;
  TransformOptions options_;
  std::vector<Candidate> candidates_;
  std::vector<Site> sites_;
  std::vector<SurfacePatch> patches_;     // by site
  std::vector<std::uint32_t> corner_of_;  // by site
  std::vector<Corner> corners_;
  std::vector<std::uint32_t> neighbors_;  // of site i from first_[i] to first_[i + 1]
  std::vector<std::uint32_t> first_;
  std::vector<char> beside_corner_;  // by site: it or one of its neighbours has a corner
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
