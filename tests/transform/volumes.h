// tests/transform/volumes.h: small volumes with known distances.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <random>
#include <vector>

#include "sdfgrid/transform/transform.h"

namespace sdfgrid {

struct Shape {
  glm::ivec3 dims;
  glm::dvec3 spacing{1.0};

  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(dims.x) * dims.y * dims.z;
  }
  [[nodiscard]] std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * dims.y + j) * dims.z + k;
  }
};

struct Mask : Shape {
  std::vector<std::uint8_t> mask{};
  [[nodiscard]] DenseSeeds seeds() const { return {dims, spacing, mask}; }
};

struct Values : Shape {
  std::vector<float> values{};
  [[nodiscard]] DenseSeeds seeds(SeedKind kind) const { return {dims, spacing, {}, values, kind}; }
};

inline Mask noise(const glm::ivec3& dims, double density, unsigned seed) {
  Mask v{{dims}};
  std::mt19937 random(seed);
  v.mask.resize(v.size());
  for (auto& m : v.mask) m = std::uniform_real_distribution<>(0, 1)(random) < density ? 7 : 0;
  return v;
}

// The function at every sample, of its position from the middle of the volume.
inline Values sampled(const Shape& shape, const std::function<double(const glm::dvec3&)>& f) {
  Values v{shape};
  const glm::dvec3 middle = 0.5 * glm::dvec3(shape.dims - 1) * shape.spacing;
  // Off the middle, so that nothing is right by symmetry.
  const glm::dvec3 off = shape.spacing * glm::dvec3(0.13, 0.29, -0.31);
  for (int i = 0; i < shape.dims.x; ++i) {
    for (int j = 0; j < shape.dims.y; ++j) {
      for (int k = 0; k < shape.dims.z; ++k) {
        v.values.push_back(
            static_cast<float>(f(glm::dvec3(i, j, k) * shape.spacing - middle + off)));
      }
    }
  }
  return v;
}

inline double ball(const glm::dvec3& p, double radius) { return glm::length(p) - radius; }

inline double box(const glm::dvec3& p, double half) {
  const glm::dvec3 q = glm::dvec3(std::abs(p.x), std::abs(p.y), std::abs(p.z)) - half;
  const glm::dvec3 out(std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0));
  return glm::length(out) + std::min(0.0, std::max({q.x, q.y, q.z}));
}

inline Mask mask_of(const Values& v) {
  Mask m{{v.dims, v.spacing}};
  for (const float x : v.values) m.mask.push_back(x < 0 ? 1 : 0);
  return m;
}

inline Mask ball_mask(const glm::ivec3& dims, double radius) {
  return mask_of(sampled({dims}, [&](const glm::dvec3& p) { return ball(p, radius); }));
}

inline std::vector<float> transformed(const DenseSeeds& seeds, const TransformOptions& options) {
  const std::size_t count = std::max(seeds.mask.size(), seeds.values.size());
  std::vector<float> distance(count, 12345.0F);
  distance_transform(seeds, options, distance, Job{});
  return distance;
}

struct Errors {
  double mean = 0;
  double max = 0;
};

// In voxels, against the exact values of the seeds.
inline Errors errors(const std::vector<float>& distance, const Values& exact) {
  const double unit = std::min({exact.spacing.x, exact.spacing.y, exact.spacing.z});
  Errors e;
  for (std::size_t i = 0; i < distance.size(); ++i) {
    const double d =
        std::abs(static_cast<double>(distance[i]) - static_cast<double>(exact.values[i])) / unit;
    e.mean += d / static_cast<double>(distance.size());
    e.max = std::max(e.max, d);
  }
  return e;
}

}  // namespace sdfgrid
