#include "sdfgrid/transform/mesh_feature.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <utility>
#include <vector>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/transform/cell_sites.h"
#include "sdfgrid/transform/nearest_sites.h"
#include "sdfgrid/transform/site_kernel.h"
#include "sdfgrid/voxelize/node_bins.h"

namespace sdfgrid {
namespace {

static_assert(kLargestReach + 1 <= CellsAround::kLargestReach);

// Cells between the centres of a sample's cell and of the nearest cell with a seed: half a cell's
// diagonal (0.87 samples) from the sample to its centre, as much from the surface to the nearest
// seed, and from that to its cell's centre.
double cells_apart(const Band& band) {
  return (std::max(band.exwidth, band.inwidth) + 1.5 * std::sqrt(3.0)) / kCell;
}
int reach_for(const Band& band) { return static_cast<int>(std::ceil(cells_apart(band))); }

class MeshFeature final : public MeshTransform {
 public:
  MeshFeature(const SignedMesh& mesh, const Lattice& lattice, const Band& band, const Job& job)
      : mesh_(mesh),
        lattice_(lattice),
        band_(band),
        sites_(mesh, lattice, job),
        nearest_(sites_.blocks, sites_.bits, reach_for(band), job),
        records_(mesh.soup.triangles.size()) {
    const double apart = cells_apart(band);
    limit_ = (static_cast<std::int32_t>(apart * apart) + 1) << 18;
    keys_.resize(nearest_.bricks().size());
    parallel_for(keys_.size(), 64, job, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) nearest_.keys(i, keys_[i]);
    });
    parallel_for(records_.size(), 4096, job, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        glm::dvec3 corners[3];
        index_corners(mesh.soup, lattice, static_cast<std::uint32_t>(t), corners);
        records_[t] = make_record(corners);
      }
    });
  }

  [[nodiscard]] std::size_t bricks() const override { return 8 * nearest_.bricks().size(); }

  void run(const std::function<void(std::size_t, const Brick&)>& take,
           const Job& job) const override {
    const std::size_t blocks = nearest_.bricks().size();
    const std::size_t tasks = (blocks + kTaskBlocks - 1) / kTaskBlocks;
    parallel_for("transform", tasks, 1, job, [&](std::size_t task, std::size_t) {
      Worker worker(*this);
      const std::size_t end = std::min(blocks, (task + 1) * kTaskBlocks);
      for (std::size_t block = task * kTaskBlocks; block < end; ++block) worker.run(block, take);
    });
  }

  [[nodiscard]] bool contradicted() const override { return sites_.seeds.contradicted; }

 private:
  static constexpr std::size_t kTaskBlocks = 128;  // a set of triangles costs as many stamps

  // Voxels; at least to the neighbour across the surface, with slack.
  [[nodiscard]] double reach() const { return std::max({band_.exwidth, band_.inwidth, 1.01}); }

  // What one thread needs.
  class Worker {
   public:
    explicit Worker(const MeshFeature& feature)
        : feature_(feature),
          set_(feature.records_.size()),
          cells_(feature.sites_, reach_for(feature.band_) + kApron),
          maker_(std::make_unique<BrickMaker>(feature.mesh_, feature.lattice_, feature.band_,
                                              feature.reach(), Culling::smooth)) {}

    void run(std::size_t block, const std::function<void(std::size_t, const Brick&)>& take) {
      const glm::ivec3 coordinate = feature_.nearest_.bricks().coordinates()[block];
      find_places(coordinate);
      cells_.begin_block(coordinate);
      for (int octant = 0; octant < 8; ++octant) {
        const glm::ivec3 at(octant >> 2, octant >> 1 & 1, octant & 1);
        if (!find_triangles(at * kBrickCells)) continue;
        if (!add_triangles((coordinate * 2 + at) * kBrickEdge)) continue;
        const Brick brick = maker_->make();
        if (maker_->is_needed()) take(8 * block + static_cast<std::size_t>(octant), brick);
      }
    }

   private:
    static constexpr int kApron = 1;  // cells around the block that are asked too
    static constexpr int kAsked = kBlockCells + 2 * kApron;

    static std::size_t asked(const glm::ivec3& cell) {
      const glm::ivec3 at = cell + kApron;
      return static_cast<std::size_t>((at.x * kAsked + at.y) * kAsked + at.z);
    }

    // Where the nearest cell with a seed is, for all cells of the block and around it.
    void find_places(const glm::ivec3& block) {
      const SiteKeys* around[27];
      for (int i = 0; i < 27; ++i) {
        const glm::ivec3 at(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1);
        const std::int32_t found = feature_.nearest_.bricks().find(block + at);
        around[i] =
            found == BrickTable::kNone ? nullptr : &feature_.keys_[static_cast<std::size_t>(found)];
      }
      for (int x = -kApron; x < kBlockCells + kApron; ++x) {
        for (int y = -kApron; y < kBlockCells + kApron; ++y) {
          for (int z = -kApron; z < kBlockCells + kApron; ++z) {
            const glm::ivec3 cell(x, y, z);
            const glm::ivec3 b = (cell >> 3) + 1;  // kBlockCells is eight
            const SiteKeys* keys = around[(b.x * 3 + b.y) * 3 + b.z];
            const auto n = static_cast<std::size_t>(((x & 7) * 8 + (y & 7)) * 8 + (z & 7));
            const std::int32_t key = keys == nullptr ? kNoSite : (*keys)[n];
            places_[asked(cell)] =
                key >= feature_.limit_ ? kNowhere : cells_.place(cell + site_offset(key));
          }
        }
      }
    }

    // The triangles for the brick whose first cell is `first` in the block. False if all of its
    // samples are beyond the band. The cells around it are asked too, for which of two surfaces is
    // nearer is known to about a cell only.
    bool find_triangles(const glm::ivec3& first) {
      bool any = false;
      for (int x = 0; x < kBrickCells; ++x) {
        for (int y = 0; y < kBrickCells; ++y) {
          const std::int32_t* row = &places_[asked(first + glm::ivec3(x, y, 0))];
          for (int z = 0; z < kBrickCells; ++z) any = any || row[z] != kNowhere;
        }
      }
      if (!any) return false;
      const auto within = [](int c) { return c >= 0 && c < kBrickCells; };
      for (int x = -kApron; x < kBrickCells + kApron; ++x) {
        for (int y = -kApron; y < kBrickCells + kApron; ++y) {
          const std::int32_t* row = &places_[asked(first + glm::ivec3(x, y, 0))];
          for (int z = -kApron; z < kBrickCells + kApron; ++z) {
            if (row[z] != kNowhere) cells_.mark(row[z], within(x) && within(y) && within(z));
          }
        }
      }
      set_.begin();
      cells_.collect(set_);
      return true;
    }

    // Those of the set whose planes are within reach of the brick's samples. False if none is.
    bool add_triangles(const glm::ivec3& origin) {
      constexpr double kHalf = 0.5 * (kBrickEdge - 1);
      const glm::dvec3 center = glm::dvec3(origin) + kHalf;
      maker_->begin(origin);
      bool any = false;
      for (const std::uint32_t t : set_.triangles()) {
        const TriangleRecord& r = feature_.records_[t];
        const glm::dvec3 normal(r.gx[0], r.gy[0], r.gz[0]);
        const glm::dvec3 size = glm::abs(normal);
        const double support = kHalf * (size.x + size.y + size.z);
        if (std::abs(glm::dot(normal, center) + r.k[0]) > feature_.reach() + support + 1e-3)
          continue;
        maker_->add(r, t);
        any = true;
      }
      return any;
    }

    static constexpr std::int32_t kNowhere = -1;
    const MeshFeature& feature_;
    TriangleSet set_;
    CellsAround cells_;
    std::unique_ptr<BrickMaker> maker_;
    std::array<std::int32_t, kAsked * kAsked * kAsked> places_;
  };

  const SignedMesh& mesh_;
  Lattice lattice_;
  Band band_;
  CellSites sites_;
  NearestSites nearest_;
  std::vector<SiteKeys> keys_;           // as in nearest_
  std::int32_t limit_ = 0;               // the first key beyond the band
  std::vector<TriangleRecord> records_;  // of all triangles
};

}  // namespace

std::unique_ptr<MeshTransform> make_mesh_feature(const SignedMesh& mesh, const Lattice& lattice,
                                                 const Band& band, const Job& job) {
  if (reach_for(band) > kLargestReach) {
    throw Error(ErrorKind::usage,
                fmt::format("the feature method does bands of up to {} voxels; use --method exact "
                            "or cpm for wider ones",
                            static_cast<int>(kCell * kLargestReach - 1.5 * std::sqrt(3.0))));
  }
  return std::make_unique<MeshFeature>(mesh, lattice, band, job);
}

}  // namespace sdfgrid
