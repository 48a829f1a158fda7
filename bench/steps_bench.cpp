// Steps of rays: what automatic relaxation saves over plain sphere tracing; what taking a scene of
// 127 ops apart and pruning it saves; and, as CSV with --csv, evaluations per ray with a global
// constant, with local bounds, and with the factor that a user would have tuned, at pictures that
// are equal but for rays that graze: where they differ they are held against the truth.
// usage: steps_bench [--csv] [REPETITIONS [PIXELS]]; one thread, CPU time
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>

#include "csg_scene.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/scene/build.h"
#include "sdfgrid/trace/field_march.h"
#include "sdfgrid/trace/field_trace.h"

using namespace sdfgrid;

namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();
int pixels = 512;  // a side
constexpr FieldTraceOptions kPlain = kPlainSphereTracing;

struct Named {
  const char* name;
  const char* nodes;  // YAML
};

const Named kScenes[] = {
    {"three solids",
     "[{sphere: {}}, {box: {size: [1, 1, 1]}, at: [2, 0, 0]}, {torus: {}, at: [0, 2, 0]}]"},
    {"blend over a floor",
     "[{smooth_union: {k: 0.4, of: [{sphere: {radius: 0.8}}, {box: {size: [2, 0.6, 0.6]}}, {torus: "
     "{major: 1, minor: 0.2}}]}, at: [0, 1, 0]}, {box: {size: [8, 0.2, 8]}}]"},
    {"cut columns",
     "{difference: [{box: {size: [3, 3, 3]}}, {intersection: [{repeat: {cell: [0.75, 0.75, 0], of: "
     "{infinite_cylinder: {radius: 0.25}}}}, {box: {size: [3.1, 3.1, 3.1]}}]}]}"},
};
// Fields whose slope had to be bounded.
const Named kWarped[] = {
    {"twist", "{twist: {turns: 0.5, of: {box: {size: [1, 0.4, 2]}}}}"},
    {"bend", "{bend: {angle: 60, of: {box: {size: [3, 0.4, 0.6]}}}}"},
    {"taper", "{taper: {from: 1, to: 0.25, of: {box: {size: [1, 1, 2]}}}}"},
    {"noise",
     "{displace: {by: {noise: {frequency: 3, amplitude: 0.1, octaves: 3}}, of: {sphere: {}}}}"},
    {"formula",
     "{formula: {f: \"x^4 + y^4 + z^4 - x^2 - y^2 - z^2 + 0.45\", bounds: [[-1.2, -1.2, -1.2], "
     "[1.2, 1.2, 1.2]]}}"},
};

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

Field field_of(const char* nodes) {
  const SceneFile file = parse_scene(fmt::format("sdfgrid: 1\nscene: {}", nodes), "bench");
  return build_scene(file.scene, "bench", 0, Job()).field;
}

struct Shot {
  Field field;
  Box region;
  Camera camera;
  explicit Shot(const Field& f) : field(f), region(f.bounds()) {
    camera = frame(region, pixels, pixels);
    region = {region.lo - 1e-3, region.hi + 1e-3};
  }
  [[nodiscard]] double tolerance() const {
    return 0.02 * glm::length(RayGenerator(camera).right());
  }
};

struct Traced {
  std::vector<float> depth;
  double evaluations = 0;  // a ray
  double seconds = 0;
};

Traced picture(const Shot& view, const FieldTraceOptions& options, int repetitions) {
  const FieldTracer tracer(view.field, view.region, options);
  Traced made;
  std::vector<double> seconds;
  for (int i = 0; i < repetitions; ++i) {
    const double start = cpu_seconds();
    const HitBuffer hits = tracer.trace_primary(view.camera, Job());
    seconds.push_back(cpu_seconds() - start);
    made.depth = hits.depth;
    made.evaluations = std::accumulate(hits.steps.begin(), hits.steps.end(), 0.0) /
                       static_cast<double>(hits.size());
  }
  made.seconds = *std::min_element(seconds.begin(), seconds.end());
  return made;
}

constexpr double kHalf = 25;  // tolerances: half a pixel's width

// Whether one hits and the other does not, or half a pixel's width or more from where.
bool differ(float a, float b, double tolerance) {
  if (a == kNothing || b == kNothing) return a != b;
  return std::fabs(double(a) - double(b)) > kHalf * tolerance * double(a);
}

std::size_t differences(const Traced& a, const Traced& b, double tolerance) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < a.depth.size(); ++i) {
    n += differ(a.depth[i], b.depth[i], tolerance) ? 1 : 0;
  }
  return n;
}

// Where a ray first is inside, by a dense search in double precision; infinite if nowhere.
double first_root(const Field& field, const Ray& ray, const Span& span) {
  constexpr int kSamples = 4000;
  const auto inside = [&](double t) {
    return field.gradient(ray.origin + t * ray.direction).value < 0;
  };
  double before = span.from;
  for (int i = 0; i <= kSamples; ++i) {
    double t = span.from + (span.to - span.from) * i / kSamples;
    if (inside(t)) {
      for (int k = 0; k < 50; ++k) {
        const double middle = 0.5 * (before + t);
        (inside(middle) ? t : before) = middle;
      }
      return t;
    }
    before = t;
  }
  return std::numeric_limits<double>::infinity();
}

// From a point to the nearest of the surface that is found within `most` in many directions (a
// twisted corner is seen in few of them); infinite if none is.
double to_surface(const Field& field, const glm::dvec3& start, double most) {
  constexpr int kSamples = 64;
  constexpr int kDirections = 300;  // Fibonacci's lattice on the sphere
  const bool outside = field.gradient(start).value >= 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kDirections; ++i) {
    const double z = (2 * i + 1.0) / kDirections - 1;
    const double angle = 2.399963229728653 * i;
    const double across = std::sqrt(1 - z * z);
    const glm::dvec3 direction(across * std::cos(angle), across * std::sin(angle), z);
    for (int k = 1; k <= kSamples; ++k) {
      const double r = most * k / kSamples;
      if (r >= nearest) break;
      if ((field.gradient(start + r * direction).value >= 0) != outside) nearest = r;
    }
  }
  return nearest;
}

// The pixels in which two pictures differ, held against the truth.
struct Difference {
  std::size_t pixels = 0;
  std::size_t missed = 0;  // that either does not hit though there is something, or not the first
  double farthest = 0;     // of the hits from the surface, in widths of a pixel
};

Difference difference(const Shot& view, const Traced& a, const Traced& b) {
  const RayGenerator generator(view.camera);
  const double tolerance = view.tolerance();
  Difference found;
  for (std::size_t i = 0; i < a.depth.size(); ++i) {
    if (!differ(a.depth[i], b.depth[i], tolerance)) continue;
    ++found.pixels;
    const auto side = static_cast<std::size_t>(pixels);
    const std::size_t row = i / side;
    const Ray ray = generator.ray(double(i % side) + 0.5, double(row) + 0.5);
    const double root = first_root(view.field, ray, clip(ray, view.region));
    for (const Traced* made : {&a, &b}) {
      const auto depth = double(made->depth[i]);
      if (depth > root * (1 + tolerance)) ++found.missed;
      if (depth == double(kNothing)) continue;
      const double width = 2 * kHalf * tolerance * depth;
      const double off = to_surface(view.field, ray.origin + depth * ray.direction, width);
      found.farthest = std::max(found.farthest, off / width);
    }
  }
  return found;
}

// Returns how many times fewer evaluations the relaxed rays take.
double relaxation(const char* name, const Field& field) {
  const Shot view(field);
  FieldTraceOptions relaxed = kPlain;
  relaxed.relax = true;
  const Traced a = picture(view, kPlain, 1);
  const Traced b = picture(view, relaxed, 1);
  fmt::print(
      "{:>20}: {:6.2f} evaluations a ray, relaxed {:6.2f}: {:.2f} times fewer; {} of {} "
      "pixels differ\n",
      name, a.evaluations, b.evaluations, a.evaluations / b.evaluations,
      differences(a, b, view.tolerance()), a.depth.size());
  return a.evaluations / b.evaluations;
}

// Sphere tracing with `factor` times the certified value, in batches. It stops at a quarter of the
// tolerance: divided by the largest slope there is, values are small far from the surface too.
Traced with_factor(const Shot& view, double factor) {
  constexpr int kMostSteps = 5000;
  const RayGenerator generator(view.camera);
  const double tolerance = view.tolerance();
  Traced made;
  made.depth.assign(static_cast<std::size_t>(pixels) * pixels, kNothing);
  double evaluations = 0;
  for (int row = 0; row < pixels; ++row) {
    std::vector<Ray> rays;
    std::vector<Span> spans;
    std::vector<int> active;
    for (int i = 0; i < pixels; ++i) {
      rays.push_back(generator.ray(i + 0.5, row + 0.5));
      spans.push_back(clip(rays.back(), view.region));
      if (spans[i].from < spans[i].to) active.push_back(i);
    }
    for (int step = 0; step < kMostSteps && !active.empty(); ++step) {
      const std::size_t n = active.size();
      std::vector<float> c(4 * n);
      for (std::size_t k = 0; k < n; ++k) {
        const Ray& ray = rays[active[k]];
        const glm::dvec3 p = ray.origin + spans[active[k]].from * ray.direction;
        for (int a = 0; a < 3; ++a) c[a * n + k] = static_cast<float>(p[a]);
      }
      view.field.evaluate(n, c.data(), c.data() + n, c.data() + 2 * n, c.data() + 3 * n);
      evaluations += static_cast<double>(n);
      std::vector<int> left;
      for (std::size_t k = 0; k < n; ++k) {
        Span& s = spans[active[k]];
        const auto r = double(c[3 * n + k]);
        if (r < 0.25 * tolerance * s.from) {
          made.depth[std::size_t(row) * pixels + active[k]] = static_cast<float>(s.from);
        } else if ((s.from += factor * r) < s.to) {
          left.push_back(active[k]);
        }
      }
      active = left;
    }
  }
  made.evaluations = evaluations / static_cast<double>(made.depth.size());
  return made;
}

void apart(const Field& field, int repetitions) {
  const Shot view(field);
  FieldTraceOptions pruned = kPlain;
  pruned.prune = true;
  FieldTraceOptions led = pruned;
  led.beams = true;
  FieldTraceOptions relaxed = led;
  relaxed.relax = true;
  const struct {
    const char* name;
    FieldTraceOptions options;
  } rows[] = {{"plain", kPlain},
              {"pruned per tile", pruned},
              {"and beams", led},
              {"and relaxed", relaxed},
              {"all, objects too", {}}};
  Traced plain;
  double loop = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repetitions; ++i) {
    const double start = cpu_seconds();
    (void)with_factor(view, 1);
    loop = std::min(loop, cpu_seconds() - start);
  }
  for (const auto& row : rows) {
    const Traced made = picture(view, row.options, repetitions);
    if (plain.depth.empty()) plain = made;
    fmt::print(
        "{:>20}: {:6.2f} evaluations a ray, {:.4f} s, {:5.2f} times as fast as plain, {:5.2f} as a "
        "plain loop; {} of {} pixels differ\n",
        row.name, made.evaluations, made.seconds, plain.seconds / made.seconds, loop / made.seconds,
        differences(plain, made, view.tolerance()), made.depth.size());
  }
}

void steps_row(const char* name, const Field& field) {
  const Shot view(field);
  const Traced global = with_factor(view, 1);
  // The largest factor whose picture is the same but for one pixel in ten thousand.
  double tuned = 1;
  Traced best = global;
  for (double factor = 1.1; factor < 30; factor *= 1.1) {
    Traced made = with_factor(view, factor);
    if (differences(global, made, view.tolerance()) > made.depth.size() / 10000) break;
    tuned = factor;
    best = std::move(made);
  }
  FieldTraceOptions options = kPlain;
  options.local_bounds = true;
  const Traced local = picture(view, options, 1);
  const Traced all = picture(view, {}, 1);
  const Difference by_local = difference(view, global, local);
  const Difference by_all = difference(view, global, all);
  fmt::print("{},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{},{},{},{:.2f}\n", name, global.evaluations,
             best.evaluations, local.evaluations, all.evaluations, tuned, by_local.pixels,
             by_all.pixels, by_local.missed + by_all.missed,
             std::max(by_local.farthest, by_all.farthest));
}

}  // namespace

int main(int argc, char** argv) {
  const ThreadLimit one(1);
  if (argc > 1 && std::strcmp(argv[1], "--csv") == 0) {
    fmt::print(
        "scene,global constant,tuned factor,local bounds,all of sdfgrid,factor,pixels that "
        "differ with local bounds,with all,first hits missed there,farthest hit there from the "
        "surface "
        "(pixels)\n");
    for (const Named& scene : kWarped) steps_row(scene.name, field_of(scene.nodes));
    return 0;
  }
  const int repetitions = argc > 1 ? std::max(1, std::atoi(argv[1])) : 3;
  if (argc > 2) pixels = std::max(1, std::atoi(argv[2]));
  std::mt19937 random(42);
  const Field csg = csg_scene(0, kSolids, random).field;
  fmt::print("relaxation against plain sphere tracing, {}^2 rays\n", pixels);
  double product = relaxation("127 ops", csg);
  int scenes = 1;
  const auto all = [&](std::span<const Named> list) {
    for (const Named& scene : list) {
      product *= relaxation(scene.name, field_of(scene.nodes));
      ++scenes;
    }
  };
  all(kScenes);
  all(kWarped);
  fmt::print("geometric mean of {} scenes: {:.2f} times fewer\n", scenes,
             std::pow(product, 1.0 / scenes));
  fmt::print("the scene of {} ops\n", csg.size());
  apart(csg, repetitions);
  return 0;
}
