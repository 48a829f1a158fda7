// sdfgrid sample: distances of a grid, a mesh or a scene at points, for numpy.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <random>

#include "command.h"
#include "inputs.h"
#include "options.h"
#include "scenes.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/atlas.h"
#include "sdfgrid/mesh/orient.h"
#include "sdfgrid/mesh/reference.h"
#include "sdfgrid/scene/files.h"
#include "sdfgrid/trace/trace.h"
#include "sdfgrid/volume/write.h"

namespace sdfgrid::cli {
namespace {

struct Options {
  std::string input;
  Output output;
  std::string points;
  std::size_t random = 0;
  bool near_surface = false;
  bool gradient = false;
  std::uint64_t seed = 1;
  double time = 0;
};

// What is sampled: a signed distance with its gradient.
struct Sampled {
  std::string kind;
  Box bounds;
  std::function<double(const glm::dvec3&)> value;
  std::function<ValueGradient(const glm::dvec3&)> at;
};

Sampled sampled_grid(const std::string& path, const Job& job) {
  const Grid grid = read_distances(path, false);
  const auto atlas = std::make_shared<const Atlas>(make_atlas(grid, job));
  const double half = 0.5 * grid.lattice().voxel;
  const auto value = [atlas](const glm::dvec3& p) { return double(distance_at(*atlas, p)); };
  return {"grid", grid.bounds(), value, [atlas, half](const glm::dvec3& p) {
            ValueGradient r{distance_at(*atlas, p), glm::dvec3(0)};
            for (int a = 0; a < 3; ++a) {
              glm::dvec3 step(0);
              step[a] = half;
              r.gradient[a] =
                  (double(distance_at(*atlas, p + step)) - double(distance_at(*atlas, p - step))) /
                  (2 * half);
            }
            return r;
          }};
}

// As `convert` and `compare` see it: turned where it is inside out.
Sampled sampled_mesh(const std::string& path, Context& context) {
  MeshFile mesh = load_mesh(path, context.job());
  for (const std::string& warning : mesh.warnings) context.warn(path + ": " + warning);
  for (const std::string& warning : orient_mesh(mesh.soup).warnings) {
    context.warn(path + ": " + warning);
  }
  const auto reference = std::make_shared<const ReferenceDistance>(mesh.soup);
  const auto signed_value = [reference](const glm::dvec3& p) {
    return reference->signed_distance(p);
  };
  return {"mesh", bounds(mesh.soup), signed_value, [reference](const glm::dvec3& p) {
            const double value = reference->signed_distance(p);
            const glm::dvec3 away = p - reference->closest(p);
            const bool known = value != 0;  // on the surface itself the direction is not
            return ValueGradient{value, known ? away / value : glm::dvec3(0)};
          }};
}

Sampled load(const Options& options, Context& context) {
  if (extension_of(options.input) == ".vdb") return sampled_grid(options.input, context.job());
  if (!names_scene(options.input)) return sampled_mesh(options.input, context);
  const Field field = load_scene(options.input, options.time, context).field;
  const auto value = [field](const glm::dvec3& p) { return double(field(glm::vec3(p))); };
  return {"scene", field.bounds(), value,
          [field](const glm::dvec3& p) { return field.gradient(p); }};
}

// Random numbers that are the same on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double unit() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }
  glm::dvec3 within(const Box& box) {
    const double x = unit();
    const double y = unit();
    return box.lo + box.size() * glm::dvec3(x, y, unit());
  }
  // Normally distributed (Box and Muller 1958).
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - unit()));
    return radius * std::cos(6.283185307179586 * unit());
  }

 private:
  std::mt19937_64 engine_;
};

// A point of the surface: where a random chord from outside to inside crosses it.
glm::dvec3 on_surface(const Sampled& sampled, const Box& box, Random& random) {
  constexpr int kTries = 10000;
  const auto inside = [&](const glm::dvec3& p) { return sampled.value(p) < 0; };
  for (int i = 0; i < kTries; ++i) {
    glm::dvec3 a = random.within(box);
    glm::dvec3 b = random.within(box);
    const bool a_inside = inside(a);
    if (a_inside == inside(b)) continue;
    for (int k = 0; k < 40; ++k) {
      const glm::dvec3 middle = 0.5 * (a + b);
      (inside(middle) == a_inside ? a : b) = middle;
    }
    return 0.5 * (a + b);
  }
  throw Error(ErrorKind::failed,
              "no inside was found to sample the surface of; leave --near-surface out");
}

// Each thousand has a seed of its own, so that threads do not matter.
std::vector<glm::dvec3> random_points(const Options& options, const Sampled& sampled,
                                      const Job& job) {
  constexpr std::size_t kGroup = 1000;
  constexpr double kMargin = 0.1;   // of the bounds' size, all round
  constexpr double kSpread = 0.01;  // of the diagonal
  const Box& bounds = sampled.bounds;
  for (int a = 0; a < 3; ++a) {
    if (bounds.lo[a] <= bounds.hi[a] && std::isfinite(bounds.size()[a])) continue;
    throw Error(ErrorKind::input, options.input + ": it is empty or has no end; give --points");
  }
  const Box box{bounds.lo - kMargin * bounds.size(), bounds.hi + kMargin * bounds.size()};
  const double spread = kSpread * glm::length(bounds.size());
  std::vector<glm::dvec3> points(options.random);
  parallel_for(
      (points.size() + kGroup - 1) / kGroup, 1, job, [&](std::size_t from, std::size_t to) {
        for (std::size_t g = from; g < to; ++g) {
          Random random(options.seed * 0x9e3779b97f4a7c15ULL + g);
          for (std::size_t i = g * kGroup; i < std::min((g + 1) * kGroup, points.size()); ++i) {
            if (i % 50 == 0) job.checkpoint();
            if (!options.near_surface) {
              points[i] = random.within(box);
              continue;
            }
            points[i] = on_surface(sampled, box, random);
            for (int a = 0; a < 3; ++a) points[i][a] += spread * random.normal();
          }
        }
      });
  return points;
}

// Rows in double: as floats, positions in survey coordinates would be others than those that the
// distances belong to.
std::vector<double> make_table(const Options& options, const Sampled& sampled,
                               const std::vector<glm::dvec3>& points, const Job& job) {
  const std::size_t columns = options.gradient ? 7 : 4;
  std::vector<double> table(points.size() * columns);
  parallel_for(points.size(), 512, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const ValueGradient r = sampled.at(points[i]);
      double* row = table.data() + i * columns;
      for (int a = 0; a < 3; ++a) row[a] = points[i][a];
      row[3] = r.value;
      for (int a = 0; a < 3 && options.gradient; ++a) row[4 + a] = r.gradient[a];
    }
  });
  return table;
}

Exit run(const Options& options, const CLI::App& app, Context& context) {
  check_output(options.output);
  check_options_for(app, {kind_of(options.input, false)});
  if (options.points.empty() == (options.random == 0)) {
    throw Error(ErrorKind::usage, "give either --points FILE or --random N");
  }
  const Job& job = context.job();
  Stopwatch watch;
  const Sampled sampled = load(options, context);
  const std::vector<glm::dvec3> points = options.points.empty()
                                             ? random_points(options, sampled, job)
                                             : read_points(options.points, job);
  watch.lap("read");
  const std::vector<double> table = make_table(options, sampled, points, job);
  watch.lap("sample");
  write_table(table, options.gradient ? 7 : 4, options.output.path);
  watch.lap("write");
  Json& result = context.result();
  result["kind"] = sampled.kind;
  result["points"] = points.size();
  result["columns"] = options.gradient ? 7 : 4;
  result["seconds"] = watch.seconds();
  context.print("{}: {} rows of x, y, z, distance{}; {:.2f} s", options.output.path, points.size(),
                options.gradient ? ", gradient" : "", result["seconds"]["total"].get<double>());
  return Exit::done;
}

}  // namespace

Run add_sample(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("IN", options->input, "grid (.vdb), mesh or scene (.yaml, .json)")->required();
  add_output(app, options->output, {".npy"});
  auto* points = app.add_option("--points", options->points,
                                "n x 3 array (.npy) of points, or a text with one a line");
  auto* random = app.add_option("--random", options->random,
                                "as many points at random in the bounds and around")
                     ->check(whole_number(1, 1000000000))
                     ->excludes(points);
  app.add_flag("--near-surface", options->near_surface,
               "random points about the surface, 1 % of the diagonal away")
      ->needs(random);
  app.add_flag("--gradient", options->gradient, "three more columns: the distance's gradient");
  app.add_option("--seed", options->seed, "of the random points")
      ->needs(random)
      ->capture_default_str();
  add_scene_options(app, options->time);
  return [options, &app](Context& context) { return run(*options, app, context); };
}

}  // namespace sdfgrid::cli
