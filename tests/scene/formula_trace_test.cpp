// Formulas traced by each kind of step: certified ones have neither holes nor hits beside the
// surface, where those of first order have holes.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <vector>

#include "sdfgrid/grid/convert_field.h"
#include "sdfgrid/grid/recovered.h"
#include "sdfgrid/grid/steepened.h"
#include "sdfgrid/grid/vdb.h"
#include "sdfgrid/trace/field_trace.h"
#include "sdfgrid/trace/grid_sampler.h"

namespace sdfgrid {
namespace {

constexpr double kTolerance = 1e-4;
constexpr int kSide = 90;

// The torus of radii 1 and 0.4 as a quartic, whose gradient vanishes in its hole.
Field torus(const std::string& order) {
  return make_field("formula", {{"f", "(x^2 + y^2 + z^2 + 0.84)^2 - 4*(x^2 + y^2)"},
                                {"bounds", {-1.6, -1.6, -0.6, 1.6, 1.6, 0.6}},
                                {"order", order}});
}
double torus_distance(const glm::dvec3& p) {
  return std::hypot(std::hypot(p.x, p.y) - 1, p.z) - 0.4;
}

std::vector<Ray> picture() {
  const glm::dvec3 eye(2, 4, 3);
  std::vector<Ray> rays;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const glm::dvec3 target((x / (kSide - 1.0) - 0.5) * 3.2, 0, (y / (kSide - 1.0) - 0.5) * 3);
      rays.push_back({eye, glm::normalize(target - eye)});
    }
  }
  return rays;
}

// The first place within the torus by sphere tracing of its exact distance in double.
double first_hit(const Ray& ray) {
  double t = 0;
  while (t < 20) {
    const double d = torus_distance(ray.origin + t * ray.direction);
    if (d < 1e-9) return t;
    t += d;
  }
  return std::numeric_limits<double>::infinity();
}

struct Counts {
  int holes = 0;   // rays that go through what they should hit, by more than a hundredth
  int beside = 0;  // hits far from the surface
  int hits = 0;
};

Counts trace(const std::string& order) {
  const Field field = torus(order);
  const FieldTracer tracer(field, {glm::dvec3(-1.7, -1.7, -0.7), glm::dvec3(1.7, 1.7, 0.7)});
  const std::vector<Ray> rays = picture();
  std::vector<float> depth(rays.size());
  std::vector<std::uint32_t> steps(rays.size());
  tracer.trace(rays, kTolerance, depth, steps);
  Counts counts;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double truth = first_hit(rays[i]);
    if (std::isfinite(truth) && !(depth[i] < truth + 0.01)) ++counts.holes;
    if (!std::isfinite(depth[i])) continue;
    ++counts.hits;
    const double off = torus_distance(rays[i].origin + double(depth[i]) * rays[i].direction);
    if (std::fabs(off) > 20 * kTolerance * double(depth[i])) ++counts.beside;
  }
  return counts;
}

TEST(FormulaTrace, CertifiedHasNoHolesWhereFirstOrderHas) {
  const Counts first = trace("1");
  const Counts second = trace("2");
  const Counts certified = trace("certified");
  EXPECT_GT(first.holes, 10);
  EXPECT_EQ(second.holes, 0);
  EXPECT_EQ(certified.holes, 0);
  EXPECT_EQ(certified.beside, 0);
  EXPECT_GT(certified.hits, 1000);
}

// The bound at the torus' surface is about a tenth of the distance; steepened it is the distance
// within a quarter beside the surface, and the surface is where it was.
TEST(FormulaTrace, SteepenedGridsAreAboutDistances) {
  FieldConvertOptions options;
  options.dim = 64;
  const Grid bound = convert_field(torus("certified"), options, Job()).grid;
  const Grid grid = steepened(bound, {});
  const double h = grid.lattice().voxel;
  int beside = 0;
  for (auto it = vdb(grid)->cbeginValueOn(); it; ++it) {
    const openvdb::Coord at = it.getCoord();
    const double d = torus_distance(grid.lattice().to_world(glm::dvec3(at.x(), at.y(), at.z())));
    ASSERT_EQ(*it < 0, vdb(bound)->tree().getValue(at) < 0);
    if (std::fabs(d) > h) continue;
    ++beside;
    ASSERT_NEAR(*it, d, 0.25 * h);
    ASSERT_LT(std::fabs(vdb(bound)->tree().getValue(at)), 0.3 * h);
  }
  EXPECT_GT(beside, 1000);
  // What is a distance is left alone.
  const Grid ball = convert_field(make_field("sphere"), options, Job()).grid;
  EXPECT_EQ(vdb(steepened(ball, {})), vdb(ball));
}

// A fine grid's band ends before the next voxel of a coarse one, so that sampling it gives a
// staircase; light needs the surface.
TEST(FormulaTrace, RecoveredGridsFindTheSurfaceOfFineBands) {
  FieldConvertOptions options;
  options.dim = 256;
  const Field fine =
      make_field(make_sampler(convert_field(make_field("sphere"), options, Job()).grid, Job()));
  options.dim = 32;
  const Grid coarse = convert_field(fine, options, Job()).grid;
  const Grid grid = recovered(coarse, fine, {});
  const double h = grid.lattice().voxel;
  int beside = 0;
  double worst_before = 0;
  for (auto it = vdb(grid)->cbeginValueOn(); it; ++it) {
    const openvdb::Coord at = it.getCoord();
    const glm::dvec3 p = grid.lattice().to_world(glm::dvec3(at.x(), at.y(), at.z()));
    const double d = glm::length(p) - 1;
    if (std::fabs(d) > 0.5 * h) continue;
    ++beside;
    ASSERT_NEAR(*it, d, 0.05 * h);
    worst_before = std::fmax(worst_before, std::fabs(vdb(coarse)->tree().getValue(at) - d));
  }
  EXPECT_GT(beside, 1000);
  EXPECT_GT(worst_before, 0.1 * h);
}

}  // namespace
}  // namespace sdfgrid
