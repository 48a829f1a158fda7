// A scene in which every step is dangerous, against a search that knows nothing of bounds: along
// each ray the field is sampled densely, every change of sign brought to double precision. No first
// hit may be missed. SDFGRID_HOSTILE_RAYS=1000000 asks for more rays than the test takes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <random>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/scene/build.h"
#include "sdfgrid/trace/field_trace.h"

namespace sdfgrid {
namespace {

// Twisted, bent, tapered, noisy, blended, unequally scaled; a shell, a formula, a repetition.
const char* const kScene = R"(
sdfgrid: 1
scene:
  - smooth_union:
      k: 0.3
      of:
        - twist: {turns: 0.6, of: {box: {size: [1, 0.3, 2]}}}
        - {torus: {major: 0.8, minor: 0.15}, rotate: [70, 0, 20]}
    scale: [1, 0.4, 0.8]
  - displace:
      by: {noise: {frequency: 3, amplitude: 0.12, octaves: 3, seed: 5}}
      of: {sphere: {radius: 0.6}}
    at: [1.6, 0, 0]
  - displace:
      by: {noise: {frequency: 6, amplitude: 0.04, octaves: 2, seed: 9}}
      of: {twist: {turns: 0.4, of: {box: {size: [0.5, 0.5, 1.6]}}}}
    at: [-1.4, -0.6, 0.4]
    scale: [1, 0.6, 1]
  - bend:
      angle: 50
      of: {taper: {from: 1, to: 0.2, of: {cylinder: {radius: 0.3, height: 2}, rotate: [90, 0, 0]}}}
    at: [0.3, 0.5, 0.4]
  - {shell: {thickness: 0.01, of: {sphere: {radius: 0.5}}}, at: [-1, 0.6, 0]}
  - formula:
      f: "x^4 + y^4 + z^4 - x^2 - y^2 - z^2 + 0.45"
      bounds: [[-1.2, -1.2, -1.2], [1.2, 1.2, 1.2]]
    at: [0, 0, -2]
  - intersection:
      - repeat: {cell: [0.4, 0.4, 0], of: {capsule: {from: [-0.05, 0, 0], to: [0.1, 0.05, 0.2], radius: 0.04}}}
      - box: {size: [2, 2, 1]}
    at: [0, -1.4, -1]
)";

constexpr double kTolerance = 1e-4;  // of the distance
constexpr std::size_t kBundle = 256;
constexpr int kSamples = 1500;  // along each ray through the region

struct Scene {
  Field field;
  Box region;
};

Scene make_scene() {
  const SceneFile file = parse_scene(kScene, "hostile");
  EXPECT_TRUE(file.warnings.empty());
  Scene scene{build_scene(file.scene, "hostile", 0, Job()).field, {}};
  const Box box = scene.field.bounds();
  scene.region = {box.lo - 1e-3, box.hi + 1e-3};
  return scene;
}

// Rays that stay together, from anywhere around to anywhere within; some nearly along an axis.
std::vector<Ray> make_bundle(const Box& box, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto within = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  const glm::dvec3 around = glm::normalize(within() - 0.5);
  const glm::dvec3 eye = box.center() + glm::length(box.size()) * (0.6 + unit(random)) * around;
  const glm::dvec3 target = box.lo + within() * box.size();
  const double spread = std::pow(10, -2 * unit(random));
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < kBundle; ++i) {
    const glm::dvec3 at = target + spread * (within() - 0.5) * box.size();
    rays.push_back({eye, glm::normalize(at - eye)});
  }
  return rays;
}

bool inside(const Field& field, const Ray& ray, double t) {
  return field.gradient(ray.origin + t * ray.direction).value < 0;
}

// The first change of sign in [from, to], in double; infinite if there is none.
double dense_search(const Field& field, const Ray& ray, double from, double to) {
  std::vector<float> c(std::size_t{4} * kSamples);
  const auto at = [&](int i) { return from + (to - from) * i / (kSamples - 1.0); };
  for (int i = 0; i < kSamples; ++i) {
    const glm::vec3 p(ray.origin + at(i) * ray.direction);
    for (int a = 0; a < 3; ++a) c[a * kSamples + i] = p[a];
  }
  float* const value = c.data() + 3 * std::size_t{kSamples};
  field.evaluate(kSamples, c.data(), c.data() + kSamples, c.data() + 2 * kSamples, value);
  for (int i = 1; i < kSamples; ++i) {
    // What floats call a change of sign must be one in double.
    if (!(value[i] < 0) || !inside(field, ray, at(i))) continue;
    double lo = at(i - 1);
    double hi = at(i);
    for (int k = 0; k < 45; ++k) {
      const double middle = 0.5 * (lo + hi);
      (inside(field, ray, middle) ? hi : lo) = middle;
    }
    return hi;
  }
  return std::numeric_limits<double>::infinity();
}

struct Tally {
  std::atomic<std::size_t> rays{0}, hits{0}, missed{0}, invented{0};
};

// What a ray's depth may be off: as where less than the tolerance was free, taken to be as far
// ahead.
double allowed(double t) { return kTolerance * t + 1e-5; }

void check_bundle(const Scene& scene, const FieldTracer& tracer, std::uint32_t seed, Tally& tally) {
  const std::vector<Ray> rays = make_bundle(scene.region, seed);
  std::vector<float> depth(rays.size());
  tracer.trace(rays, kTolerance, depth, {});
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ++tally.rays;
    const double far = 4 * glm::length(scene.region.size());
    const double end = std::min(far, static_cast<double>(depth[i]));
    // From where the ray enters the region; beyond its hit nothing matters.
    const double from = std::max(0.0, glm::distance(rays[i].origin, scene.region.center()) -
                                          0.5 * glm::length(scene.region.size()));
    const double truth = from < end ? dense_search(scene.field, rays[i], from, end) : far;
    if (truth < end - allowed(end)) {
      ++tally.missed;
      ADD_FAILURE() << fmt::format("seed {}, ray {}: hit at {}, but the surface is at {}", seed, i,
                                   depth[i], truth);
    }
    if (!std::isfinite(depth[i])) continue;
    ++tally.hits;
    const double value =
        scene.field.gradient(rays[i].origin + double(depth[i]) * rays[i].direction).value;
    if (std::fabs(value) > 2 * allowed(end)) {
      ++tally.invented;
      ADD_FAILURE() << fmt::format("seed {}, ray {}: hit at {} where the value is {}", seed, i,
                                   depth[i], value);
    }
  }
}

std::size_t rays_asked() {
  const char* text = std::getenv("SDFGRID_HOSTILE_RAYS");
  return text != nullptr ? static_cast<std::size_t>(std::atoll(text)) : 20000;
}

// All objects as one, which is pruned, or each by itself.
class Hostile : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Objects, Hostile, testing::Bool());

TEST_P(Hostile, NoFirstHitIsMissed) {
  const Scene scene = make_scene();
  const FieldTracer tracer(scene.field, scene.region, {.objects = GetParam()});
  const std::size_t bundles = (rays_asked() + kBundle - 1) / kBundle;
  Tally tally;
  parallel_for(bundles, 1, Job(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      check_bundle(scene, tracer, static_cast<std::uint32_t>(i), tally);
    }
  });
  fmt::print("{} rays, {} hits, {} missed, {} where there is no surface\n", tally.rays.load(),
             tally.hits.load(), tally.missed.load(), tally.invented.load());
  EXPECT_GT(tally.hits, tally.rays / 10);
  EXPECT_EQ(tally.missed, 0U);
}

}  // namespace
}  // namespace sdfgrid
