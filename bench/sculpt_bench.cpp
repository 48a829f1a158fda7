// Sculpting: error and time over strokes for each way of re-distancing, as CSV on standard output.
// scripts/chart-sculpt draws it.
//
//   sculpt_bench [STROKES]
//
// Unions and differences of balls of 8 to 13 voxels around a ball of 28, as in redistance_test.
// Errors are those of the band's samples against brute force to the surface that the grid itself
// holds (tests/edit/surface_oracle.h), in voxels: `error99` and `error_max` where the nearest
// surface is smooth, `crease99` where it is bent sharply. Times are CPU time of one thread for a
// stroke.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

#include "edit/grids.h"
#include "edit/surface_oracle.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/edit/sculptor.h"

namespace sdfgrid::bench {
namespace {

constexpr int kExtent = 52;  // voxels from the middle to what strokes reach

double cpu_milliseconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

std::vector<Stroke> random_strokes(int count) {
  std::mt19937 random(42);
  std::normal_distribution<double> direction;
  std::uniform_real_distribution<double> radius(8, 13);
  std::uniform_real_distribution<double> depth(24, 34);
  std::vector<Stroke> strokes;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 d(direction(random), direction(random), direction(random));
    const auto op = i % 2 == 0 ? StrokeOp::unite : StrokeOp::subtract;
    const glm::dvec3 at = depth(random) * glm::normalize(d);
    strokes.push_back(test::ball_stroke(op, at, radius(random)));
  }
  return strokes;
}

double percentile99(std::vector<double>& values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() * 99 / 100];
}

struct Errors {
  double error99, error_max, crease99;
};

Errors measure(const Grid& grid) {
  constexpr int kStride = 37;  // of the samples looked at; prime to the bricks' edges
  const double voxel = grid.lattice().voxel;
  const double limit = grid.background() / voxel;
  const test::SurfaceOracle oracle(grid, kExtent, 5);
  std::vector<double> smooth;
  std::vector<double> crease;
  int count = 0;
  for (int x = 4 - kExtent; x < kExtent - 4; ++x) {
    for (int y = 4 - kExtent; y < kExtent - 4; ++y) {
      for (int z = 4 - kExtent; z < kExtent - 4; ++z) {
        if (++count % kStride != 0) continue;
        const auto truth = oracle.nearest(glm::dvec3(x, y, z), limit + 0.5);
        if (truth.distance > limit || truth.distance < 1) continue;
        const double got = std::abs(double(grid.value({x, y, z})) / voxel);
        (truth.crease ? crease : smooth).push_back(std::abs(got - truth.distance));
      }
    }
  }
  const double error99 = percentile99(smooth);
  return {error99, smooth.empty() ? 0 : smooth.back(), percentile99(crease)};
}

void run(const char* name, Redistance redistance, const std::vector<Stroke>& strokes) {
  const ThreadLimit one(1);
  const Grid grid = test::ball_grid(28);
  SculptOptions options;
  options.redistance = redistance;
  options.undo.full_bytes = 0;
  Sculptor sculptor(grid, options);
  std::size_t next = 1;
  std::size_t since = 0;
  double milliseconds = 0;
  for (std::size_t i = 1; i <= strokes.size(); ++i) {
    const double start = cpu_milliseconds();
    (void)sculptor.apply(strokes[i - 1], Job());
    milliseconds += cpu_milliseconds() - start;
    ++since;
    if (i < next && i < strokes.size()) continue;
    const Errors e = measure(grid);
    fmt::print("{},{},{:.4f},{:.4f},{:.4f},{:.4f}\n", name, i,
               milliseconds / static_cast<double>(since), e.error99, e.error_max, e.crease99);
    std::fflush(stdout);
    next = std::max(i + 1, i * 8 / 5);
    since = 0;
    milliseconds = 0;
  }
}

}  // namespace
}  // namespace sdfgrid::bench

int main(int count, char** words) {
  using namespace sdfgrid;
  const int strokes = count > 1 ? std::atoi(words[1]) : 1000;
  if (strokes < 1) {
    std::fputs("usage: sculpt_bench [STROKES]\n", stderr);
    return 2;
  }
  const std::vector<Stroke> all = bench::random_strokes(strokes);
  fmt::print("redistance,strokes,ms_per_stroke,error99,error_max,crease99\n");
  bench::run("off", Redistance::off, all);
  bench::run("local", Redistance::local, all);
  bench::run("full", Redistance::full, all);
  return 0;
}
