#include "sdfgrid/transform/mesh_marching.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/transform/brick_table.h"
#include "sdfgrid/transform/chamfer.h"
#include "sdfgrid/transform/chamfer_mask.h"
#include "sdfgrid/transform/marching.h"
#include "sdfgrid/transform/mesh_seeds.h"
#include "sdfgrid/voxelize/brick_sign.h"
#include "sdfgrid/voxelize/node_bins.h"

namespace sdfgrid {
namespace {

constexpr std::size_t kBricksPerTask = 64;
// Voxels: the neighbour in the next brick may be on the other side, and tiles take their sign from
// there.
constexpr float kBesideSurface = 1.001F;

bool carries_sources(TransformMethod method) { return method == TransformMethod::closest_point; }

MarchOptions march_options(const Band& band, const TransformOptions& options) {
  MarchOptions march;
  march.order = options.method == TransformMethod::fmm2 ? 2 : 1;
  march.bucket_width = options.bucket_width;
  march.out_limit = band.exwidth;
  march.in_limit = band.inwidth;
  march.sources = carries_sources(options.method);
  march.grow = true;
  return march;
}

// Neighbours in the brick follow each other's side wherever neither is known: bits for spread().
BrickLinks all_links() {
  BrickLinks links{};
  for (int x = 0; x < 8; ++x) {
    links.link_x[x] = x == 7 ? 0 : ~0ULL;
    links.link_y[x] = 0x00ffffffffffffffULL;
    links.link_z[x] = 0x7f7f7f7f7f7f7f7fULL;
  }
  return links;
}

class MeshMarch final : public MeshTransform {
 public:
  MeshMarch(const SignedMesh& mesh, const Lattice& lattice, const Band& band,
            const TransformOptions& options, const Job& job)
      : lattice_(lattice), band_(band), march_(march_options(band, options)), table_({}) {
    {
      const MeshSeeds seeds = find_seeds(mesh, lattice, job);
      contradicted_ = seeds.contradicted;
      seed(seeds, options);
    }
    job.report("transform", 0.0);
    if (carries_sources(options.method)) {
      march_.run_sources(triangle_distance(mesh), job);
    } else if (options.method == TransformMethod::fmm || options.method == TransformMethod::fmm2) {
      march_.run(job);
    } else {
      march_.run_steps(expand_steps(chamfer_steps(options), glm::dvec3(1.0)), job);
    }
    BrickField& field = march_.field();
    std::vector<glm::ivec3> coordinates;
    for (std::uint32_t b = 1; b < field.size(); ++b) coordinates.push_back(field.coordinate(b));
    table_ = BrickTable(std::move(coordinates));
  }

  [[nodiscard]] std::size_t bricks() const override { return table_.size(); }

  void run(const std::function<void(std::size_t, const Brick&)>& take,
           const Job& job) const override {
    parallel_for(bricks(), kBricksPerTask, job, [&](std::size_t begin, std::size_t end) {
      alignas(64) float values[512];
      std::uint64_t active[8];
      for (std::size_t i = begin; i < end; ++i) {
        if (!fill_brick(i, values, active)) continue;
        take(i, {table_.coordinates()[i] * kBrickEdge, values, active});
      }
    });
  }

  [[nodiscard]] bool contradicted() const override { return contradicted_; }

 private:
  void seed(const MeshSeeds& seeds, const TransformOptions& options) {
    for (const glm::ivec3& coordinate : seeds.table.coordinates()) march_.field().make(coordinate);
    march_.reserve();
    for (std::size_t i = 0; i < seeds.bricks.size(); ++i) {
      const SeedBrick& brick = seeds.bricks[i];
      const auto first = static_cast<std::uint32_t>((i + 1) * 512);  // brick 0 is nowhere
      for (std::uint32_t s = 0; s < 512; ++s) {
        if ((brick.known[s >> 6] >> (s & 63) & 1) == 0) continue;
        march_.seed(first + s, brick.distance[s],
                    carries_sources(options.method) ? brick.triangle[s] : 0);
      }
    }
  }

  SourceDistance triangle_distance(const SignedMesh& mesh) {
    records_.reserve(mesh.soup.triangles.size());
    for (std::uint32_t t = 0; t < mesh.soup.triangles.size(); ++t) {
      glm::dvec3 corners[3];
      index_corners(mesh.soup, lattice_, t, corners);
      records_.push_back(make_record(corners));
    }
    const BrickKernel& kernel = brick_kernel();
    return [this, &kernel](const glm::ivec3& at, std::uint32_t triangle) {
      const double p[3] = {static_cast<double>(at.x), static_cast<double>(at.y),
                           static_cast<double>(at.z)};
      return static_cast<float>(std::sqrt(kernel.squared_distance(records_[triangle], p)));
    };
  }

  // False if no sample is in the band and none can be beside the surface.
  bool fill_brick(std::size_t i, float values[512], std::uint64_t active[8]) const {
    const std::uint32_t first = march_.field().find(table_.coordinates()[i]) * 512;
    BrickBits known{};
    BrickBits negative{};
    for (std::uint32_t s = 0; s < 512; ++s) {
      const float v = march_.value(first + s);
      values[s] = v;
      const std::uint64_t bit = 1ULL << (s & 63);
      if (std::isnan(v)) continue;
      known[s >> 6] |= bit;
      if (std::signbit(v)) negative[s >> 6] |= bit;
    }
    if (std::all_of(known.begin(), known.end(), [](std::uint64_t word) { return word == 0; })) {
      return false;
    }
    spread_side(known, negative);
    std::fill_n(active, 8, 0);
    bool needed = false;
    for (std::uint32_t s = 0; s < 512; ++s) {
      const std::uint64_t bit = 1ULL << (s & 63);
      const bool inside = (negative[s >> 6] & bit) != 0;
      const double width = inside ? band_.inwidth : band_.exwidth;
      const bool in_band =
          (known[s >> 6] & bit) != 0 && std::abs(static_cast<double>(values[s])) < width;
      if (in_band) active[s >> 6] |= bit;
      needed = needed || in_band || std::abs(values[s]) < kBesideSurface;
      const double v = in_band ? static_cast<double>(values[s]) : inside ? -width : width;
      values[s] = static_cast<float>(v * lattice_.voxel);
    }
    return needed;
  }

  // What no front reached is on the side of what is beside it.
  static void spread_side(const BrickBits& known, BrickBits& negative) {
    static const BrickLinks links = all_links();
    BrickBits allowed;
    for (std::size_t x = 0; x < 8; ++x) allowed[x] = ~known[x] | negative[x];
    spread(links, allowed, negative);
  }

  Lattice lattice_;
  Band band_;
  March<BrickField> march_;
  BrickTable table_;
  bool contradicted_ = false;
  std::vector<TriangleRecord> records_;  // of all triangles, for closest_point
};

}  // namespace

std::unique_ptr<MeshTransform> make_mesh_march(const SignedMesh& mesh, const Lattice& lattice,
                                               const Band& band, const TransformOptions& options,
                                               const Job& job) {
  return std::make_unique<MeshMarch>(mesh, lattice, band, options, job);
}

}  // namespace sdfgrid
