#include "sdfgrid/transform/mesh_marching.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "sdfgrid/transform/band_brick.h"
#include "sdfgrid/transform/brick_table.h"
#include "sdfgrid/transform/chamfer.h"
#include "sdfgrid/transform/chamfer_mask.h"
#include "sdfgrid/transform/marching.h"
#include "sdfgrid/transform/mesh_seeds.h"
#include "sdfgrid/voxelize/brick_sign.h"
#include "sdfgrid/voxelize/node_bins.h"

namespace sdfgrid {
namespace {

bool carries_sources(TransformMethod method) { return method == TransformMethod::closest_point; }

bool is_chamfer(TransformMethod method) {
  return method != TransformMethod::fmm && method != TransformMethod::fmm2 &&
         method != TransformMethod::closest_point;
}

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

// So deep that no step leads from one side's seeds over the other's.
double seed_width(const TransformOptions& options) {
  double width = kMarchSeedWidth;
  if (!is_chamfer(options.method)) return width;
  for (const ChamferStep& step : chamfer_steps(options)) {
    width = std::max(width, glm::length(glm::dvec3(step.offset)));
  }
  return width;
}

struct SeedBrick {
  float distance[512];          // voxels, signed; beyond the seeds no use
  std::uint32_t triangle[512];  // nearest, of the mesh
  BrickBits known;              // which samples are seeds
};

SeedBrick copy_seeds(const Brick& brick, double voxel) {
  SeedBrick seeds;
  std::copy_n(brick.active, 8, seeds.known.begin());
  const double per_voxel = 1 / voxel;
  for (std::size_t s = 0; s < 512; ++s) {
    const std::int32_t nearest = brick.nearest[s];
    seeds.triangle[s] = nearest < 0 ? 0 : brick.triangles[nearest >> 2];
    seeds.distance[s] = static_cast<float>(static_cast<double>(brick.values[s]) * per_voxel);
  }
  return seeds;
}

class MeshMarch final : public MeshTransform {
 public:
  MeshMarch(const SignedMesh& mesh, const Lattice& lattice, const Band& band,
            const TransformOptions& options, const Job& job)
      : lattice_(lattice), band_(band), march_(march_options(band, options)), table_({}) {
    {
      const auto seeds = find_seeds<SeedBrick>(
          mesh, lattice, seed_width(options),
          [&](const Brick& brick) { return copy_seeds(brick, lattice.voxel); }, job);
      contradicted_ = seeds.contradicted;
      seed(seeds, options);
    }
    job.report("transform", 0.0);
    if (carries_sources(options.method)) {
      march_.run_sources(triangle_distance(mesh), job);
    } else if (is_chamfer(options.method)) {
      march_.run_steps(expand_steps(chamfer_steps(options), glm::dvec3(1.0)), job);
    } else {
      march_.run(job);
    }
    BrickField& field = march_.field();
    std::vector<glm::ivec3> coordinates;
    for (std::uint32_t b = 1; b < field.size(); ++b) coordinates.push_back(field.coordinate(b));
    table_ = BrickTable(std::move(coordinates));
  }

  [[nodiscard]] std::size_t bricks() const override { return table_.size(); }

  void run(const std::function<void(std::size_t, const Brick&)>& take,
           const Job& job) const override {
    const auto fill = [&](std::size_t i, float* values) {
      const std::uint32_t first = march_.field().find(table_.coordinates()[i]) * 512;
      for (std::uint32_t s = 0; s < 512; ++s) values[s] = march_.value(first + s);
    };
    take_band_bricks(table_.coordinates(), band_, lattice_.voxel, fill, take, job);
  }

  [[nodiscard]] bool contradicted() const override { return contradicted_; }

 private:
  void seed(const MeshSeeds<SeedBrick>& seeds, const TransformOptions& options) {
    for (const glm::ivec3& coordinate : seeds.table.coordinates()) march_.field().make(coordinate);
    march_.reserve();
    for (std::size_t i = 0; i < seeds.bricks.size(); ++i) {
      const SeedBrick& brick = *seeds.bricks[i];
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
