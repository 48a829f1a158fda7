#include "sdfgrid/transform/coverage_surface.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sdfgrid {
namespace {

constexpr int kColumnReach = 5;   // voxels up and down a column
constexpr double kWhole = 0.002;  // nearer to 0 or 1 is 0 or 1: half a grey level of 256

// A plane's coverage changes by 0.4 a voxel and more (over two voxels); less is a blur.
constexpr double kLeastGradient = 0.2;

// Differences over three planes of nine samples each, weighted as by Sobel; per step of the index.
glm::dvec3 coverage_gradient(const SignedSamples& samples, const glm::ivec3& at) {
  glm::dvec3 g(0);
  for (int n = 0; n < 27; ++n) {
    const glm::ivec3 by(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
    const double c = coverage_at(samples, at + by);
    for (int a = 0; a < 3; ++a) {
      const int u = by[(a + 1) % 3];
      const int v = by[(a + 2) % 3];
      g[a] += by[a] * c * (2 - std::abs(u)) * (2 - std::abs(v)) / 32;
    }
  }
  return g;
}

// The mean height of the surface over the column through `at`, in voxels from it towards `way`
// along `axis`, where coverage ends; nothing if the column is not covered on one side and empty on
// the other.
std::optional<double> column_height(const SignedSamples& samples, glm::ivec3 at, int axis,
                                    int way) {
  const int middle = at[axis];
  const auto coverage = [&](int k) {
    at[axis] = middle + way * k;
    return coverage_at(samples, at);
  };
  const double here = coverage(0);
  double height = here - 0.5;
  if (here < 1 - kWhole) {
    int k = -1;
    for (double c = 0; c < 1 - kWhole; --k) {
      if (k < -kColumnReach) return std::nullopt;
      c = coverage(k);
      height -= 1 - c;
    }
  }
  if (here > kWhole) {
    int k = 1;
    for (double c = 1; c > kWhole; ++k) {
      if (k > kColumnReach) return std::nullopt;
      c = coverage(k);
      height += c;
    }
  }
  return height;
}

// Of three heights in a row; beside an edge, where one is missing, of the two that are there.
std::optional<double> slope(const std::optional<double>& below, const std::optional<double>& here,
                            const std::optional<double>& above) {
  if (!here || (!below && !above)) return std::nullopt;
  if (!below) return *above - *here;
  return above ? 0.5 * (*above - *below) : *here - *below;
}

double curve(const std::optional<double>& below, const std::optional<double>& here,
             const std::optional<double>& above) {
  return below && here && above ? *below - 2 * *here + *above : 0;
}

double twist(const std::optional<double> (&h)[3][3]) {
  if (!h[0][0] || !h[0][2] || !h[2][0] || !h[2][2]) return 0;
  return 0.25 * (*h[2][2] - *h[2][0] - *h[0][2] + *h[0][0]);
}

// Mean curvature of the surface of these heights over their plane (lengths in units), positive
// where it bulges up. `h[u + 1][v + 1]`; 0 if one is missing.
double mean_curvature(const std::optional<double> (&h)[3][3], double rise, double step_u,
                      double step_v) {
  for (const auto& row : h) {
    if (!row[0] || !row[1] || !row[2]) return 0;
  }
  const double u = 0.5 * (*h[2][1] - *h[0][1]) * rise / step_u;
  const double v = 0.5 * (*h[1][2] - *h[1][0]) * rise / step_v;
  const double uu = curve(h[0][1], h[1][1], h[2][1]) * rise / (step_u * step_u);
  const double vv = curve(h[1][0], h[1][1], h[1][2]) * rise / (step_v * step_v);
  const double uv = twist(h) * rise / (step_u * step_v);
  const double sum = (1 + v * v) * uu + (1 + u * u) * vv - 2 * u * v * uv;
  return -0.5 * sum / std::pow(1 + u * u + v * v, 1.5);
}

// The largest distance of the heights from the plane through the middle one with these slopes, in
// units; not near zero beside an edge, where some are missing, 1 if fewer than six are there.
double misfit_of(const std::optional<double> (&h)[3][3], double slope_u, double slope_v,
                 double rise) {
  int count = 0;
  double worst = 0;
  for (int u = 0; u < 3; ++u) {
    for (int v = 0; v < 3; ++v) {
      if (!h[u][v]) continue;
      ++count;
      const double plane = *h[1][1] + (u - 1) * slope_u + (v - 1) * slope_v;
      worst = std::max(worst, std::abs(*h[u][v] - plane));
    }
  }
  constexpr double kLeastBesideEdge = 0.05;
  if (count < 6) return 1;
  return std::clamp(worst * rise, count < 9 ? kLeastBesideEdge : 0.0, 1.0);
}

enum class Heights { missing, elsewhere, here };

// By the columns around a voxel: that may not be possible, or the surface pass the middle of its
// column in another voxel, which then has the patch.
Heights patch_by_heights(const SignedSamples& samples, const glm::ivec3& at,
                         const glm::dvec3& gradient, SurfacePatch& patch) {
  int axis = 0;
  for (int a = 1; a < 3; ++a) {
    if (std::abs(gradient[a]) > std::abs(gradient[axis])) axis = a;
  }
  const int way = gradient[axis] > 0 ? -1 : 1;  // outwards
  const int axis_u = (axis + 1) % 3;
  const int axis_v = (axis + 2) % 3;
  std::optional<double> h[3][3];
  for (int u = 0; u < 3; ++u) {
    for (int v = 0; v < 3; ++v) {
      glm::ivec3 there = at;
      there[axis_u] += u - 1;
      there[axis_v] += v - 1;
      h[u][v] = column_height(samples, there, axis, way);
    }
  }
  const auto slope_u = slope(h[0][1], h[1][1], h[2][1]);
  const auto slope_v = slope(h[1][0], h[1][1], h[1][2]);
  if (!slope_u || !slope_v) return Heights::missing;
  if (std::abs(*h[1][1]) > 0.51) return Heights::elsewhere;
  const glm::dvec3& s = samples.spacing();
  // The mean over a voxel is the height at its middle and a 24th of its curvatures.
  const double bend = curve(h[0][1], h[1][1], h[2][1]) + curve(h[1][0], h[1][1], h[1][2]);
  glm::dvec3 normal(0);
  normal[axis] = way / s[axis];
  normal[axis_u] = -*slope_u / s[axis_u];
  normal[axis_v] = -*slope_v / s[axis_v];
  glm::dvec3 point(at);
  point[axis] += way * (*h[1][1] - bend / 24);
  constexpr double kSharpest = 0.5;  // an edge is not a ball of less than two voxels
  const double curvature = mean_curvature(h, s[axis], s[axis_u], s[axis_v]);
  // Half the diagonal of what the plane cuts out of a column.
  const double rise = (std::abs(*slope_u) + std::abs(*slope_v)) * s[axis];
  const double radius =
      0.5 * std::sqrt(s[axis_u] * s[axis_u] + s[axis_v] * s[axis_v] + rise * rise);
  const double length = glm::length(normal);
  patch = {glm::vec3(point * s), glm::vec3(normal / length),
           static_cast<float>(std::clamp(curvature, -kSharpest, kSharpest)),
           static_cast<float>(radius),
           static_cast<float>(misfit_of(h, *slope_u, *slope_v,
                                        std::abs(normal[axis]) / length * s[axis] * s[axis]))};
  patch.bend[axis_u][axis_u] =
      static_cast<float>(-curve(h[0][1], h[1][1], h[2][1]) / (s[axis_u] * s[axis_u] * length));
  patch.bend[axis_v][axis_v] =
      static_cast<float>(-curve(h[1][0], h[1][1], h[1][2]) / (s[axis_v] * s[axis_v] * length));
  patch.bend[axis_u][axis_v] = patch.bend[axis_v][axis_u] =
      static_cast<float>(-twist(h) / (s[axis_u] * s[axis_v] * length));
  return Heights::here;
}

std::optional<SurfacePatch> patch_by_gradient(const SignedSamples& samples, const glm::ivec3& at,
                                              const glm::dvec3& gradient, double coverage) {
  if (!is_partly_covered(coverage) || glm::length(gradient) < kLeastGradient) {
    return crossing_patch(samples, at);
  }
  const glm::dvec3 normal = glm::normalize(-gradient / samples.spacing());
  const double offset = plane_offset(coverage, normal, samples.spacing());
  const glm::dvec3 middle = glm::dvec3(at) * samples.spacing();
  return SurfacePatch{glm::vec3(middle + offset * normal), glm::vec3(normal), 0, kEdgeRadius, 1};
}

// How much of the unit cube is below the plane m . x = t, m >= 0.
double covered_part(const glm::dvec3& m, double t) {
  const auto cube = [](double x) { return x > 0 ? x * x * x : 0.0; };
  const double sum = cube(t) - cube(t - m.x) - cube(t - m.y) - cube(t - m.z) + cube(t - m.x - m.y) +
                     cube(t - m.y - m.z) + cube(t - m.z - m.x) - cube(t - m.x - m.y - m.z);
  return sum / (6 * m.x * m.y * m.z);
}

}  // namespace

double plane_offset(double coverage, const glm::dvec3& normal, const glm::dvec3& sides) {
  glm::dvec3 m = glm::abs(normal) * sides;
  // A plane along an axis is one that is hardly tilted against it.
  m = glm::max(m, glm::dvec3(1e-4 * std::max({m.x, m.y, m.z})));
  const double whole = m.x + m.y + m.z;
  double lo = 0;
  double hi = whole;
  for (int round = 0; round < 40; ++round) {
    const double t = 0.5 * (lo + hi);
    (covered_part(m, t) < coverage ? lo : hi) = t;
  }
  return 0.5 * (lo + hi) - 0.5 * whole;
}

double coverage_at(const SignedSamples& samples, const glm::ivec3& at) {
  const glm::ivec3 inside = glm::clamp(at, glm::ivec3(0), samples.dims() - 1);
  const double c = 0.5 - static_cast<double>(samples.value(samples.number(inside)));
  return std::clamp(c, 0.0, 1.0);
}

bool is_partly_covered(double coverage) { return coverage > kWhole && coverage < 1 - kWhole; }

bool is_cut_by_surface(const SignedSamples& samples, const glm::ivec3& at) {
  if (!is_partly_covered(coverage_at(samples, at))) return false;
  const bool inside = samples.inside(samples.number(at));
  for (int n = 0; n < 27; ++n) {
    const glm::ivec3 there = at + glm::ivec3(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
    if (samples.has(there) && samples.inside(samples.number(there)) != inside) return true;
  }
  return false;
}

std::optional<SurfacePatch> surface_patch(const SignedSamples& samples, const glm::ivec3& at) {
  const glm::dvec3 gradient = coverage_gradient(samples, at);
  SurfacePatch patch{};
  const Heights heights = patch_by_heights(samples, at, gradient, patch);
  if (heights == Heights::here) return patch;
  if (heights == Heights::elsewhere) return std::nullopt;
  return patch_by_gradient(samples, at, gradient, coverage_at(samples, at));
}

std::optional<SurfacePatch> crossing_patch(const SignedSamples& samples, const glm::ivec3& at) {
  SurfaceSeed seed{};
  if (!samples.seed(at, seed)) return std::nullopt;
  // Never of no length, see SignedSamples::seed().
  const glm::vec3 way = seed.distance < 0 ? seed.to_point : -seed.to_point;
  const glm::vec3 middle(glm::dvec3(at) * samples.spacing());
  return SurfacePatch{middle + seed.to_point, glm::normalize(way), 0, kEdgeRadius, 1};
}

}  // namespace sdfgrid
