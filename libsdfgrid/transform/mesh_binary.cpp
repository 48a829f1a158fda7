#include "sdfgrid/transform/mesh_binary.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/transform/band_brick.h"
#include "sdfgrid/transform/mesh_seeds.h"
#include "sdfgrid/transform/nearest_sites.h"
#include "sdfgrid/transform/site_kernel.h"
#include "sdfgrid/voxelize/brick_sign.h"
#include "sdfgrid/voxelize/node_bins.h"

namespace sdfgrid {
namespace {

constexpr std::size_t kBricksPerTask = 32;
constexpr double kHalf = 0.5;  // voxels: the surface lies between the samples, somewhere

int reach_for(const Band& band) {
  return static_cast<int>(std::ceil(std::max(band.exwidth, band.inwidth) + kHalf));
}

// The samples with a neighbour on the other side, by their own side. All that the surface passes
// are seeds (mesh_seeds.h), so nothing beyond the seeds has to be looked at.
struct BorderBits {
  std::vector<SiteBits> inside;
  std::vector<SiteBits> outside;
};

// Which samples of a brick are seeds, and which of those are inside.
struct SeedSides {
  BrickBits known;
  BrickBits inside;
};

SeedSides sides_of(const Brick& brick) {
  SeedSides sides{};
  std::copy_n(brick.active, 8, sides.known.begin());
  for (std::size_t s = 0; s < 512; ++s) {
    if (brick.values[s] < 0) sides.inside[s >> 6] |= 1ULL << (s & 63);
  }
  return sides;
}

enum class Side : std::uint8_t { unknown, outside, inside };

// The sides of a brick's samples and of one layer around it.
class BrickSides {
 public:
  BrickSides(const MeshSeeds<SeedSides>& seeds, const glm::ivec3& coordinate) {
    std::array<const SeedSides*, 27> around{};
    for (int n = 0; n < 27; ++n) {
      const glm::ivec3 by(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
      if (std::abs(by.x) + std::abs(by.y) + std::abs(by.z) > 1) continue;
      const std::int32_t i = seeds.table.find(coordinate + by);
      if (i != BrickTable::kNone) around[static_cast<std::size_t>(n)] = seeds.bricks[i].get();
    }
    for (int x = -1; x <= 8; ++x) {
      for (int y = -1; y <= 8; ++y) {
        for (int z = -1; z <= 8; ++z) {
          const int n = ((x + 8) / 8 * 3 + (y + 8) / 8) * 3 + (z + 8) / 8;
          const SeedSides* brick = around[static_cast<std::size_t>(n)];
          if (brick != nullptr)
            at(x, y, z) = side_of(*brick, (x & 7) << 6 | (y & 7) << 3 | (z & 7));
        }
      }
    }
  }

  [[nodiscard]] Side operator()(int x, int y, int z) const { return sides_[place(x, y, z)]; }
  // Whether a neighbour of a sample is on the other side.
  [[nodiscard]] bool borders(int x, int y, int z) const {
    const Side other = (*this)(x, y, z) == Side::inside ? Side::outside : Side::inside;
    return (*this)(x - 1, y, z) == other || (*this)(x + 1, y, z) == other ||
           (*this)(x, y - 1, z) == other || (*this)(x, y + 1, z) == other ||
           (*this)(x, y, z - 1) == other || (*this)(x, y, z + 1) == other;
  }

 private:
  static std::size_t place(int x, int y, int z) {
    const int number = ((x + 1) * 10 + y + 1) * 10 + z + 1;
    return static_cast<std::size_t>(number);
  }
  Side& at(int x, int y, int z) { return sides_[place(x, y, z)]; }
  static Side side_of(const SeedSides& brick, int s) {
    const auto n = static_cast<std::size_t>(s);
    if ((brick.known[n >> 6] >> (n & 63) & 1) == 0) return Side::unknown;
    return (brick.inside[n >> 6] >> (n & 63) & 1) != 0 ? Side::inside : Side::outside;
  }

  std::array<Side, 1000> sides_{};
};

BorderBits find_borders(const MeshSeeds<SeedSides>& seeds, const Job& job) {
  BorderBits borders{std::vector<SiteBits>(seeds.bricks.size()),
                     std::vector<SiteBits>(seeds.bricks.size())};
  parallel_for(seeds.bricks.size(), kBricksPerTask, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const BrickSides sides(seeds, seeds.table.coordinates()[i]);
      for (int s = 0; s < 512; ++s) {
        const int x = s >> 6;
        const int y = s >> 3 & 7;
        const int z = s & 7;
        if (sides(x, y, z) == Side::unknown || !sides.borders(x, y, z)) continue;
        auto& bits = sides(x, y, z) == Side::inside ? borders.inside[i] : borders.outside[i];
        bits[static_cast<std::size_t>(x)] |= 1ULL << (s & 63);
      }
    }
  });
  return borders;
}

// The bricks of both.
BrickTable joined(const BrickTable& a, const BrickTable& b) {
  std::vector<glm::ivec3> all = a.coordinates();
  all.insert(all.end(), b.coordinates().begin(), b.coordinates().end());
  return BrickTable(std::move(all));
}

class MeshBinary final : public MeshTransform {
 public:
  MeshBinary(MeshSeeds<SeedSides> seeds, const BorderBits& borders, const Lattice& lattice,
             const Band& band, const Job& job)
      : lattice_(lattice),
        band_(band),
        contradicted_(seeds.contradicted),
        seed_table_(std::move(seeds.table)),
        inside_(seed_table_, borders.inside, reach_for(band), job),
        outside_(seed_table_, borders.outside, reach_for(band), job),
        table_(joined(inside_.bricks(), outside_.bricks())) {}

  [[nodiscard]] std::size_t bricks() const override { return table_.size(); }

  void run(const std::function<void(std::size_t, const Brick&)>& take,
           const Job& job) const override {
    const auto fill = [&](std::size_t i, float* values) {
      SiteKeys inside;
      SiteKeys outside;
      find_keys(inside_, table_.coordinates()[i], inside);
      find_keys(outside_, table_.coordinates()[i], outside);
      for (std::size_t s = 0; s < 512; ++s) values[s] = distance(inside[s], outside[s]);
    };
    take_band_bricks(table_.coordinates(), band_, lattice_.voxel, fill, take, job);
  }

  [[nodiscard]] bool contradicted() const override { return contradicted_; }

 private:
  static void find_keys(const NearestSites& sites, const glm::ivec3& at, SiteKeys& keys) {
    const std::int32_t i = sites.bricks().find(at);
    if (i == BrickTable::kNone || !sites.keys(static_cast<std::size_t>(i), keys)) {
      keys.fill(kNoSite);
    }
  }

  // A sample is on the side of the nearer border: on the straight way from it to the nearest sample
  // of the other side the last one before that is on its own side, and nearer. What only one side
  // reaches is on that side, and further away than the other's reach.
  static float distance(std::int32_t inside, std::int32_t outside) {
    const std::int32_t mine = std::min(inside, outside) >> 18;
    const std::int32_t other = std::max(inside, outside) >> 18;
    if (mine >= kNoSite >> 18) return std::numeric_limits<float>::quiet_NaN();
    const double d = other >= kNoSite >> 18 ? 1e6 : std::sqrt(static_cast<double>(other)) - kHalf;
    return static_cast<float>(inside < outside ? -d : d);
  }

  Lattice lattice_;
  Band band_;
  bool contradicted_;
  BrickTable seed_table_;
  NearestSites inside_;  // borders, and where they reach
  NearestSites outside_;
  BrickTable table_;
};

}  // namespace

std::unique_ptr<MeshTransform> make_mesh_binary(const SignedMesh& mesh, const Lattice& lattice,
                                                const Band& band, const Job& job) {
  if (reach_for(band) > kLargestReach) {
    throw Error(ErrorKind::usage,
                fmt::format("the meijster method does bands of up to {} voxels; use --dense for "
                            "wider ones",
                            kLargestReach - 1));
  }
  if (mesh.method == SignMethod::no_sign) {
    throw Error(ErrorKind::usage,
                "the meijster method measures between inside and outside, and without signs there "
                "is neither; use --method exact");
  }
  auto seeds = find_seeds<SeedSides>(mesh, lattice, kMarchSeedWidth, sides_of, job);
  const BorderBits borders = find_borders(seeds, job);
  return std::make_unique<MeshBinary>(std::move(seeds), borders, lattice, band, job);
}

}  // namespace sdfgrid
