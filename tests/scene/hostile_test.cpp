// Scenes in which every step is dangerous, against proved roots (first_root.h): no first hit may be
// missed, too far, or where there is no surface, by bundles of rays and by pictures. For more rays
// than the tests take, from another seed on: SDFGRID_HOSTILE_RAYS=1000000 SDFGRID_HOSTILE_SEED=1.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "field/examples.h"
#include "scene/first_root.h"
#include "sdfgrid/core/isa.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/scene/build.h"
#include "sdfgrid/trace/field_march.h"
#include "sdfgrid/trace/field_trace.h"

namespace sdfgrid {
namespace {

using test::FirstRoot;
using test::Verdict;

// Twisted, bent, tapered, noisy, blended, unequally scaled; a shell, a formula, a repetition.
const char* const kHostile = R"(
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

// Walls between parts, one of them within a turned and squeezed node; solids that end at them,
// stand before them, and lie on both sides.
const char* const kWalls = R"(
sdfgrid: 1
scene:
  - partition:
      normal: [1, 0.3, 0]
      distance: 0.1
      of:
        - partition:
            normal: [0, 1, -0.5]
            of:
              - {displace: {by: {noise: {frequency: 5, amplitude: 0.05, octaves: 2}}, of: {sphere: {radius: 1}}}}
              - {torus: {major: 0.9, minor: 0.25}, rotate: [60, 0, 0]}
        - partition:
            normal: [0.2, 0, 1]
            distance: -0.2
            of:
              - {twist: {turns: 0.4, of: {box: {size: [1.4, 0.8, 1.8]}}}}
              - repeat: {cell: [0.5, 0.5, 0.5], of: {sphere: {radius: 0.18}}}
  - intersection:
      - {box: {size: [1.6, 1.6, 1.6]}}
      - partition:
          normal: [1, 1, 1]
          of: [{shell: {thickness: 0.02, of: {sphere: {radius: 0.7}}}}, {complement: {of: {sphere: {radius: 0.6}}}}]
        rotate: [20, 30, 40]
        scale: [1, 0.5, 1]
    at: [2.2, 0, 0]
)";

// A floor without end, its neighbours small.
const char* const kFloor = R"(
sdfgrid: 1
scene:
  - {plane: {normal: [0, 1, 0], distance: -0.3}}
  - {displace: {by: {noise: {frequency: 4, amplitude: 0.05, octaves: 2}}, of: {plane: {normal: [0.1, 1, 0.2], distance: -0.4}}}}
  - {sphere: {radius: 0.3}}
  - {torus: {major: 0.4, minor: 0.1}, at: [1, 0, 0]}
  - {box: {size: [0.4, 0.4, 0.4]}, at: [-1, -0.2, 0.5], rotate: [30, 40, 0]}
  - {infinite_cylinder: {radius: 0.05}, at: [0.3, 0.4, 0], rotate: [10, 0, 0]}
)";

struct Stage {
  Field field;
  Box region;
};

// Without end it is seen in a cube.
Stage make_stage(const char* text) {
  const SceneFile file = parse_scene(text, "hostile");
  EXPECT_TRUE(file.warnings.empty());
  Stage scene{build_scene(file.scene, "hostile", 0, Job()).field, {}};
  const Box box = scene.field.bounds();
  scene.region = {glm::max(box.lo - 1e-3, glm::dvec3(-2)), glm::min(box.hi + 1e-3, glm::dvec3(2))};
  if (std::isfinite(reach(box))) scene.region = {box.lo - 1e-3, box.hi + 1e-3};
  return scene;
}

// From anywhere around and within, some inside of a solid, some from far away, to somewhere near a
// surface, some along an axis; wide and narrow, most of them small, none of them whole blocks of
// pixels.
Camera make_camera(const Stage& scene, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto within = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  const Box& box = scene.region;
  Camera camera;
  // The nearest to a surface of a few places.
  float nearest = 1e9F;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 p = box.lo + within() * box.size();
    const float value = std::fabs(scene.field(glm::vec3(p)));
    if (value < nearest) camera.target = p;
    nearest = std::min(nearest, value);
  }
  const float side = seed % 8 == 3 ? -1 : 1;
  for (int i = 0; i < 400; ++i) {
    const double away = glm::length(box.size()) * (0.02 + 1.5 * unit(random));
    glm::dvec3 towards = glm::normalize(within() - 0.5);
    if (seed % 5 == 0) {
      towards = glm::dvec3(0);
      towards[static_cast<int>(random() % 3)] = random() % 2 == 0 ? 1 : -1;
    }
    camera.eye = (seed % 5 == 0 ? camera.target : box.center()) + away * towards;
    if (side * scene.field(glm::vec3(camera.eye)) > 1e-3F) break;
  }
  camera.up = glm::normalize(within() - 0.5);
  camera.fov = std::pow(10, 2 * unit(random) - 0.3);
  if (seed % 16 == 9) {  // from far away
    camera.eye = camera.target + 300.0 * (camera.eye - camera.target);
    camera.fov /= 300;
  }
  camera.width = seed % 40 == 7 ? 151 : 23;
  camera.height = seed % 40 == 7 ? 71 : 13;
  return camera;
}

// The field as one, which is pruned, and its objects each by itself; with steps relaxed and not.
struct Way {
  const char* name;
  FieldTraceOptions options;
};
const Way kWays[] = {{"whole", {.objects = false}},
                     {"whole, not relaxed", {.relax = false, .objects = false}},
                     {"objects", {}},
                     {"objects, not relaxed", {.relax = false}}};

constexpr int kSamples = 500;    // along each ray, up to where its root is proved to be
constexpr double kClose = 1e-4;  // a proof that leaves no more of a ray open

class Trial {
 public:
  explicit Trial(const Stage& scene)
      : scene_(scene), turned_(make_field("complement", {}, {scene.field})) {
    for (const Way& way : kWays) {
      tracers_.push_back(std::make_unique<FieldTracer>(scene.field, scene.region, way.options));
    }
  }

  // All rays of a camera.
  void run(std::uint32_t seed) {
    const Camera camera = make_camera(scene_, seed);
    const RayGenerator generator(camera);
    std::vector<Ray> rays;
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) rays.push_back(generator.ray(x + 0.5, y + 0.5));
    }
    // Rays that begin inside enter what is not inside.
    const bool inside = scene_.field(glm::vec3(camera.eye)) < 0;
    std::vector<FirstRoot> roots;
    roots.reserve(rays.size());
    for (const Ray& ray : rays) roots.push_back(root_of(inside ? turned_ : scene_.field, ray));
    const double tolerance = 0.02 * glm::length(generator.right());
    std::vector<float> depth(rays.size());
    for (std::size_t i = 0; i < tracers_.size(); ++i) {
      const auto name = fmt::format("{} of seed {}", kWays[i].name, seed);
      const HitBuffer picture = tracers_[i]->trace_primary(camera, Job());
      judge(name + ", picture", rays, roots, picture.depth, tolerance, tallies_[i]);
      tracers_[i]->trace(rays, tolerance, depth, {});
      judge(name + ", bundle", rays, roots, depth, tolerance, tallies_[i]);
    }
  }

  void report(const std::string& title) const {
    fmt::print("{}: {} rays on {}, {} with a root, of {} the proof leaves more than {} open\n",
               title, rays_.load(), isa_name(active_isa()), rooted_.load(), open_.load(), kClose);
    for (std::size_t i = 0; i < tracers_.size(); ++i) {
      const Tally& t = tallies_[i];
      fmt::print("{:>22}: {} rays traced, {} hits, {} missed, {} where there is no surface\n",
                 kWays[i].name, t.rays.load(), t.hits.load(), t.missed.load(), t.invented.load());
      EXPECT_EQ(t.missed, 0U);
      EXPECT_EQ(t.invented, 0U);
    }
  }
  [[nodiscard]] std::size_t rays() const { return rays_; }
  [[nodiscard]] std::size_t rooted() const { return rooted_; }
  [[nodiscard]] std::size_t open() const { return open_; }

 private:
  struct Tally {
    std::atomic<std::size_t> rays{0}, hits{0}, missed{0}, invented{0};
  };

  FirstRoot root_of(const Field& field, const Ray& ray) {
    const FirstRoot root = test::first_root(field, ray, scene_.region);
    ++rays_;
    rooted_ += std::isfinite(root.certain) ? 1 : 0;
    open_ += root.possible < root.certain - kClose ? 1 : 0;
    const Span in = clip(ray, scene_.region);
    const double to = std::min(in.to, root.possible);
    if (in.from < to) {
      const double inside = test::first_sample_inside(field, ray, in.from, to, kSamples);
      EXPECT_GE(inside, to) << "the proof is wrong";
    }
    return root;
  }

  void judge(const std::string& name, const std::vector<Ray>& rays,
             const std::vector<FirstRoot>& roots, const std::vector<float>& depth, double tolerance,
             Tally& tally) const {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const double found = depth[i];
      const Verdict verdict = test::judge(scene_.field, rays[i], roots[i], found, tolerance);
      ++tally.rays;
      tally.hits += std::isfinite(found) ? 1 : 0;
      if (verdict == Verdict::right) continue;
      ++(verdict == Verdict::missed ? tally.missed : tally.invented);
      ADD_FAILURE() << fmt::format("{}, ray {}: {} at {} (value {}); root between {} and {}", name,
                                   i, verdict == Verdict::missed ? "missed" : "no surface", found,
                                   value_at(rays[i], found), roots[i].possible, roots[i].certain);
    }
  }

  [[nodiscard]] double value_at(const Ray& ray, double t) const {
    return scene_.field.gradient(ray.origin + std::min(t, 1e6) * ray.direction).value;
  }

  const Stage& scene_;
  Field turned_;  // inside out
  std::vector<std::unique_ptr<FieldTracer>> tracers_;
  std::array<Tally, std::size(kWays)> tallies_;
  std::atomic<std::size_t> rays_{0}, rooted_{0}, open_{0};
};

std::size_t number_from(const char* variable, std::size_t otherwise) {
  const char* text = std::getenv(variable);
  return text != nullptr ? static_cast<std::size_t>(std::atoll(text)) : otherwise;
}

struct Named {
  const char* name;
  const char* text;
  std::size_t rays;
};
class HostileScene : public testing::TestWithParam<Named> {};
INSTANTIATE_TEST_SUITE_P(Scenes, HostileScene,
                         testing::Values(Named{"Solids", kHostile, 12000},
                                         Named{"Walls", kWalls, 8000},
                                         Named{"Floor", kFloor, 4000}),
                         [](const auto& scene) { return scene.param.name; });

TEST_P(HostileScene, NoFirstHitIsMissed) {
  const Stage scene = make_stage(GetParam().text);
  Trial trial(scene);
  // 40 cameras: 39 of 23 x 13 pixels and one of 151 x 71.
  constexpr std::size_t kRays = 39 * 23 * 13 + 151 * 71;
  const std::size_t rays = number_from("SDFGRID_HOSTILE_RAYS", GetParam().rays);
  const std::size_t cameras = (40 * rays + kRays - 1) / kRays;
  const std::size_t first = number_from("SDFGRID_HOSTILE_SEED", 0);
  parallel_for(cameras, 1, Job(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) trial.run(static_cast<std::uint32_t>(first + i));
  });
  trial.report(GetParam().name);
  EXPECT_GT(trial.rooted(), trial.rays() / 10);
  EXPECT_LT(trial.open(), trial.rays() / 100);
}

// Each op's example; what is only an estimate may miss.
TEST(Hostile, NoOpIsMissed) {
  std::size_t rooted = 0;
  std::size_t rays = 0;
  std::size_t open = 0;
  for (const Example& example : examples()) {
    if (example.estimate) continue;
    SCOPED_TRACE(example.text);
    const Stage scene{example.field, example_box(example.field)};
    Trial trial(scene);
    for (std::uint32_t seed = 0; seed < 5; ++seed) trial.run(seed);
    if (HasFailure()) trial.report(example.text);
    rays += trial.rays();
    rooted += trial.rooted();
    open += trial.open();
  }
  EXPECT_GT(rooted, rays / 4);
  EXPECT_LT(open, rays / 100);
}

}  // namespace
}  // namespace sdfgrid
