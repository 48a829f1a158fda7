// Steps of rays: what automatic relaxation saves over plain sphere tracing; what taking a scene of
// 127 ops apart and pruning it saves; and, as CSV with --csv, evaluations per ray with a global
// constant, with local bounds, and with the factor that a user would have tuned, at equal pictures.
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
constexpr FieldTraceOptions kPlain = {.relax = false,
                                      .local_bounds = false,
                                      .prune = false,
                                      .objects = false,
                                      .convex = false,
                                      .beams = false};

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

// Pixels that one hits and the other does not, or half a pixel's width or more from where.
std::size_t differences(const Traced& a, const Traced& b, double tolerance) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < a.depth.size(); ++i) {
    const bool both = a.depth[i] < kNothing && b.depth[i] < kNothing;
    const double apart = both ? std::fabs(double(a.depth[i]) - double(b.depth[i])) : 0;
    n += (a.depth[i] < kNothing) != (b.depth[i] < kNothing) ||
                 apart > 25 * tolerance * double(a.depth[i])
             ? 1
             : 0;
  }
  return n;
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
        const double r = double(c[3 * n + k]);
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
  fmt::print("{},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{},{}\n", name, global.evaluations,
             best.evaluations, local.evaluations, all.evaluations, tuned,
             differences(global, local, view.tolerance()),
             differences(global, all, view.tolerance()));
}

}  // namespace

int main(int argc, char** argv) {
  const ThreadLimit one(1);
  if (argc > 1 && std::strcmp(argv[1], "--csv") == 0) {
    fmt::print(
        "scene,global constant,tuned factor,local bounds,all of sdfgrid,factor,pixels that "
        "differ with local bounds,with all\n");
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
