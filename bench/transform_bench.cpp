// Dense distance transforms: speed and error in one run, one thread unless said.
//
//   transform_bench [--dim=512] [--march-dim=256] [--repetitions=3]
//   [--only=masks|threads|marching|peers|mesh]
//                   [--mesh=FILE --mesh-dim=512 --width=10] [--stability]
//
// Speed is samples by the processor's seconds of this process (less sensitive to what else the
// machine does than the clock), the best of the repetitions. Peers: OpenVDB's fast sweeping and,
// where it was found, ITK here; scipy and scikit-fmm by bench/transform_peers.py, with the same
// shapes, called at the end. --stability prints the figures of docs/stability.md instead.
#include "transform_bench.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/FastSweeping.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <glm/geometric.hpp>
#include <random>
#include <string>
#include <vector>

#include "sdfgrid/core/isa.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/transform/chamfer.h"
#include "sdfgrid/transform/transform.h"

namespace sdfgrid::bench {
namespace {

struct Settings {
  int dim = 512;
  int march_dim = 256;
  int repetitions = 3;
  std::string only;  // everything if empty
  std::string mesh;
  int mesh_dim = 512;
  double width = 10;
  bool stability = false;
  bool help = false;

  [[nodiscard]] bool wants(const std::string& part) const { return only.empty() || only == part; }
};

Settings parse(int count, char** words) {
  Settings settings;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const auto value = word.substr(word.find('=') + 1);
    if (word.starts_with("--dim=")) settings.dim = std::stoi(value);
    if (word.starts_with("--march-dim=")) settings.march_dim = std::stoi(value);
    if (word.starts_with("--repetitions=")) settings.repetitions = std::stoi(value);
    if (word.starts_with("--only=")) settings.only = value;
    if (word.starts_with("--mesh=")) settings.mesh = value;
    if (word.starts_with("--mesh-dim=")) settings.mesh_dim = std::stoi(value);
    if (word.starts_with("--width=")) settings.width = std::stod(value);
    if (word == "--stability") settings.stability = true;
    if (word == "--help") settings.help = true;
  }
  return settings;
}

// A shape by its (exact) signed distance from the middle of a volume of n^3.
using Distance = std::function<double(const glm::dvec3&)>;

Distance ball(double radius) {
  return [radius](const glm::dvec3& p) { return glm::length(p) - radius; };
}

Distance box(double half) {
  return [half](const glm::dvec3& p) {
    const glm::dvec3 q = glm::dvec3(std::abs(p.x), std::abs(p.y), std::abs(p.z)) - half;
    const glm::dvec3 out(std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0));
    return glm::length(out) + std::min(0.0, std::max({q.x, q.y, q.z}));
  };
}

struct Case {
  glm::ivec3 dims;
  glm::dvec3 spacing{1.0};
  std::vector<float> exact{};
  std::vector<std::uint8_t> mask{};

  [[nodiscard]] DenseSeeds masked() const { return {dims, spacing, mask}; }
  [[nodiscard]] DenseSeeds valued(SeedKind kind) const { return {dims, spacing, {}, exact, kind}; }
};

Case make_case(const glm::ivec3& dims, const Distance& distance,
               const glm::dvec3& spacing = glm::dvec3(1.0)) {
  Case c{dims, spacing};
  const glm::dvec3 middle = 0.5 * glm::dvec3(dims - 1) * spacing;
  const glm::dvec3 off = spacing * glm::dvec3(0.13, 0.29, -0.31);  // nothing is right by symmetry
  for (int i = 0; i < dims.x; ++i) {
    for (int j = 0; j < dims.y; ++j) {
      for (int k = 0; k < dims.z; ++k) {
        const double d = distance(glm::dvec3(i, j, k) * spacing - middle + off);
        c.exact.push_back(static_cast<float>(d));
        c.mask.push_back(d < 0 ? 1 : 0);
      }
    }
  }
  return c;
}

struct Errors {
  double mean = 0;
  double max = 0;
};

Errors errors(const std::vector<float>& got, const Case& c) {
  Errors e;
  for (std::size_t i = 0; i < got.size(); ++i) {
    const double d = std::abs(static_cast<double>(got[i]) - static_cast<double>(c.exact[i]));
    e.mean += d / static_cast<double>(got.size());
    e.max = std::max(e.max, d);
  }
  return e;
}

// Work for threads that share nothing but the machine: what two of them gain at best here, now.
void copy_all(std::vector<float>& from, std::vector<float>& to) {
  constexpr std::size_t kPart = 1 << 16;
  parallel_for(from.size() / kPart, 1, Job{}, [&](std::size_t begin, std::size_t end) {
    std::copy(from.begin() + static_cast<std::ptrdiff_t>(begin * kPart),
              from.begin() + static_cast<std::ptrdiff_t>(end * kPart),
              to.begin() + static_cast<std::ptrdiff_t>(begin * kPart));
  });
}
void calculate(std::vector<float>& to) {
  parallel_for(256, 1, Job{}, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      float sums[16] = {};
      for (int n = 0; n < 500'000; ++n) {
        for (float& sum : sums) sum = sum * 0.999F + 0.5F;
      }
      to[i] = sums[i % 16];
    }
  });
}

// The machine's load: processes that want to run, over the last minute.
std::string load() {
  double loads[1] = {0};
  return getloadavg(loads, 1) == 1 ? fmt::format("{:.2f}", loads[0]) : "unknown";
}

// In turn, so that other work on the machine is shared by all. Where the machine is busy, the
// processor's time tells what a second thread costs more in all.
void print_two_threads(int repetitions, const std::function<void()>& transform) {
  std::vector<float> from(std::size_t{1} << 26U, 1.0F);
  std::vector<float> to(from.size());
  struct Work {
    const char* name;
    std::function<void()> run;
    double wall[2] = {1e300, 1e300};
    double cpu[2] = {1e300, 1e300};
  };
  Work works[] = {{"meijster, outside", transform},
                  {"bare copying of 256 MB", [&] { copy_all(from, to); }},
                  {"bare arithmetic", [&] { calculate(to); }}};
  for (int r = 0; r < repetitions; ++r) {
    for (Work& work : works) {
      for (const int threads : {1, 2}) {
        const ThreadLimit limit(threads);
        const double start = cpu_seconds();
        double& wall = work.wall[threads - 1];
        wall = std::min(wall, best_seconds(1, work.run, wall_seconds));
        double& cpu = work.cpu[threads - 1];
        cpu = std::min(cpu, cpu_seconds() - start);
      }
    }
  }
  fmt::print("one thread and two, the clock's and the processor's seconds, load {}\n", load());
  for (const Work& w : works) {
    fmt::print("  {:<24} {:.3f} / {:.3f} s, ratio {:.2f}; processor {:.3f} / {:.3f} s\n", w.name,
               w.wall[0], w.wall[1], w.wall[0] / w.wall[1], w.cpu[0], w.cpu[1]);
  }
}

void run_masks(const Settings& settings) {
  const int n = settings.dim;
  Case c = make_case(glm::ivec3(n), ball(0.4 * n));
  c.exact = {};
  std::vector<float> distance(c.mask.size());
  const auto transform = [&](const TransformOptions& options) {
    distance_transform(c.masked(), options, distance, Job{});
  };
  const auto measure = [&](const std::string& what, const TransformOptions& options) {
    const ThreadLimit limit(1);
    const double seconds = best_seconds(settings.repetitions, [&] { transform(options); });
    print_speed(fmt::format("{} {}^3 {}", transform_name(options.method), n, what), distance.size(),
                seconds, 1);
  };
  const auto outside = TransformSide::outside;
  measure("ball, outside", {.side = outside});
  measure("ball, signed", {});
  measure("ball, window 8", {.side = outside, .window = 8});
  for (const auto method : {TransformMethod::chamfer345, TransformMethod::chamfer5}) {
    measure("ball, outside", {.method = method, .side = outside});
    measure("ball, signed", {.method = method});
  }
  run_itk(c.dims, c.mask, std::min(settings.repetitions, 2));
  std::mt19937 random(1);
  for (auto& m : c.mask) m = random() % 100 == 0 ? 1 : 0;
  measure("1 % noise, outside", {.side = outside});
}

void run_threads(const Settings& settings) {
  const Case c = make_case(glm::ivec3(settings.dim), ball(0.4 * settings.dim));
  std::vector<float> distance(c.mask.size());
  print_two_threads(settings.repetitions, [&] {
    distance_transform(c.masked(), {.side = TransformSide::outside}, distance, Job{});
  });
}

void run_marching(const Settings& settings) {
  const int n = settings.march_dim;
  const Case c = make_case(glm::ivec3(n), ball(0.3 * n));
  std::vector<float> distance(c.mask.size());
  const ThreadLimit limit(1);
  for (const auto method :
       {TransformMethod::fmm, TransformMethod::fmm2, TransformMethod::closest_point}) {
    for (const double bucket : {1.0 / 16, 0.0}) {
      const TransformOptions options{.method = method, .bucket_width = bucket};
      const double seconds = best_seconds(settings.repetitions, [&] {
        distance_transform(c.valued(SeedKind::distance), options, distance, Job{});
      });
      const Errors e = errors(distance, c);
      print_speed(fmt::format("{} {}^3 ball, {}: L1 {:.4f} max {:.3f}", transform_name(method), n,
                              bucket > 0 ? "buckets" : "heap", e.mean, e.max),
                  distance.size(), seconds, 1);
    }
  }
}

// OpenVDB's fast sweeping of the whole volume, from the samples beside the surface.
void run_fast_sweeping(const Settings& settings) {
  const int n = settings.march_dim;
  const Case c = make_case(glm::ivec3(n), ball(0.3 * n));
  const openvdb::CoordBBox bounds(openvdb::Coord(0), openvdb::Coord(n - 1));
  openvdb::tools::Dense<float, openvdb::tools::LayoutZYX> dense(bounds, 0.0F);
  std::copy(c.exact.begin(), c.exact.end(), dense.data());
  openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(1e6F);
  openvdb::tools::copyFromDense(dense, *grid, 0.0F, false);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  const ThreadLimit limit(1);
  openvdb::FloatGrid::Ptr swept;
  const double seconds =
      best_seconds(settings.repetitions, [&] { swept = openvdb::tools::sdfToSdf(*grid, 0.0F, 1); });
  openvdb::tools::copyToDense(*swept, dense);
  const Errors e = errors(std::vector<float>(dense.data(), dense.data() + c.exact.size()), c);
  print_speed(fmt::format("OpenVDB sdfToSdf {}^3 ball: L1 {:.4f} max {:.3f}", n, e.mean, e.max),
              c.exact.size(), seconds, 1);
}

// scipy and scikit-fmm, in their own process.
void run_peers(const Settings& settings) {
  std::fflush(stdout);
  const std::string command = fmt::format("/usr/bin/python3 {} {} {}", SDFGRID_BENCH_PEERS,
                                          settings.dim, settings.march_dim);
  if (std::system(command.c_str()) != 0) fmt::print("scipy was not found (python3-scipy)\n");
}

void print_errors(const std::string& what, const TransformOptions& options, const DenseSeeds& seeds,
                  const Case& c) {
  std::vector<float> distance(c.mask.size());
  distance_transform(seeds, options, distance, Job{});
  const Errors e = errors(distance, c);
  fmt::print("{:<58} {:<10} L1 {:.4f} max {:.4f}\n", what, transform_name(options.method), e.mean,
             e.max);
  std::fflush(stdout);
}

void run_stability() {
  using Method = TransformMethod;
  const auto methods = {Method::meijster,     Method::chamfer345, Method::chamfer3,
                        Method::chamfer5,     Method::fmm,        Method::fmm2,
                        Method::closest_point};
  const auto marching = {Method::fmm, Method::fmm2, Method::closest_point};
  const Case sphere = make_case(glm::ivec3(128), ball(38.4));
  for (const auto method : methods) {
    print_errors("binary seeds, ball 128^3", {.method = method}, sphere.masked(), sphere);
  }
  for (const int n : {32, 64, 128}) {
    const Case c = make_case(glm::ivec3(n), ball(0.3 * n));
    for (const auto method : marching) {
      print_errors(fmt::format("exact seeds, ball {}^3", n), {.method = method},
                   c.valued(SeedKind::distance), c);
      print_errors(fmt::format("linear seeds, ball {}^3", n), {.method = method},
                   c.valued(SeedKind::level), c);
    }
  }
  const Case cube = make_case(glm::ivec3(128), box(32.2));
  for (const auto method : marching) {
    print_errors("exact seeds, box 128^3", {.method = method}, cube.valued(SeedKind::distance),
                 cube);
  }
  for (const double width : {0.0, 1.0 / 64, 1.0 / 16, 0.25, 1.0, 2.0}) {
    print_errors(fmt::format("buckets of {} voxels, ball 128^3", width),
                 {.method = Method::fmm2, .bucket_width = width}, sphere.valued(SeedKind::distance),
                 sphere);
  }
  const Case flat = make_case({96, 96, 40}, ball(30), {1, 1, 10});
  for (const auto method : marching) {
    print_errors("spacing 1 : 1 : 10, exact seeds, ball", {.method = method},
                 flat.valued(SeedKind::distance), flat);
  }
  const Case gap = make_case(
      {64, 32, 32}, [](const glm::dvec3& p) { return std::abs(std::abs(p.x) - 2) - 1.25; });
  for (const auto method : marching) {
    print_errors("gap of 1.5 voxels, exact seeds", {.method = method},
                 gap.valued(SeedKind::distance), gap);
  }
  for (const auto method : {Method::chamfer345, Method::chamfer3, Method::chamfer5}) {
    const ChamferRatio ratio = chamfer_ratio(chamfer_steps({.method = method}));
    fmt::print("{:<58} {:<10} {:+.2f} % to {:+.2f} %\n", "chamfer against Euclid, all directions",
               transform_name(method), 100 * (ratio.smallest - 1), 100 * (ratio.largest - 1));
  }
}

}  // namespace

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double wall_seconds() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double>(now).count();
}

double best_seconds(int repetitions, const std::function<void()>& work, double (*clock)()) {
  double best = 1e300;
  for (int r = 0; r < repetitions; ++r) {
    const double start = clock();
    work();
    best = std::min(best, clock() - start);
  }
  return best;
}

void print_speed(const std::string& what, std::size_t samples, double seconds, int threads) {
  fmt::print("{:<46} {:>2} {:>9.1f} Mvoxel/s\n", what, threads,
             1e-6 * static_cast<double>(samples) / seconds);
  std::fflush(stdout);
}

}  // namespace sdfgrid::bench

int main(int count, char** words) {
  using namespace sdfgrid::bench;
  openvdb::initialize();
  const Settings settings = parse(count, words);
  if (settings.help) {
    fmt::print("see the head of bench/transform_bench.cpp\n");
    return 0;
  }
  fmt::print("instruction set {}\n", sdfgrid::isa_name(sdfgrid::active_isa()));
  if (settings.stability) {
    run_stability();
    return 0;
  }
  if (settings.wants("masks")) run_masks(settings);
  if (settings.wants("threads")) run_threads(settings);
  if (settings.wants("marching")) {
    run_marching(settings);
    run_fast_sweeping(settings);
  }
  if (settings.wants("peers")) run_peers(settings);
  if (settings.wants("mesh") && !settings.mesh.empty()) {
    run_mesh(settings.mesh, settings.mesh_dim, settings.width, settings.repetitions);
  }
}
