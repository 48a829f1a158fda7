// Rays against fields: no first hit is missed, none invented, whatever is switched on.
#include "sdfgrid/trace/field_trace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "sdfgrid/core/error.h"
#include "sdfgrid/scene/build.h"
#include "sdfgrid/trace/field_seen.h"

namespace sdfgrid {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

Field field_of(const std::string& nodes) {
  const SceneFile file = parse_scene("sdfgrid: 1\nscene: " + nodes, "test");
  EXPECT_TRUE(file.warnings.empty());
  return build_scene(file.scene, "test", 0, Job()).field;
}

Box region_of(const Field& field) {
  const Box box = field.bounds();
  return {box.lo - 1e-3, box.hi + 1e-3};
}

// Rays from places around the box towards places in it, in bundles that stay together.
std::vector<Ray> bundles(const Box& box, int count, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const auto within = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  std::vector<Ray> rays;
  for (int b = 0; b < count; ++b) {
    const glm::dvec3 around = glm::normalize(within() - 0.5);
    const glm::dvec3 eye = box.center() + glm::length(box.size()) * (0.6 + unit(random)) * around;
    const glm::dvec3 target = box.lo + within() * box.size();
    for (int i = 0; i < 64; ++i) {
      const glm::dvec3 at = target + 0.1 * (within() - 0.5) * box.size();
      rays.push_back({eye, glm::normalize(at - eye)});
    }
  }
  return rays;
}

// The first change of sign along a ray by dense search, brought to double precision by bisection.
double dense_search(const Field& field, const Ray& ray, double far, std::size_t samples) {
  std::vector<float> x(samples), y(samples), z(samples), v(samples);
  const auto at = [&](std::size_t i) {
    return far * static_cast<double>(i) / static_cast<double>(samples);
  };
  for (std::size_t i = 0; i < samples; ++i) {
    const glm::vec3 p(ray.origin + at(i) * ray.direction);
    x[i] = p.x;
    y[i] = p.y;
    z[i] = p.z;
  }
  field.evaluate(samples, x.data(), y.data(), z.data(), v.data());
  for (std::size_t i = 1; i < samples; ++i) {
    if ((v[i] < 0) == (v[0] < 0)) continue;
    double lo = at(i - 1);
    double hi = at(i);
    for (int k = 0; k < 40; ++k) {
      const double middle = 0.5 * (lo + hi);
      const bool same =
          (field.gradient(ray.origin + middle * ray.direction).value < 0) == (v[0] < 0);
      (same ? lo : hi) = middle;
    }
    return hi;
  }
  return std::numeric_limits<double>::infinity();
}

const char* const kHostile =
    "[{smooth_union: {k: 0.3, of: [{twist: {turns: 0.6, of: {box: {size: [1, 0.3, 2]}}}}, {torus: "
    "{major: 0.8, minor: 0.15}, rotate: [70, 0, 20]}]}, scale: [1, 0.4, 0.8]}, {bend: {angle: 50, "
    "of: {taper: {from: 1, to: 0.2, of: {cylinder: {radius: 0.3, height: 2}, rotate: [90, 0, "
    "0]}}}}, "
    "at: [0.3, 0.5, 0.4]}, {shell: {thickness: 0.01, of: {sphere: {radius: 0.5}}}, at: [-1, 0.6, "
    "0]}, {formula: {f: \"x^4 + y^4 + z^4 - x^2 - y^2 - z^2 + 0.45\", bounds: [[-1.2, -1.2, -1.2], "
    "[1.2, "
    "1.2, 1.2]]}, "
    "at: "
    "[0, 0, -2]}]";

// What tracing must keep, against the dense search.
void expect_no_miss(const Field& field, const FieldTraceOptions& options, int count) {
  constexpr double kTolerance = 1e-4;
  const Box region = region_of(field);
  const FieldTracer tracer(field, region, options);
  std::mt19937 random(17);
  const std::vector<Ray> rays = bundles(region, count, random);
  std::vector<float> depth(rays.size());
  std::vector<std::uint16_t> steps(rays.size());
  for (std::size_t i = 0; i < rays.size(); i += 64) {
    tracer.trace(std::span(rays).subspan(i, 64), kTolerance, std::span(depth).subspan(i, 64),
                 std::span(steps).subspan(i, 64));
  }
  int hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double far = 3 * glm::length(region.size());
    const double truth = dense_search(field, rays[i], far, 4000);
    if (std::isfinite(truth)) {
      ++hits;
      ASSERT_LE(depth[i], truth * (1 + kTolerance) + 1e-4) << "ray " << i << " missed its hit";
    }
    if (depth[i] < kNothing) {
      // Within the tolerance of the surface, the field's slope included.
      const glm::dvec3 p = rays[i].origin + double(depth[i]) * rays[i].direction;
      ASSERT_LT(std::fabs(field.gradient(p).value), kTolerance * depth[i] + 1e-5) << "ray " << i;
    }
  }
  EXPECT_GT(hits, static_cast<int>(rays.size()) / 10);
}

TEST(FieldTrace, MissesNoFirstHitOfAHostileScene) {
  const Field field = field_of(kHostile);
  expect_no_miss(field, {}, 30);
  expect_no_miss(field, {false, false, false}, 8);
  expect_no_miss(field, {true, false, false}, 8);
  expect_no_miss(field, {false, true, true}, 8);
}

TEST(FieldTrace, DepthOfABallIsExact) {
  const FieldTracer tracer(field_of("{sphere: {radius: 2}}"), {glm::dvec3(-3), glm::dvec3(3)});
  Camera camera;
  camera.eye = {0, 0, 10};
  camera.width = 64;
  camera.height = 48;
  const HitBuffer hits = tracer.trace_primary(camera, Job());
  const RayGenerator rays(camera);
  for (int i = 0; i < 64 * 48; ++i) {
    const Ray ray = rays.ray(i % 64 + 0.5, i / 64 + 0.5);
    const double b = glm::dot(ray.origin, ray.direction);
    const double under = b * b - 100 + 4;
    const double near = std::sqrt(100 - b * b) - 2;  // of the ray to the ball
    if (std::fabs(near) < 0.01) continue;            // grazes
    ASSERT_EQ(under > 0, hits.depth[i] < kNothing) << i;
    if (under <= 0) continue;
    ASSERT_NEAR(hits.depth[i], -b - std::sqrt(under), 0.02) << i;
  }
}

TEST(FieldTrace, RaysThatStartInsideHitWhereTheyLeave) {
  const FieldTracer tracer(field_of("{sphere: {radius: 2}}"), {glm::dvec3(-3), glm::dvec3(3)});
  const Ray ray{glm::dvec3(0.5, 0, 0), glm::dvec3(1, 0, 0)};
  float depth = 0;
  tracer.trace({&ray, 1}, 1e-6, {&depth, 1}, {});
  EXPECT_NEAR(depth, 1.5, 1e-4);
}

TEST(FieldTrace, RelaxedStepsAreFewer) {
  const Field field = field_of(
      "[{sphere: {}}, {box: {size: [1, 1, 1]}, at: [2, 0, 0]}, {torus: {}, at: [0, 2, 0]}]");
  Camera camera = frame(field.bounds(), 96, 96);
  const auto mean = [&](const FieldTraceOptions& options) {
    const HitBuffer hits =
        FieldTracer(field, region_of(field), options).trace_primary(camera, Job());
    double sum = 0;
    for (const std::uint16_t n : hits.steps) sum += n;
    return sum;
  };
  EXPECT_GT(mean({false, false, false}), 1.1 * mean({true, false, false}));
}

TEST(FieldTrace, TheSurfaceThatIsHitBringsItsMaterialAndNormal) {
  const SceneFile file = parse_scene(R"(
sdfgrid: 1
materials: {red: {diffuse: [1, 0, 0]}, blue: {diffuse: [0, 0, 1]}}
scene: {difference: [{box: {size: [2, 2, 2]}, material: red}, {sphere: {radius: 1.2}, material: blue}]}
)",
                                     "test");
  const SceneModel model = build_scene(file.scene, "test", 0, Job());
  const FieldTracer tracer(model.field, region_of(model.field));
  const SeenField seen(tracer, model.materials, Material(), 1e-4);
  const std::vector<Ray> rays = {{{0, 0, 5}, {0, 0, -1}}, {{0.9, 0.9, 5}, {0, 0, -1}}};
  std::vector<float> depth(2);
  seen.trace(rays, depth);
  EXPECT_EQ(depth[0], kNothing);  // through the hole
  EXPECT_NEAR(depth[1], 4, 1e-3);
  const std::vector<glm::dvec3> points = {{0.9, 0.9, 1},
                                          {1.2 / std::sqrt(2), 0, 1.2 / std::sqrt(2)}};
  std::vector<glm::vec3> normals(2);
  std::vector<Material> materials(2);
  seen.describe(points, normals, materials);
  EXPECT_EQ(materials[0].diffuse, glm::vec3(1, 0, 0));
  EXPECT_EQ(materials[1].diffuse, glm::vec3(0, 0, 1));
  EXPECT_NEAR(normals[0].z, 1, 1e-6);
  EXPECT_NEAR(normals[1].x, -std::sqrt(0.5), 1e-6);  // out of the solid, into the hole
}

TEST(FieldTrace, RefusesARegionWithoutEnd) {
  EXPECT_THROW(FieldTracer(field_of("{plane: {}}"), field_of("{plane: {}}").bounds()), Error);
}

}  // namespace
}  // namespace sdfgrid
