// Many objects: what a ray costs with each of the things that spare it objects switched on and off
// (FieldTraceOptions):
//   boxes     a hierarchy of boxes and a heap ordered by distance; off: all objects of the scene
//   triangle  an object is evaluated only where its last value ends; off: at every step of the ray
//             (the option `objects`)
//   convex    steps past convex objects follow the secant
// one ray at a time, as Hart (1996) and Krayer (2016) have it, and then in bundles, all on and
// without objects. Objects: spheres, boxes, capsules, tori, turned any way, a hundredth of a cube
// full, with a plane without end under them and without; and nine spheres over a plane. Then a
// thousand of them with others beside and behind the view, which no ray comes near: `objects`
// counts those. CSV on standard output. usage: objects_bench [MOST_OBJECTS]; one thread, CPU time
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <string_view>
#include <vector>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/trace/field_trace.h"

using namespace sdfgrid;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRadian = std::numbers::pi / 180;
constexpr int kSide = 256;  // pixels of the picture
constexpr const char* kOthers = "a thousand and others";
constexpr int kSets = 8;  // of switches

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// So large that `count` of them fill a hundredth of a cube of edge 2.
class RandomObjects {
 public:
  explicit RandomObjects(int count) : size_(0.45 * std::cbrt(1.0 / count)) {}

  double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  [[nodiscard]] double size() const { return size_; }

  // The i-th, at the origin, turned any way.
  Field next(int i) {
    const double r = size_ * (0.4 + 0.6 * unit());
    Field node;
    switch (i % 4) {
      case 0:
        node = make_field("sphere", {{"radius", r}});
        break;
      case 1:
        node = make_field("box", {{"size", {1.5 * r, 1.2 * r, r}}});
        break;
      case 2:
        node = make_field("torus", {{"major", r}, {"minor", 0.3 * r}});
        break;
      default:
        node =
            make_field("capsule", {{"from", {0, 0, -r}}, {"to", {0, 0, r}}, {"radius", 0.4 * r}});
    }
    const auto angle = [&] { return 360 * unit(); };
    return make_field("rotate", {{"by", {angle(), angle(), angle()}}}, {node});
  }
  // A place in a cube of half the edge `reach`.
  glm::dvec3 place(double reach) {
    const auto one = [&] { return reach * (2 * unit() - 1); };
    return {one(), one(), one()};
  }

 private:
  double size_;
  std::mt19937 random_{5};
};

Field moved(const Field& node, const glm::dvec3& by) {
  return make_field("translate", {{"by", {by.x, by.y, by.z}}}, {node});
}

std::vector<Field> strewn(RandomObjects& random, int count) {
  std::vector<Field> nodes;
  for (int i = 0; i < count; ++i) {
    const Field node = random.next(i);
    nodes.push_back(moved(node, random.place(1)));
  }
  return nodes;
}

Field random_objects(int count) {
  RandomObjects random(count);
  return make_field("union", {}, strewn(random, count));
}

Field over_a_plane(const Field& objects, double height) {
  const Field plane = make_field("plane", {{"normal", {0, 1, 0}}, {"distance", height}});
  return make_field("union", {}, {plane, objects});
}

Field nine_spheres_and_plane() {
  std::vector<Field> nodes;
  for (const double x : {-1, 0, 1}) {
    for (const double z : {-1, 0, 1}) {
      nodes.push_back(moved(make_field("sphere", {{"radius", 0.3}}), {x, 0.3, z}));
    }
  }
  return over_a_plane(make_field("union", {}, nodes), 0);
}

struct Shot {
  Field field;
  Box region;
  Camera camera;
};

template <class Count>
void report(const char* scene, int objects, const char* how, const std::vector<float>& depth,
            const std::vector<Count>& steps, double seconds) {
  const auto n = static_cast<double>(depth.size());
  const auto hits =
      std::count_if(depth.begin(), depth.end(), [](float d) { return std::isfinite(d); });
  fmt::print("{},{},{},{},{:.3f},{:.3f},{:.4f}\n", scene, objects, how, depth.size(),
             std::accumulate(steps.begin(), steps.end(), 0.0) / n, 1e6 * seconds / n,
             static_cast<double>(hits) / n);
}

// With every set of switches, or the last of them: all on.
void single(const char* scene, int objects, const Shot& view, int first_set = 0) {
  const RayGenerator generator(view.camera);
  const double tolerance = 0.02 * glm::length(generator.right());
  // The same pixels in the same order, as many as there is time for.
  std::vector<int> pixels(kSide * kSide);
  std::iota(pixels.begin(), pixels.end(), 0);
  std::shuffle(pixels.begin(), pixels.end(), std::mt19937(1));
  for (int bits = first_set; bits < kSets; ++bits) {
    FieldTraceOptions on;
    on.bundles = false;
    on.boxes = (bits & 1) != 0;
    on.objects = (bits & 2) != 0;
    on.convex = (bits & 4) != 0;
    const int most = on.boxes ? 8192 : std::clamp(400000 / std::max(objects, 1), 8, 8192);
    const FieldTracer tracer(view.field, view.region, on);
    std::vector<Ray> rays;
    rays.reserve(static_cast<std::size_t>(most));
    for (int i = 0; i < most; ++i) {
      const int row = pixels[i] / kSide;
      rays.push_back(generator.ray(pixels[i] % kSide + 0.5, row + 0.5));
    }
    std::vector<float> depth(rays.size());
    std::vector<std::uint32_t> steps(rays.size());
    const double start = cpu_seconds();
    tracer.trace(rays, tolerance, depth, steps);
    const double seconds = cpu_seconds() - start;
    const std::string how =
        fmt::format("{}{}{}{}", on.boxes ? " boxes" : "", on.objects ? " triangle" : "",
                    on.convex ? " convex" : "", bits == 0 ? " none" : "");
    report(scene, objects, how.c_str() + 1, depth, steps, seconds);
  }
}

void bundles(const char* scene, int objects, const Shot& view) {
  for (const bool all : {true, false}) {
    if (!all && (objects > 2000 || std::string_view(scene) == kOthers)) continue;
    FieldTraceOptions options;
    options.objects = options.convex = all;
    const FieldTracer tracer(view.field, view.region, options);
    HitBuffer made;
    double seconds = kInfinity;  // the least of a few
    for (int i = 0; i < (all ? 5 : 1); ++i) {
      const double start = cpu_seconds();
      made = tracer.trace_primary(view.camera, Job());
      seconds = std::min(seconds, cpu_seconds() - start);
    }
    report(scene, objects, all ? "bundles" : "bundles without objects", made.depth, made.steps,
           seconds);
  }
}

// All others at least their own size away from what the camera sees: from the pyramid with the eye
// for its apex. As dense as those in view.
Shot with_others(int near, int others) {
  RandomObjects random(near);
  std::vector<Field> nodes = strewn(random, near);
  const Box view{glm::dvec3(-1.1), glm::dvec3(1.1)};
  const Camera camera = frame(view, kSide, kSide);
  const glm::dvec3 forward = glm::normalize(camera.target - camera.eye);
  const double corner = std::atan(std::sqrt(2.0) * std::tan(0.5 * camera.fov * kRadian));
  const double reach = std::cbrt(8.0 + 8.0 * others / near) + glm::length(camera.eye);
  for (int i = 0; i < others;) {
    const glm::dvec3 at = random.place(reach);
    const glm::dvec3 from_eye = at - camera.eye;
    const double ahead = glm::dot(from_eye, forward);
    const double aside = glm::length(from_eye - ahead * forward);
    const double gap = aside * std::cos(corner) - ahead * std::sin(corner);
    if (gap < 2 * random.size() || glm::length(at) < 2) continue;
    nodes.push_back(moved(random.next(i), at));
    ++i;
  }
  const Field field = make_field("union", {}, nodes);
  const Box box = field.bounds();
  return {field, {box.lo - 1e-3, box.hi + 1e-3}, camera};
}

void run(const char* scene, int objects, const Shot& view, int first_set = 0) {
  single(scene, objects, view, first_set);
  bundles(scene, objects, view);
}

Shot shot_of(const Field& field, const Box& box) {
  return {field, {box.lo - 1e-3, box.hi + 1e-3}, frame(box, kSide, kSide)};
}

// Nine spheres in view, and the plane as far as the region goes.
Shot spheres_and_plane() {
  Shot shot = shot_of(nine_spheres_and_plane(), {{-1.4, 0, -1.4}, {1.4, 0.6, 1.4}});
  shot.region = {glm::dvec3(-20), glm::dvec3(20)};
  return shot;
}

}  // namespace

int main(int argc, char** argv) {
  const int most = argc > 1 ? std::atoi(argv[1]) : 100000;
  const ThreadLimit one(1);
  fmt::print("scene,objects,switches on,rays,evaluations a ray,microseconds a ray,hits\n");
  run("spheres and plane", 10, spheres_and_plane());
  for (int n = 10; n <= most; n *= 10) {
    const Field objects = random_objects(n);
    const Box box = objects.bounds();
    run("random", n, shot_of(objects, box));
    run("random and plane", n, shot_of(over_a_plane(objects, box.lo.y), box), kSets - 1);
  }
  for (int n = 0; n <= most; n = n == 0 ? 1000 : 10 * n) {
    run(kOthers, n, with_others(1000, n), kSets - 1);
  }
  return 0;
}
