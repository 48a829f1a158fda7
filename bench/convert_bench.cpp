// Mesh to narrow band: speed and error of convert_mesh() beside OpenVDB's meshToVolume, all in one
// run, repetitions interleaved, medians. Sign and sparse grid are included, reading and writing are
// not.
//
//   convert_bench MESH... [--dims=512] [--repetitions=5] [--samples=50000]
//
// Errors are measured by compare() at active voxels against exact distances in double
// (grid/compare.h).
#include <fmt/format.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <chrono>
#include <sstream>
#include <string>
#include <vector>

#include "sdfgrid/core/isa.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/compare.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/grid/vdb.h"
#include "sdfgrid/mesh/read.h"

namespace sdfgrid::bench {
namespace {

struct Settings {
  std::vector<std::string> meshes;
  std::vector<int> dims = {512};
  int repetitions = 5;
  std::size_t samples = 50000;
};

Settings parse(int count, char** words) {
  Settings settings;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const auto value = word.substr(word.find('=') + 1);
    if (word.starts_with("--dims=")) {
      settings.dims.clear();
      std::stringstream list(value);
      for (std::string dim; std::getline(list, dim, ',');) settings.dims.push_back(std::stoi(dim));
    } else if (word.starts_with("--repetitions=")) {
      settings.repetitions = std::stoi(value);
    } else if (word.starts_with("--samples=")) {
      settings.samples = std::stoul(value);
    } else {
      settings.meshes.push_back(word);
    }
  }
  return settings;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

template <class Work>
double seconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// OpenVDB's own lists are made beforehand: only its conversion is timed.
class OpenVdbPeer {
 public:
  OpenVdbPeer(const TriangleSoup& soup, double voxel)
      : transform_(openvdb::math::Transform::createLinearTransform(voxel)) {
    for (const auto& p : soup.points) points_.emplace_back(p.x, p.y, p.z);
    for (const auto& t : soup.triangles) triangles_.emplace_back(t.x, t.y, t.z);
  }
  [[nodiscard]] openvdb::FloatGrid::Ptr convert() const {
    return openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*transform_, points_, triangles_,
                                                              3.0F);
  }

 private:
  openvdb::math::Transform::Ptr transform_;
  std::vector<openvdb::Vec3s> points_;
  std::vector<openvdb::Vec3I> triangles_;
};

void print_error(const char* name, const Grid& grid, const TriangleSoup& soup,
                 const Settings& settings) {
  CompareOptions options;
  options.samples = settings.samples;
  const Comparison c = compare(grid, soup, options, Job());
  fmt::print("  {:8} error, voxels: max {:.2g} rms {:.2g} p99 {:.2g}; wrong signs {} of {}\n", name,
             c.voxels.max_error / c.voxel, c.voxels.rms_error / c.voxel,
             c.voxels.p99_error / c.voxel, c.voxels.sign_errors, c.voxels.samples);
}

void measure(const std::string& path, int dim, const Settings& settings) {
  TriangleSoup soup = read_mesh(path, Job()).soup;
  ConvertOptions options;
  options.dim = dim;
  const OpenVdbPeer peer(soup, choose_lattice(soup, options).voxel);
  Grid grid;
  openvdb::FloatGrid::Ptr peer_grid;
  std::vector<double> ours[2];
  std::vector<double> theirs[2];
  std::vector<double> ratio[2];
  for (int repetition = 0; repetition < settings.repetitions; ++repetition) {
    for (const int threads : {1, 2}) {
      const ThreadLimit limit(threads);
      auto& our = ours[threads - 1];
      auto& their = theirs[threads - 1];
      our.push_back(seconds([&] { grid = convert_mesh(soup, options, Job()).grid; }));
      their.push_back(seconds([&] { peer_grid = peer.convert(); }));
      ratio[threads - 1].push_back(their.back() / our.back());
    }
  }
  fmt::print("{} ({} triangles), dim {}, half-width 3: {} bricks, {} active voxels\n", path,
             soup.triangles.size(), dim, grid.bricks(), grid.active_voxels());
  for (const int threads : {1, 2}) {
    fmt::print("  {} thread{}: sdfgrid {:.4f} s, OpenVDB {:.4f} s, ratio {:.1f}\n", threads,
               threads == 1 ? " " : "s", median(ours[threads - 1]), median(theirs[threads - 1]),
               median(ratio[threads - 1]));
  }
  fmt::print("  two threads over one: sdfgrid {:.2f}, OpenVDB {:.2f}\n",
             median(ours[0]) / median(ours[1]), median(theirs[0]) / median(theirs[1]));
  print_error("sdfgrid", grid, soup, settings);
  print_error("OpenVDB", from_vdb(peer_grid), soup, settings);
}

}  // namespace
}  // namespace sdfgrid::bench

int main(int count, char** words) {
  using namespace sdfgrid::bench;
  const Settings settings = parse(count, words);
  if (settings.meshes.empty()) {
    fmt::print(stderr, "usage: convert_bench MESH... [--dims=512] [--repetitions=5]\n");
    return 2;
  }
  fmt::print("instruction set: {}\n", sdfgrid::isa_name(sdfgrid::active_isa()));
  for (const std::string& mesh : settings.meshes) {
    for (const int dim : settings.dims) measure(mesh, dim, settings);
  }
  return 0;
}
