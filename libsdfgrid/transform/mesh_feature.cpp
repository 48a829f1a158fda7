#include "sdfgrid/transform/mesh_feature.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/transform/mesh_seeds.h"
#include "sdfgrid/transform/nearest_sites.h"
#include "sdfgrid/transform/site_kernel.h"
#include "sdfgrid/voxelize/node_bins.h"

namespace sdfgrid {
namespace {

constexpr std::size_t kBricksPerTask = 32;

// No sample of the band is further from its nearest seed than from the surface: the cell in which
// the way to the surface ends has its corners among the seeds, one of them on this side of it, and
// half a cell's diagonal may come on top.
int reach_for(const Band& band) {
  return static_cast<int>(std::ceil(std::max(band.exwidth, band.inwidth) + 0.9));
}

std::vector<SiteBits> site_bits(const MeshSeeds& seeds) {
  std::vector<SiteBits> bits;
  bits.reserve(seeds.bricks.size());
  for (const SeedBrick& brick : seeds.bricks) bits.push_back(brick.known);
  return bits;
}

// The triangles of one brick, each once.
class TriangleSet {
 public:
  explicit TriangleSet(std::size_t triangles) : last_brick_(triangles, 0) {}

  void begin() {
    ++brick_;
    triangles_.clear();
  }
  void add(std::uint32_t triangle) {
    if (last_brick_[triangle] == brick_) return;
    last_brick_[triangle] = brick_;
    triangles_.push_back(triangle);
  }
  [[nodiscard]] const std::vector<std::uint32_t>& triangles() const { return triangles_; }

 private:
  std::vector<std::uint32_t> last_brick_;  // that had the triangle
  std::uint32_t brick_ = 0;
  std::vector<std::uint32_t> triangles_;
};

// The seeds around one brick, looked up once.
class SeedsAround {
 public:
  SeedsAround(const MeshSeeds& seeds, const glm::ivec3& coordinate)
      : seeds_(seeds), coordinate_(coordinate) {
    bricks_.fill(&unknown_);
  }

  // Sample `at` counts from the brick's first one. Null where there are no seeds.
  const SeedBrick* brick_of(const glm::ivec3& at) {
    const glm::ivec3 b(at.x >> 3, at.y >> 3, at.z >> 3);
    const SeedBrick*& brick = bricks_[static_cast<std::size_t>(
        ((b.x + kHalo) * kSide + b.y + kHalo) * kSide + b.z + kHalo)];
    if (brick == &unknown_) {
      const std::int32_t i = seeds_.table.find(coordinate_ + b);
      brick = i == BrickTable::kNone ? nullptr : &seeds_.bricks[static_cast<std::size_t>(i)];
    }
    return brick;
  }

 private:
  static constexpr int kHalo = (kLargestReach + 1 + 7) / 8;  // bricks; one sample more is asked for
  static constexpr int kSide = 2 * kHalo + 1;
  static const SeedBrick unknown_;
  const MeshSeeds& seeds_;
  glm::ivec3 coordinate_;
  std::array<const SeedBrick*, kSide * kSide * kSide> bricks_;
};
const SeedBrick SeedsAround::unknown_{};

std::size_t place(const glm::ivec3& at) {
  return static_cast<std::size_t>((at.x & 7) << 6 | (at.y & 7) << 3 | (at.z & 7));
}

// Samples of a brick's sides, about every second one.
bool on_side(const glm::ivec3& at) {
  const auto picked = [](int c) { return c == 0 || c == 2 || c == 5 || c == 7; };
  const auto end = [](int c) { return c == 0 || c == 7; };
  return picked(at.x) && picked(at.y) && picked(at.z) && (end(at.x) || end(at.y) || end(at.z));
}

class MeshFeature final : public MeshTransform {
 public:
  MeshFeature(const SignedMesh& mesh, const Lattice& lattice, const Band& band, const Job& job)
      : mesh_(mesh),
        lattice_(lattice),
        band_(band),
        reach_(reach_for(band)),
        seeds_(find_seeds(mesh, lattice, job)),
        bits_(site_bits(seeds_)),
        sites_(seeds_.table, bits_, reach_, job) {
    records_.resize(mesh.soup.triangles.size());
    parallel_for(records_.size(), 4096, job, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        glm::dvec3 corners[3];
        index_corners(mesh.soup, lattice, static_cast<std::uint32_t>(t), corners);
        records_[t] = make_record(corners);
      }
    });
  }

  [[nodiscard]] std::size_t bricks() const override { return sites_.bricks().size(); }

  void run(const std::function<void(std::size_t, const Brick&)>& take,
           const Job& job) const override {
    const std::size_t tasks = (bricks() + kTaskBricks - 1) / kTaskBricks;
    std::atomic<std::size_t> done{0};
    parallel_for(tasks, 1, job, [&](std::size_t task, std::size_t) {
      TriangleSet set(records_.size());
      const auto maker = std::make_unique<BrickMaker>(mesh_, lattice_, band_, reach_);
      const std::size_t end = std::min(bricks(), (task + 1) * kTaskBricks);
      for (std::size_t i = task * kTaskBricks; i < end; ++i) {
        if (!find_triangles(i, set)) continue;
        maker->begin(sites_.bricks().coordinates()[i] * kBrickEdge);
        for (const std::uint32_t t : set.triangles()) maker->add(records_[t], t);
        const Brick brick = maker->make();
        if (maker->is_needed()) take(i, brick);
      }
      job.report("transform", static_cast<double>(++done) / static_cast<double>(tasks));
    });
  }

  [[nodiscard]] bool contradicted() const override { return seeds_.contradicted; }

 private:
  static constexpr std::size_t kTaskBricks = 1024;  // a set of triangles costs as many stamps

  // The triangles of the nearest seeds of a brick's samples. False if no seed is in reach.
  bool find_triangles(std::size_t i, TriangleSet& set) const {
    SiteKeys keys;
    if (!sites_.keys(i, keys)) return false;
    set.begin();
    SeedsAround seeds(seeds_, sites_.bricks().coordinates()[i]);
    for (int s = 0; s < 512; ++s) {
      const std::int32_t key = keys[static_cast<std::size_t>(s)];
      if (key >= kNoSite) continue;
      const glm::ivec3 sample(s >> 6, s >> 3 & 7, s & 7);
      const glm::ivec3 site = sample + site_offset(key);
      set.add(seeds.brick_of(site)->triangle[place(site)]);
      // A sample's own triangle may be its seed's neighbour's; inside the brick another sample
      // brings that.
      if (on_side(sample)) add_around(site, seeds, set);
    }
    return true;
  }

  static void add_around(const glm::ivec3& site, SeedsAround& seeds, TriangleSet& set) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const int by : {-1, 1}) {
        glm::ivec3 at = site;
        at[axis] += by;
        const SeedBrick* brick = seeds.brick_of(at);
        const std::size_t s = place(at);
        if (brick != nullptr && (brick->known[s >> 6] >> (s & 63) & 1) != 0) {
          set.add(brick->triangle[s]);
        }
      }
    }
  }

  const SignedMesh& mesh_;
  Lattice lattice_;
  Band band_;
  int reach_;
  MeshSeeds seeds_;
  std::vector<SiteBits> bits_;
  NearestSites sites_;
  std::vector<TriangleRecord> records_;  // of all triangles
};

}  // namespace

std::unique_ptr<MeshTransform> make_mesh_feature(const SignedMesh& mesh, const Lattice& lattice,
                                                 const Band& band, const Job& job) {
  if (reach_for(band) > kLargestReach) {
    throw Error(ErrorKind::usage,
                fmt::format("the feature method does bands of up to {} voxels; use --method exact "
                            "or cpm for wider ones",
                            kLargestReach - 1));
  }
  return std::make_unique<MeshFeature>(mesh, lattice, band, job);
}

}  // namespace sdfgrid
