#include "sdfgrid/transform/dense_seeds.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

namespace sdfgrid {
namespace {

// Given distances are taken for right up to here, in units: two layers of samples on each side are
// what second-order stencils need.
constexpr float kTrusted = 2;

}  // namespace

SignedSamples::SignedSamples(const DenseSeeds& seeds) : seeds_(seeds) {
  const glm::dvec3& s = seeds.spacing;
  unit_ = std::min({s.x, s.y, s.z});
  spacing_ = s / unit_;
  if (seeds.kind == SeedKind::distance) scale_ = static_cast<float>(1 / unit_);
}

void SignedSamples::inside_row(std::size_t first, std::uint8_t* inside) const {
  const auto count = static_cast<std::size_t>(seeds_.dims.z);
  if (!seeds_.mask.empty()) {
    const std::uint8_t* mask = seeds_.mask.data() + first;
    for (std::size_t k = 0; k < count; ++k) inside[k] = mask[k] != 0 ? 1 : 0;
    return;
  }
  const float* v = seeds_.values.data() + first;
  if (seeds_.kind == SeedKind::coverage) {
    for (std::size_t k = 0; k < count; ++k) inside[k] = v[k] > 0.5F ? 1 : 0;
  } else {
    for (std::size_t k = 0; k < count; ++k) inside[k] = v[k] < 0 ? 1 : 0;
  }
}

void SignedSamples::seed_row(int x, int y, std::uint8_t* may) const {
  const auto count = static_cast<std::size_t>(dims().z);
  std::vector<std::uint8_t> here(count);
  std::vector<std::uint8_t> beside(count);
  inside_row(number({x, y, 0}), here.data());
  may[0] = 0;
  for (std::size_t k = 1; k < count; ++k) {
    may[k] = here[k] != here[k - 1] ? 1 : 0;
    if (may[k] != 0) may[k - 1] = 1;
  }
  for (const glm::ivec3 row :
       {glm::ivec3(x - 1, y, 0), {x + 1, y, 0}, {x, y - 1, 0}, {x, y + 1, 0}}) {
    if (!has(row)) continue;
    inside_row(number(row), beside.data());
    for (std::size_t k = 0; k < count; ++k) {
      may[k] = static_cast<std::uint8_t>(may[k] | (here[k] ^ beside[k]));
    }
  }
  if (seeds_.values.empty() || seeds_.kind != SeedKind::distance) return;
  const float* values = seeds_.values.data() + number({x, y, 0});
  for (std::size_t k = 0; k < count; ++k) {
    may[k] = std::abs(values[k] * scale_) < kTrusted ? 1 : may[k];
  }
}

glm::dvec3 SignedSamples::gradient(const glm::ivec3& at) const {
  glm::dvec3 g(0);
  for (int axis = 0; axis < 3; ++axis) {
    glm::ivec3 low = at;
    glm::ivec3 high = at;
    if (at[axis] > 0) --low[axis];
    if (at[axis] + 1 < dims()[axis]) ++high[axis];
    const int steps = high[axis] - low[axis];
    if (steps == 0) continue;
    g[axis] = (static_cast<double>(value(number(high))) - static_cast<double>(value(number(low)))) /
              (steps * spacing_[axis]);
  }
  return g;
}

bool SignedSamples::seed(const glm::ivec3& at, SurfaceSeed& seed) const {
  const std::size_t here = number(at);
  const float v = value(here);
  const bool is_inside = v < 0;
  const std::array<std::size_t, 3> stride = {
      static_cast<std::size_t>(dims().y) * static_cast<std::size_t>(dims().z),
      static_cast<std::size_t>(dims().z), 1};
  bool crossed = false;
  glm::dvec3 inverse(0);  // one over the steps to the crossings along the axes
  for (int axis = 0; axis < 3; ++axis) {
    for (const int way : {-1, 1}) {
      const int there = at[axis] + way;
      if (there < 0 || there >= dims()[axis]) continue;
      const float w = value(way < 0 ? here - stride[static_cast<std::size_t>(axis)]
                                    : here + stride[static_cast<std::size_t>(axis)]);
      if ((w < 0) == is_inside) continue;
      crossed = true;
      const double part =
          static_cast<double>(v) / (static_cast<double>(v) - static_cast<double>(w));
      const double step = std::max(part * spacing_[axis], 1e-6);
      if (1 / step > std::abs(inverse[axis])) inverse[axis] = way / step;
    }
  }
  if (!seeds_.values.empty() && seeds_.kind == SeedKind::distance) {
    if (!crossed && !(std::abs(v) < kTrusted)) return false;
    const glm::dvec3 g = gradient(at);
    const double length = glm::length(g);
    seed.distance = v;
    seed.to_point = length > 0 ? glm::vec3(g * (-static_cast<double>(v) / length)) : glm::vec3(0);
    return true;
  }
  if (!crossed) return false;
  // The plane through the crossings: its distance is 1 / |inverse|, along inverse.
  const double square = glm::dot(inverse, inverse);
  const auto distance = static_cast<float>(1 / std::sqrt(square));
  seed.distance = is_inside ? -distance : distance;
  seed.to_point = glm::vec3(inverse / square);
  return true;
}

float finish_distance(float signed_units, bool inside, double unit,
                      const TransformOptions& options) {
  if (options.side == TransformSide::outside && inside) return 0;
  if (options.side == TransformSide::inside && !inside) return 0;
  double d = std::abs(static_cast<double>(signed_units)) * unit;
  const double most =
      options.window > 0 ? options.window * unit : std::numeric_limits<double>::infinity();
  if (!(d < most)) d = most;  // also what is not a number
  return static_cast<float>(inside && options.side == TransformSide::both ? -d : d);
}

}  // namespace sdfgrid
