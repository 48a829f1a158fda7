// Bands of meshes: the transforms beside exact conversion of the same band.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/grid/vdb.h"
#include "sdfgrid/mesh/read.h"
#include "transform_bench.h"

namespace sdfgrid::bench {
namespace {

// Errors at the active voxels of `exact`, in voxels, ascending.
std::vector<double> errors(const Grid& got, const Grid& exact) {
  std::vector<double> all;
  const openvdb::tree::ValueAccessor<const openvdb::FloatTree> value(vdb(got)->tree());
  for (auto voxel = vdb(exact)->cbeginValueOn(); voxel; ++voxel) {
    const auto want = static_cast<double>(*voxel);
    const auto have = static_cast<double>(value.getValue(voxel.getCoord()));
    all.push_back(std::abs(want - have) / exact.lattice().voxel);
  }
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace

void run_mesh(const std::string& path, int dim, double width, int repetitions) {
  const TriangleSoup soup = read_mesh(path, Job()).soup;
  const ThreadLimit limit(1);
  struct Run {
    std::string name;
    std::optional<TransformOptions> transform;
    double seconds = 1e300;
    Grid grid{};
  };
  std::vector<Run> runs;
  runs.push_back({"exact", std::nullopt});
  for (const auto method :
       {TransformMethod::feature, TransformMethod::closest_point, TransformMethod::fmm2}) {
    runs.push_back({std::string(transform_name(method)), TransformOptions{.method = method}});
  }
  for (int r = 0; r < repetitions; ++r) {
    for (Run& run : runs) {
      ConvertOptions options;
      options.dim = dim;
      options.band = {width, width};
      options.transform = run.transform;
      run.seconds =
          std::min(run.seconds,
                   best_seconds(1, [&] { run.grid = convert_mesh(soup, options, Job()).grid; }));
    }
  }
  fmt::print("{}, dim {}, half-width {}: {} active voxels\n", path, dim, width,
             runs[0].grid.active_voxels());
  for (const Run& run : runs) {
    const std::vector<double> e = errors(run.grid, runs[0].grid);
    const auto beyond = std::lower_bound(e.begin(), e.end(), 0.01);
    fmt::print(
        "  {:<8} {:.2f} s, {:.2f} of exact; error, voxels: 99.9 % {:.4f} max {:.3f}; {} above "
        "0.01\n",
        run.name, run.seconds, run.seconds / runs[0].seconds, e[e.size() * 999 / 1000], e.back(),
        e.end() - beyond);
  }
}

}  // namespace sdfgrid::bench
