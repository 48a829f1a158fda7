// Primary rays on a mesh: speed and error of trace_primary() beside OpenVDB's ray intersector and
// Embree on the triangles, all in one run, repetitions interleaved, medians. Errors are of
// depth, in voxels; lost and extra are pixels, inner those of them that are no silhouette's.
//
//   trace_bench MESH [DIM=512] [SIZE=1024] [REPETITIONS=7] [sdfgrid|openvdb]
//
// The last word says who makes the grid that sdfgrid and OpenVDB trace.
#include <fmt/format.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <string>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/grid/vdb.h"
#include "sdfgrid/mesh/read.h"
#include "sdfgrid/trace/trace.h"
#include "trace_peers.h"

namespace sdfgrid::bench {
namespace {

using Clock = std::chrono::steady_clock;

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

Grid openvdb_grid(const TriangleSoup& soup, int dim) {
  const glm::dvec3 size = bounds(soup).size();
  const double voxel = std::max({size.x, size.y, size.z}) / dim;
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (std::uint32_t i = 0; i < soup.points.size(); ++i) {
    const glm::dvec3 p = soup.origin + soup.local(i);
    points.emplace_back(p.x, p.y, p.z);
  }
  for (const auto& t : soup.triangles) triangles.emplace_back(t.x, t.y, t.z);
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel);
  return from_vdb(
      openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*transform, points, triangles, 3.0F));
}

class Ours : public Peer {
 public:
  Ours(const Grid& grid, const Camera& camera) : camera_(camera) {
    const auto start = Clock::now();
    atlas_ = make_atlas(grid, Job());
    fmt::print(
        "atlas: {} bricks, {:.0f} MB, {:.3f} s\n", atlas_.samples.size() / Atlas::kSamples,
        1e-6 * double(atlas_.samples.size() * 4 + atlas_.hops.size() + atlas_.bricks.size() * 8),
        std::chrono::duration<double>(Clock::now() - start).count());
  }
  [[nodiscard]] std::string name() const override { return "sdfgrid"; }
  void trace(std::vector<float>& depth) const override {
    HitBuffer hits = trace_primary(atlas_, camera_, Job());
    depth = std::move(hits.depth);
  }

 private:
  Atlas atlas_;
  Camera camera_;
};

// Processor seconds of all threads: they stay true on a machine that is busy with other work.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

struct Result {
  std::vector<double> seconds;
  std::vector<double> processor;
  std::vector<float> depth;
};

// Pixels where one of the two hits and the other does not; `inner` of them have eight neighbours
// that all agree with the reference: no silhouette is near.
struct Misses {
  std::size_t lost = 0;
  std::size_t extra = 0;
  std::size_t inner = 0;
};

Misses misses(const std::vector<float>& depth, const std::vector<float>& truth, int width) {
  Misses found;
  const int height = static_cast<int>(truth.size()) / width;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = std::size_t(y) * width + x;
      const bool hit = std::isfinite(truth[i]);
      if (std::isfinite(depth[i]) == hit) continue;
      ++(hit ? found.lost : found.extra);
      bool silhouette = false;
      for (int n = 0; n < 9; ++n) {
        const int nx = std::clamp(x + n % 3 - 1, 0, width - 1);
        const int ny = std::clamp(y + n / 3 - 1, 0, height - 1);
        silhouette |= std::isfinite(truth[std::size_t(ny) * width + nx]) != hit;
      }
      if (!silhouette) ++found.inner;
    }
  }
  return found;
}

void print_errors(const std::vector<float>& depth, const std::vector<float>& truth, int width,
                  double voxel) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (std::isfinite(depth[i]) && std::isfinite(truth[i])) {
      errors.push_back(std::abs(double(depth[i]) - truth[i]) / voxel);
    }
  }
  std::sort(errors.begin(), errors.end());
  if (errors.empty()) return;
  const Misses m = misses(depth, truth, width);
  fmt::print("  {:8.4f} {:8.4f} {:7} {:7} {:6}", errors[errors.size() / 2],
             errors[errors.size() * 99 / 100], m.lost, m.extra, m.inner);
}

void measure(const std::vector<const Peer*>& peers, int threads, int repetitions,
             const Camera& camera, double voxel) {
  const ThreadLimit limit(threads);
  std::vector<Result> results(peers.size());
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    for (std::size_t i = 0; i < peers.size(); ++i) {
      const auto start = Clock::now();
      const double used = processor_seconds();
      peers[i]->trace(results[i].depth);
      results[i].processor.push_back(processor_seconds() - used);
      results[i].seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
    }
  }
  const auto rays = static_cast<double>(results[0].depth.size()) * 1e-6;
  fmt::print(
      "\n{:<32} Mrays/s  ours is  Mrays/CPU-s  ours is |  error     p99    lost   extra  inner\n",
      fmt::format("{} thread{}", threads, threads == 1 ? "" : "s"));
  for (std::size_t i = 0; i < peers.size(); ++i) {
    const double seconds = median(results[i].seconds);
    const double processor = median(results[i].processor);
    fmt::print("{:<32} {:7.2f} {:7.2f}x {:12.2f} {:7.2f}x |", peers[i]->name(), rays / seconds,
               seconds / median(results[0].seconds), rays / processor,
               processor / median(results[0].processor));
    print_errors(results[i].depth, results.back().depth, camera.width, voxel);
    fmt::print("\n");
  }
}

Grid sdfgrid_grid(const TriangleSoup& soup, int dim) {
  ConvertOptions options;
  options.dim = dim;
  return convert_mesh(soup, options, Job()).grid;
}

void run(const std::string& path, int dim, int size, int repetitions, bool by_openvdb) {
  const TriangleSoup soup = read_mesh(path, Job()).soup;
  const Grid grid = by_openvdb ? openvdb_grid(soup, dim) : sdfgrid_grid(soup, dim);
  const Camera camera = frame(bounds(soup), size, size);
  const Ours ours(grid, camera);
  std::vector<std::unique_ptr<Peer>> others;
  others.push_back(openvdb_peer(grid, camera));
  for (const int width : {1, 8}) {
    if (auto peer = embree_peer(soup, camera, width)) others.push_back(std::move(peer));
  }
  if (others.size() == 1) fmt::print("built without Embree: depth is measured against OpenVDB\n");
  std::vector<const Peer*> peers{&ours};
  for (const auto& peer : others) peers.push_back(peer.get());
  for (const int threads : {1, 2}) {
    measure(peers, threads, repetitions, camera, grid.lattice().voxel);
  }
}

}  // namespace
}  // namespace sdfgrid::bench

int main(int argc, char** argv) {
  const auto number = [&](int i, int otherwise) {
    return argc > i ? std::max(1, std::atoi(argv[i])) : otherwise;
  };
  if (argc < 2) {
    fmt::print(stderr,
               "usage: trace_bench MESH [DIM=512] [SIZE=1024] [REPETITIONS=7] [sdfgrid|openvdb]\n");
    return 2;
  }
  try {
    sdfgrid::bench::run(argv[1], number(2, 512), (number(3, 1024) + 3) / 4 * 4, number(4, 7),
                        argc > 5 && std::string(argv[5]) == "openvdb");
  } catch (const std::exception& error) {
    fmt::print(stderr, "trace_bench: {}\n", error.what());
    return 1;
  }
  return 0;
}
