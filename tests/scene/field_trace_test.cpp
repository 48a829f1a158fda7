// Rays against fields: no first hit is missed, none invented, whatever is switched on.
#include "sdfgrid/trace/field_trace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "scene/first_root.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/scene/build.h"
#include "sdfgrid/trace/field_seen.h"

namespace sdfgrid {
namespace {

// Through the middle of pixel i of a picture of so many columns.
Ray through_pixel(const RayGenerator& rays, int i, int columns) {
  const int column = i % columns;
  const int row = i / columns;
  return rays.ray(column + 0.5, row + 0.5);
}

constexpr float kNothing = std::numeric_limits<float>::infinity();
constexpr FieldTraceOptions kPlain = kPlainSphereTracing;
constexpr FieldTraceOptions kOnlyRelaxed = [] {
  FieldTraceOptions options = kPlainSphereTracing;
  options.relax = true;
  return options;
}();
// Of one object, whatever it is made of.
constexpr FieldTraceOptions kWhole = {.objects = false, .convex = false};

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

// What tracing must keep, against proved roots.
void expect_right(const Field& field, std::span<const Ray> rays,
                  std::span<const test::FirstRoot> roots, std::span<const float> depth,
                  double tolerance) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(test::judge(field, rays[i], roots[i], double(depth[i]), tolerance),
              test::Verdict::right)
        << "ray " << i << ": hit at " << depth[i] << ", root between " << roots[i].possible
        << " and " << roots[i].certain;
  }
}

std::vector<test::FirstRoot> roots_of(const Field& field, std::span<const Ray> rays) {
  std::vector<test::FirstRoot> roots;
  for (const Ray& ray : rays) roots.push_back(test::first_root(field, ray, region_of(field)));
  return roots;
}

void expect_no_miss(const Field& field, const FieldTraceOptions& options, int count) {
  SCOPED_TRACE(count);
  constexpr double kTolerance = 1e-4;
  const FieldTracer tracer(field, region_of(field), options);
  std::mt19937 random(17);
  const std::vector<Ray> rays = bundles(region_of(field), count, random);
  std::vector<float> depth(rays.size());
  std::vector<std::uint32_t> steps(rays.size());
  for (std::size_t i = 0; i < rays.size(); i += 64) {
    tracer.trace(std::span(rays).subspan(i, 64), kTolerance, std::span(depth).subspan(i, 64),
                 std::span(steps).subspan(i, 64));
  }
  const auto hits = std::count_if(depth.begin(), depth.end(), [](float d) { return d < kNothing; });
  EXPECT_GT(hits, static_cast<int>(rays.size()) / 10);
  expect_right(field, rays, roots_of(field, rays), depth, kTolerance);
}

TEST(FieldTrace, MissesNoFirstHitOfAHostileScene) {
  const Field field = field_of(kHostile);
  expect_no_miss(field, {}, 30);
  FieldTraceOptions led = kPlain;
  led.beams = true;
  for (const FieldTraceOptions& options :
       {kPlain, kOnlyRelaxed, led,
        FieldTraceOptions{.relax = false, .objects = false, .convex = false, .beams = false},
        kWhole, FieldTraceOptions{.convex = false, .beams = false}}) {
    expect_no_miss(field, options, 8);
  }
}

// Objects that overlap, touch each other's boxes, and lie in rows.
Field many_objects(int count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Field> nodes;
  const char* const shapes[] = {"sphere", "box", "torus", "capsule", "cylinder", "cone", "gdf"};
  for (int i = 0; i < count; ++i) {
    Field node = make_field(shapes[i % std::size(shapes)]);
    if (i % 5 == 0) node = make_field("twist", {{"turns", 0.2}}, {make_field("box")});
    const double s = 0.1 + 0.2 * unit(random);
    node = make_field("scale", {{"by", {s, s, i % 3 == 0 ? 0.4 * s : s}}}, {node});
    if (i % 2 == 0) node = make_field("rotate", {{"by", {360 * unit(random), 50, 0}}}, {node});
    const double z = i % 4 == 0 ? 0 : 2 * unit(random);
    nodes.push_back(
        make_field("translate", {{"by", {2 * unit(random), 2 * unit(random), z}}}, {node}));
  }
  return make_field("union", {}, nodes);
}

TEST(FieldTrace, MissesNoFirstHitAmongManyObjects) {
  const Field field = many_objects(150);
  expect_no_miss(field, {}, 5);
  expect_no_miss(field, {.convex = false, .beams = false}, 4);
  expect_no_miss(field, kWhole, 1);
  const Field turned = make_field("rotate", {{"by", {10, 20, 30}}}, {field});
  expect_no_miss(make_field("union", {}, {turned, make_field("box")}), {}, 3);
}

// A picture, and where the first roots of its rays are.
struct Proved {
  Camera camera;
  std::vector<Ray> rays;
  std::vector<test::FirstRoot> roots;
};
Proved proved(const Field& field, const Box& region, const Camera& camera) {
  Proved made{camera, {}, {}};
  const RayGenerator generator(camera);
  for (int i = 0; i < camera.width * camera.height; ++i) {
    made.rays.push_back(through_pixel(generator, i, camera.width));
    made.roots.push_back(test::first_root(field, made.rays.back(), region));
  }
  return made;
}

// The picture, and its rays in calls of so many.
void expect_right(const FieldTracer& tracer, const Proved& of, std::size_t call) {
  const double tolerance = 0.02 * glm::length(RayGenerator(of.camera).right());
  const HitBuffer picture = tracer.trace_primary(of.camera, Job());
  expect_right(tracer.field(), of.rays, of.roots, picture.depth, tolerance);
  std::vector<float> depth(of.rays.size());
  for (std::size_t i = 0; i < depth.size(); i += call) {
    const std::size_t n = std::min(call, depth.size() - i);
    tracer.trace(std::span(of.rays).subspan(i, n), tolerance, std::span(depth).subspan(i, n), {});
  }
  expect_right(tracer.field(), of.rays, of.roots, depth, tolerance);
}

// Every set of switches finds the same first hits, from around and from within: those proved.
TEST(FieldTrace, SwitchesChangeTheWorkNotThePicture) {
  const Field floor = make_field("plane", {{"normal", {0.1, 1, 0}}, {"distance", -0.1}});
  const Field field = make_field("union", {}, {many_objects(40), floor});
  const Box region{glm::dvec3(-0.5), glm::dvec3(2.5)};
  Camera camera = frame(region, 13, 9);
  const Proved around = proved(field, region, camera);
  camera.eye = {1, 1, 1};
  while (field(glm::vec3(camera.eye)) < 0.01F) camera.eye.y += 0.01;
  const Proved within = proved(field, region, camera);
  for (int off = 0; off < 256 && !HasFatalFailure(); ++off) {
    SCOPED_TRACE(off);
    FieldTraceOptions options;
    bool* const switches[] = {&options.relax,   &options.local_bounds, &options.prune,
                              &options.objects, &options.boxes,        &options.convex,
                              &options.beams,   &options.bundles};
    for (int i = 0; i < 8; ++i) *switches[i] = (off >> i & 1) == 0;
    const FieldTracer tracer(field, region, options);
    expect_right(tracer, around, 100);
    expect_right(tracer, within, 100);
  }
  expect_right(FieldTracer(field, region), around, 2);
}

// Rays that run long beside a floor, nearer than a thousandth of their way, end at the wall.
TEST(FieldTrace, RaysThatGlideAlongASurfaceHitWhatIsBehind) {
  const Field field = field_of(
      "[{smooth_union: {k: 0.05, of: [{box: {size: [20, 0.2, 4]}, at: [0, -0.1, 0]}, {box: {size: "
      "[0.2, 2, 4]}, at: [9, 1, 0]}]}}]");
  std::vector<Ray> rays;
  for (int i = 0; i < 64; ++i) {
    const double height = 3e-5 * std::pow(1.1, i);
    rays.push_back(
        {{-9.5, height, 0.02 * i}, glm::normalize(glm::dvec3(1, 1e-6 * (i % 5 - 2), 0))});
  }
  const std::vector<test::FirstRoot> roots = roots_of(field, rays);
  std::vector<float> depth(rays.size());
  FieldTraceOptions alone;
  alone.bundles = false;
  for (const FieldTraceOptions& options :
       {FieldTraceOptions{}, kWhole, kPlain, kOnlyRelaxed, alone}) {
    for (const double tolerance : {3e-5, 1e-6}) {
      FieldTracer(field, region_of(field), options).trace(rays, tolerance, depth, {});
      expect_right(field, rays, roots, depth, tolerance);
      EXPECT_EQ(std::count(depth.begin(), depth.end(), kNothing), 0);
    }
  }
}

// Rings that all reach through each other: those of a large picture are pruned together, those of a
// small one met one by one. Few of them, beside each other, are met one by one in any.
TEST(FieldTrace, ACrowdIsPrunedTogether) {
  const auto rings = [](int count, double radius) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::vector<Field> nodes;
    for (int i = 0; i < count; ++i) {
      const auto angle = [&] { return 180 * unit(random); };
      const Field ring = make_field("torus", {{"major", radius}, {"minor", 0.1 * radius}});
      nodes.push_back(
          make_field("translate", {{"by", {unit(random), unit(random), unit(random)}}},
                     {make_field("rotate", {{"by", {angle(), angle(), angle()}}}, {ring})}));
    }
    return make_field("union", {}, nodes);
  };
  const auto same_work = [](const Field& field, int side) {
    const Camera camera = frame(field.bounds(), side, side);
    const auto picture = [&](const FieldTraceOptions& options) {
      return FieldTracer(field, region_of(field), options).trace_primary(camera, Job());
    };
    const HitBuffer by_itself = picture({});
    const HitBuffer whole = picture({.objects = false});
    int apart = 0;
    const double pixel = glm::length(RayGenerator(camera).right());
    for (std::size_t i = 0; i < whole.size(); ++i) {
      const double a = by_itself.depth[i];
      const double b = whole.depth[i];
      apart += a == b || std::fabs(a - b) < 0.2 * pixel * a ? 0 : 1;
    }
    EXPECT_LE(apart, 6);  // grazes
    return by_itself.depth == whole.depth && by_itself.steps == whole.steps;
  };
  EXPECT_TRUE(same_work(rings(12, 1), 320));
  EXPECT_FALSE(same_work(rings(12, 1), 96));
  EXPECT_FALSE(same_work(rings(4, 0.2), 320));
}

// A picture whose size is no multiple of any block, on one thread and on several, and its rays
// traced one by one.
TEST(FieldTrace, APictureIsThatOfItsRays) {
  const Field field = field_of(kHostile);
  const Camera camera = frame(field.bounds(), 141, 67);
  const RayGenerator rays(camera);
  const double pixel = glm::length(rays.right());
  for (const bool objects : {true, false}) {
    FieldTraceOptions options;
    options.objects = objects;
    const FieldTracer tracer(field, region_of(field), options);
    const auto picture = [&](int threads) {
      const ThreadLimit limit(threads);
      return tracer.trace_primary(camera, Job());
    };
    const HitBuffer hits = picture(1);
    const HitBuffer again = picture(4);
    ASSERT_EQ(hits.depth, again.depth);
    ASSERT_EQ(hits.steps, again.steps);
    int apart = 0;
    for (int i = 0; i < 141 * 67; ++i) {
      const Ray ray = through_pixel(rays, i, 141);
      float depth = 0;
      tracer.trace({&ray, 1}, 0.02 * pixel, {&depth, 1}, {});
      const bool same =
          depth == hits.depth[i] || std::fabs(depth - hits.depth[i]) < 0.2 * pixel * double(depth);
      apart += same ? 0 : 1;  // grazes
    }
    EXPECT_LE(apart, 4);
  }
}

// The field evaluates far from its zero as at it: what decides is how places are rounded.
TEST(FieldTrace, DepthIsPreciseFarFromTheCamera) {
  const FieldTracer tracer(field_of("[{sphere: {}}, {sphere: {}, at: [0, 0, 40]}]"),
                           {glm::dvec3(-50), glm::dvec3(50)}, kWhole);
  std::vector<Ray> rays;
  rays.reserve(40);
  for (int i = 0; i < 40; ++i) rays.push_back({{0.02 * i, 0, -10000}, {0, 0, 1}});
  std::vector<float> depth(rays.size());
  tracer.trace(rays, 1e-10, depth, {});
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double truth = 10000 - std::sqrt(1 - rays[i].origin.x * rays[i].origin.x);
    EXPECT_NEAR(depth[i], truth, 1e-3) << i;  // a float at 10000
  }
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
    const Ray ray = through_pixel(rays, i, 64);
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
  EXPECT_GT(mean(kPlain), 1.1 * mean(kOnlyRelaxed));
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

// Which are no number in a small cube.
class NoNumbers : public Sampler {
 public:
  void evaluate(int n, const float* x, const float* y, const float* z, float* out) const override {
    for (int i = 0; i < n; ++i) out[i] = static_cast<float>(value({x[i], y[i], z[i]}));
  }
  [[nodiscard]] Box hull() const override { return {{0.99, -0.01, -0.01}, {1.01, 0.01, 0.01}}; }
  [[nodiscard]] double value(const glm::dvec3& p) const override {
    const double away = glm::distance(p, glm::clamp(p, hull().lo, hull().hi));
    return away > 0 ? away : std::numeric_limits<double>::quiet_NaN();
  }
  [[nodiscard]] double step() const override { return 1e-4; }
};

// One ray goes by itself, through values that are no numbers as through others, and on.
TEST(FieldTrace, RaysEndWhereValuesAreNoNumbers) {
  const Box region{glm::dvec3(-2), glm::dvec3(5)};
  const Ray ray{{1, 0, -1}, {0, 0, 1}};
  for (const bool behind : {true, false}) {
    const Field ball =
        make_field("translate", {{"by", {1, behind ? 0.0 : 3.0, 3}}}, {make_field("sphere")});
    const Field field = make_field("union", {}, {make_field(std::make_shared<NoNumbers>()), ball});
    for (const bool objects : {true, false}) {
      FieldTraceOptions options;
      options.objects = objects;
      options.bundles = false;
      const FieldTracer tracer(field, region, options);
      float depth = 0;
      tracer.trace({&ray, 1}, 1e-5, {&depth, 1}, {});
      if (behind) {
        EXPECT_NEAR(depth, 3, 1e-3);
      } else {
        EXPECT_EQ(depth, kNothing);
      }
    }
  }
}

// Rays go in bundles, the last of which may have few; that does not make it one that goes alone.
TEST(FieldTrace, DepthsAreThoseOfOtherBundles) {
  const Field field = field_of(kHostile);
  FieldTraceOptions options;  // without what rays of a bundle have in common
  options.prune = false;
  options.beams = false;
  const FieldTracer tracer(field, region_of(field), options);
  constexpr std::size_t kLast = 5;
  std::mt19937 random(8);
  int hits = 0;
  for (int repetition = 0; repetition < 8; ++repetition) {
    std::vector<Ray> rays = bundles(region_of(field), 17, random);
    rays.resize(1025);
    std::vector<float> depth(rays.size());
    std::vector<float> other(kLast);
    tracer.trace(rays, 1e-4, depth, {});
    tracer.trace(std::span(rays).last(kLast), 1e-4, other, {});
    EXPECT_EQ(depth.back(), other.back());
    hits += std::isfinite(depth.back()) ? 1 : 0;
  }
  EXPECT_GT(hits, 2);
}

}  // namespace
}  // namespace sdfgrid
