// Scenes: 64 blended primitives to a sparse grid, against evaluating every voxel of their box.
// usage: scene_bench [dim] [repetitions]; one thread, CPU time, medians.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <numeric>
#include <random>
#include <vector>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/grid/convert_field.h"
#include "sdfgrid/trace/field_trace.h"

using namespace sdfgrid;

namespace {

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

// Balls, boxes, tori and capsules strewn in a cube, all blended with their neighbours.
Field blended(int count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Field> parts;
  for (int i = 0; i < count; ++i) {
    const double r = 0.05 + 0.07 * unit(random);
    Field part;
    switch (i % 4) {
      case 0:
        part = make_field("sphere", {{"radius", r}});
        break;
      case 1:
        part = make_field("box", {{"size", {1.6 * r, 1.2 * r, 2 * r}}});
        break;
      case 2:
        part = make_field("torus", {{"major", r}, {"minor", 0.3 * r}});
        break;
      default:
        part =
            make_field("capsule", {{"from", {0, 0, -r}}, {"to", {0, 0, r}}, {"radius", 0.4 * r}});
    }
    const auto angle = [&] { return 360 * unit(random); };
    part = make_field("rotate", {{"by", {angle(), angle(), angle()}}}, {part});
    const auto place = [&] { return 2 * unit(random) - 1; };
    parts.push_back(make_field("translate", {{"by", {place(), place(), place()}}}, {part}));
  }
  return make_field("smooth_union", {{"k", 0.05}}, parts);
}

// Every voxel of the box in batches; the sum keeps the work from being dropped.
double evaluate_all(const Field& field, const Lattice& lattice, std::size_t& voxels) {
  const Box box = field.bounds();
  const glm::ivec3 lo(lattice.to_index(box.lo));
  const glm::ivec3 hi(lattice.to_index(box.hi));
  const int n = hi.z - lo.z + 1;
  std::vector<float> x(n), y(n), z(n), v(n);
  for (int k = 0; k < n; ++k) {
    z[k] = static_cast<float>(lattice.to_world({0, 0, lo.z + k}).z);
  }
  double sum = 0;
  for (int i = lo.x; i <= hi.x; ++i) {
    std::fill(x.begin(), x.end(), static_cast<float>(lattice.to_world({i, 0, 0}).x));
    for (int j = lo.y; j <= hi.y; ++j) {
      std::fill(y.begin(), y.end(), static_cast<float>(lattice.to_world({0, j, 0}).y));
      field.evaluate(static_cast<std::size_t>(n), x.data(), y.data(), z.data(), v.data());
      sum += v[n / 2];
    }
  }
  voxels = static_cast<std::size_t>(hi.x - lo.x + 1) * (hi.y - lo.y + 1) * n;
  return sum;
}

// Primary rays with the parts of tracing switched on one after the other.
void trace(const Field& field, int repetitions) {
  const Camera camera = frame(field.bounds(), 512, 512);
  const char* const names[] = {"plain sphere tracing", "relaxed", "pruned", "relaxed and pruned",
                               "objects apart"};
  const FieldTraceOptions plain = kPlainSphereTracing;
  FieldTraceOptions relaxed = plain;
  relaxed.relax = true;
  FieldTraceOptions pruned = plain;
  pruned.prune = pruned.beams = true;
  FieldTraceOptions both = pruned;
  both.relax = true;
  const FieldTraceOptions options[] = {plain, relaxed, pruned, both, {}};
  for (int k = 0; k < 5; ++k) {
    const FieldTracer tracer(field, field.bounds(), options[k]);
    std::vector<double> seconds;
    double steps = 0;
    std::size_t hits = 0;
    for (int i = 0; i < repetitions; ++i) {
      const double start = cpu_seconds();
      const HitBuffer made = tracer.trace_primary(camera, Job());
      seconds.push_back(cpu_seconds() - start);
      steps = std::accumulate(made.steps.begin(), made.steps.end(), 0.0);
      hits = static_cast<std::size_t>(std::count_if(made.depth.begin(), made.depth.end(),
                                                    [](float d) { return std::isfinite(d); }));
    }
    const auto rays = static_cast<double>(camera.width) * camera.height;
    fmt::print("{:>20}: {:6.2f} evaluations a ray, {:.3f} s, {:.2f} Mrays/s, {} hits\n", names[k],
               steps / rays, median(seconds), 1e-6 * rays / median(seconds), hits);
  }
}

}  // namespace

int main(int argc, char** argv) {
  FieldConvertOptions options;
  options.dim = argc > 1 ? std::atoi(argv[1]) : 512;
  const int repetitions = argc > 2 ? std::atoi(argv[2]) : 3;
  const ThreadLimit one(1);
  const Field field = blended(64);
  std::size_t voxels = 0;
  std::vector<double> all;
  std::vector<double> sparse;
  FieldConversion made;
  double sum = 0;
  for (int i = 0; i < repetitions; ++i) {
    const double a = cpu_seconds();
    made = convert_field(field, options, Job());
    const double b = cpu_seconds();
    sum += evaluate_all(field, made.grid.lattice(), voxels);
    sparse.push_back(b - a);
    all.push_back(cpu_seconds() - b);
  }
  fmt::print("program of {} instructions, dim {}, {} voxels in the box (checksum {:.3f})\n",
             field.size(), options.dim, voxels, sum);
  fmt::print("every voxel, in batches: {:.3f} s\n", median(all));
  fmt::print(
      "convert_field: {:.3f} s, {:.1f} times as fast; {} points ({:.2f} % of the voxels) and "
      "{} intervals; {} active voxels in {} bricks\n",
      median(sparse), median(all) / median(sparse), made.evaluated,
      100.0 * static_cast<double>(made.evaluated) / static_cast<double>(voxels), made.regions,
      made.grid.active_voxels(), made.grid.bricks());
  trace(field, repetitions);
  return 0;
}
