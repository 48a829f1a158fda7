#include "sdfgrid/transform/coverage_corner.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <vector>

namespace sdfgrid {
namespace {

constexpr int kReach = 4;              // voxels to the planes of faces
constexpr std::size_t kMostFaces = 8;  // planes that are tried
constexpr float kFlat = 0.15F;         // a patch whose heights are nearer to it shows a face
constexpr float kAway = 0.015F;        // of that, for which one is taken from a voxel nearer
constexpr float kSmooth = 0.04F;       // and one that needs no corner
constexpr float kSameFace = 0.99F;     // cosine between normals
constexpr float kSameHeight = 0.1F;    // units
constexpr float kMeet = 0.87F;         // planes at a larger cosine than that do not meet in an edge
// How far the coverage of a voxel may be from a corner's, and how much further of each step away:
// curved faces leave their planes.
constexpr double kMisfit = 0.06;
constexpr double kMisfitAway = 0.05;
constexpr double kGain = 0.5;  // of that, which a further plane must gain

float height_over(const Corner::Plane& plane, const glm::vec3& p) {
  return glm::dot(plane.normal, p - plane.point);
}

// The nearest point of what all half-spaces share, from a point outside of it.
class Projection {
 public:
  Projection(const Corner& corner, const glm::vec3& p, float sign) : p_(p), count_(corner.count) {
    for (int i = 0; i < count_; ++i) {
      const Corner::Plane& plane = corner.planes[static_cast<std::size_t>(i)];
      normal_[i] = sign * plane.normal;
      height_[i] = sign * height_over(plane, p);
    }
  }

  glm::vec3 find() {
    for (int i = 0; i < count_; ++i) {
      try_step(height_[i] * normal_[i]);
      for (int j = 0; j < i; ++j) try_edge(i, j);
    }
    if (count_ == 3) try_point();
    return p_ - best_;
  }

 private:
  static constexpr float kSlack = 1e-4F;

  void try_step(const glm::vec3& step) {
    const float square = glm::dot(step, step);
    if (square >= least_) return;
    for (int i = 0; i < count_; ++i) {
      if (height_[i] - glm::dot(normal_[i], step) > kSlack) return;
    }
    least_ = square;
    best_ = step;
  }
  void try_edge(int i, int j) {
    const float c = glm::dot(normal_[i], normal_[j]);
    const float d = 1 - c * c;
    if (d < 0.05F) return;
    const float a = (height_[i] - c * height_[j]) / d;
    const float b = (height_[j] - c * height_[i]) / d;
    try_step(a * normal_[i] + b * normal_[j]);
  }
  void try_point() {
    const glm::mat3 normals(normal_[0], normal_[1], normal_[2]);  // as columns
    if (std::abs(glm::determinant(normals)) < 0.05F) return;
    try_step(glm::inverse(glm::transpose(normals)) * glm::vec3(height_[0], height_[1], height_[2]));
  }

  glm::vec3 p_;
  int count_;
  glm::vec3 normal_[3];
  float height_[3] = {0, 0, 0};
  glm::vec3 best_{0};
  float least_ = 1e30F;
};

// Planes of the faces around a voxel, each once.
class Faces {
 public:
  Faces(const glm::vec3& middle, const glm::ivec3& at, const PatchAt& patch_at) : middle_(middle) {
    struct Seen {
      float rank;
      const SurfacePatch* patch;
    };
    std::vector<Seen> seen;
    for (const glm::ivec3& offset : nearest_first()) {
      const SurfacePatch* patch = patch_at(at + offset);
      if (patch == nullptr || patch->misfit > kFlat) continue;
      seen.push_back({patch->misfit + kAway * glm::length(glm::vec3(offset)), patch});
    }
    std::stable_sort(seen.begin(), seen.end(),
                     [](const Seen& a, const Seen& b) { return a.rank < b.rank; });
    for (const Seen& one : seen) add(*one.patch);
  }

  [[nodiscard]] int count() const { return static_cast<int>(faces_.size()); }

  // Those of these numbers as a corner; nothing if they do not make one.
  [[nodiscard]] std::optional<Corner> corner(std::span<const int> numbers) const {
    Corner corner;
    int bulges = 0;
    int pairs = 0;
    bool meet = numbers.size() == 1;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const Face& face = faces_[static_cast<std::size_t>(numbers[i])];
      for (std::size_t j = 0; j < i; ++j) {
        const Face& other = faces_[static_cast<std::size_t>(numbers[j])];
        const float c = glm::dot(face.plane.normal, other.plane.normal);
        if (c > kMeet) return std::nullopt;
        meet = meet || c > -kMeet;
        const bool below = height_over(face.plane, other.seen) < 0;
        if (below != (height_over(other.plane, face.seen) < 0)) return std::nullopt;
        bulges += below ? 1 : 0;
        ++pairs;
      }
      corner.planes[i] = face.plane;
    }
    if (!meet || (bulges != 0 && bulges != pairs)) return std::nullopt;
    corner.count = static_cast<int>(numbers.size());
    corner.hollow = bulges == 0 && pairs > 0;
    return corner;
  }

 private:
  static const std::vector<glm::ivec3>& nearest_first() {
    static const std::vector<glm::ivec3> offsets = [] {
      std::vector<glm::ivec3> all;
      for (int x = -kReach; x <= kReach; ++x) {
        for (int y = -kReach; y <= kReach; ++y) {
          for (int z = -kReach; z <= kReach; ++z) all.emplace_back(x, y, z);
        }
      }
      std::stable_sort(all.begin(), all.end(), [](const glm::ivec3& a, const glm::ivec3& b) {
        return a.x * a.x + a.y * a.y + a.z * a.z < b.x * b.x + b.y * b.y + b.z * b.z;
      });
      return all;
    }();
    return offsets;
  }

  struct Face {
    Corner::Plane plane;
    glm::vec3 seen;  // where its patch is
  };

  // The plane that touches the patch's surface, as it bends, beside the voxel's middle. The nearest
  // patch stands for its face.
  void add(const SurfacePatch& patch) {
    const glm::vec3 away = middle_ - patch.point;
    const glm::vec3 bend = patch.bend * away;
    const glm::vec3 slope = patch.normal + bend;
    const float length = glm::length(slope);
    const float height = glm::dot(patch.normal + 0.5F * bend, away) / length;
    const glm::vec3 normal = slope / length;
    for (const auto& [plane, seen] : faces_) {
      if (glm::dot(plane.normal, normal) < kSameFace) continue;
      if (std::abs(height_over(plane, middle_) - height) < kSameHeight) return;
    }
    if (faces_.size() < kMostFaces)
      faces_.push_back({{middle_ - height * normal, normal}, patch.point});
  }

  glm::vec3 middle_;
  std::vector<Face> faces_;
};

// How well corners explain the coverage of a voxel and of those around it.
class Fit {
 public:
  Fit(const SignedSamples& samples, const glm::ivec3& at) : spacing_(samples.spacing()) {
    for (int n = 0; n < 27; ++n) {
      // The middle one first, which tells most of them apart.
      const int m = n == 0 ? 13 : n <= 13 ? n - 1 : n;
      const glm::ivec3 there = at + glm::ivec3(m / 9 - 1, m / 3 % 3 - 1, m % 3 - 1);
      if (!samples.has(there)) continue;
      const glm::ivec3 away = glm::abs(there - at);
      tolerance_[count_] = kMisfit + kMisfitAway * (away.x + away.y + away.z);
      middles_[count_] = glm::dvec3(there) * spacing_;
      coverages_[count_] = coverage_at(samples, there);
      ++count_;
    }
  }

  // Takes the corner if it fits better than the best one.
  void consider(const Corner& corner) {
    const double handicap = 1 + kGain * (corner.count - 1);
    double sum = 0;
    for (int n = 0; n < count_; ++n) {
      const double covered = covered_by(corner, middles_[n], spacing_);
      const double misfit = std::abs(covered - coverages_[n]) / tolerance_[n];
      if (misfit > 1) return;
      sum += misfit * misfit;
      if (sum * handicap >= least_) return;
    }
    least_ = sum * handicap;
    best_ = corner;
  }
  [[nodiscard]] const std::optional<Corner>& best() const { return best_; }

 private:
  glm::dvec3 spacing_;
  int count_ = 0;
  glm::dvec3 middles_[27];
  double coverages_[27] = {};
  double tolerance_[27] = {};
  double least_ = 1e30;
  std::optional<Corner> best_;
};

}  // namespace

bool is_smooth(const SurfacePatch& patch) { return patch.misfit < kSmooth; }

CornerFoot nearest_on(const Corner& corner, const glm::vec3& p) {
  // A hollow corner is the complement of what the turned half-spaces share.
  const float sign = corner.hollow ? -1.0F : 1.0F;
  float highest = -1e30F;
  glm::vec3 normal(0);
  for (int i = 0; i < corner.count; ++i) {
    const Corner::Plane& plane = corner.planes[static_cast<std::size_t>(i)];
    const float height = sign * height_over(plane, p);
    if (height <= highest) continue;
    highest = height;
    normal = plane.normal;
  }
  if (highest <= 0) return {sign * highest, p - sign * highest * normal, normal};
  const glm::vec3 foot = Projection(corner, p, sign).find();
  return {sign * glm::distance(p, foot), foot, normal};
}

// In 64 parts: each plane takes its share of a part as if it were as far tilted as possible, and
// the shares of several are multiplied.
double covered_by(const Corner& corner, const glm::dvec3& middle, const glm::dvec3& sides) {
  constexpr int kParts = 4;
  constexpr double kAll = kParts * kParts * kParts;
  const double sign = corner.hollow ? -1 : 1;
  std::array<double, kParts * kParts * kParts> parts;
  parts.fill(1);
  for (int i = 0; i < corner.count; ++i) {
    const Corner::Plane& plane = corner.planes[static_cast<std::size_t>(i)];
    const glm::dvec3 normal = sign * glm::dvec3(plane.normal);
    const glm::dvec3 step = normal * sides / static_cast<double>(kParts);
    const double across = std::abs(step.x) + std::abs(step.y) + std::abs(step.z);
    const double height = glm::dot(normal, middle - glm::dvec3(plane.point));
    if (height > 0.5 * kParts * across) return corner.hollow ? 1 : 0;
    if (height < -0.5 * kParts * across) continue;
    const double first = height - 0.5 * (kParts - 1) * (step.x + step.y + step.z);
    for (int n = 0; n < kParts * kParts * kParts; ++n) {
      const glm::dvec3 part(n / (kParts * kParts), n / kParts % kParts, n % kParts);
      const double there = first + glm::dot(part, step);
      parts[static_cast<std::size_t>(n)] *= std::clamp(0.5 - there / across, 0.0, 1.0);
    }
  }
  double sum = 0;
  for (const double part : parts) sum += part;
  return corner.hollow ? 1 - sum / kAll : sum / kAll;
}

std::optional<Corner> find_corner(const SignedSamples& samples, const glm::ivec3& at,
                                  const PatchAt& patch_at) {
  const Faces faces(glm::vec3(glm::dvec3(at) * samples.spacing()), at, patch_at);
  const int count = faces.count();
  if (count == 0) return std::nullopt;
  Fit fit(samples, at);
  const auto consider = [&](std::initializer_list<int> numbers) {
    const std::optional<Corner> corner = faces.corner({numbers.begin(), numbers.size()});
    if (corner) fit.consider(*corner);
  };
  for (int i = 0; i < count; ++i) consider({i});
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < i; ++j) {
      consider({i, j});
      for (int k = 0; k < j; ++k) consider({i, j, k});
    }
  }
  return fit.best();
}

}  // namespace sdfgrid
