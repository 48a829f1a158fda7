// Conversion of whole meshes against the independent reference, and what other programs expect of
// the grid.
#include "sdfgrid/grid/convert.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/common.hpp>
#include <iterator>

#include "property/random_meshes.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/vdb.h"
#include "sdfgrid/mesh/reference.h"

namespace sdfgrid {
namespace {

using shapes::Random;

// Of bands up to 25 voxels wide.
const double kVoxelError = convert_error({});

Conversion convert(const TriangleSoup& soup, int dim, const Band& band = {},
                   SignMethod sign = SignMethod::automatic) {
  ConvertOptions options;
  options.dim = dim;
  options.band = band;
  options.sign = sign;
  return convert_mesh(soup, options, Job());
}

// Every lattice point of the bounds and five voxels around them: values in the band are exact, and
// only those are active; beyond it is plus or minus background.
void expect_exact(const TriangleSoup& soup, const Conversion& conversion, const Band& band,
                  const std::string& what) {
  const ReferenceDistance reference(soup);
  const Grid& grid = conversion.grid;
  const Lattice lattice = grid.lattice();
  const double h = lattice.voxel;
  const auto tree = vdb(grid)->getConstAccessor();
  const glm::ivec3 lo(glm::floor(lattice.to_index(bounds(soup).lo) - 5.0));
  const glm::ivec3 hi(glm::ceil(lattice.to_index(bounds(soup).hi) + 5.0));
  glm::ivec3 i;
  for (i.x = lo.x; i.x <= hi.x; ++i.x) {
    for (i.y = lo.y; i.y <= hi.y; ++i.y) {
      for (i.z = lo.z; i.z <= hi.z; ++i.z) {
        const double exact = reference.signed_distance(lattice.to_world(glm::dvec3(i))) / h;
        float value = 0;
        const bool active = tree.probeValue({i.x, i.y, i.z}, value);
        const double ours = value / h;
        const double width = exact < 0 ? band.inwidth : band.exwidth;
        const std::string where =
            fmt::format("{} at {} {} {}, exact {} voxels", what, i.x, i.y, i.z, exact);
        if (std::abs(exact) < width - kVoxelError) {
          ASSERT_TRUE(active) << where;
          // A sample on the surface has no side.
          if (std::abs(exact) < kVoxelError) {
            ASSERT_NEAR(std::abs(ours), std::abs(exact), kVoxelError) << where;
          } else {
            ASSERT_NEAR(ours, exact, kVoxelError) << where;
          }
        } else if (std::abs(exact) > width + kVoxelError) {
          ASSERT_FALSE(active) << where;
          ASSERT_NEAR(ours, exact < 0 ? -width : width, 1e-6 * width) << where;
        }
      }
    }
  }
}

std::vector<char> bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string temporary(const std::string& name) {
  return (std::filesystem::temp_directory_path() / ("sdfgrid_convert_" + name)).string();
}

TEST(Convert, RandomClosedMeshesAreExactEverywhere) {
  for (const auto& [name, soup] : shapes::random_closed_meshes(11, 24)) {
    expect_exact(soup, convert(soup, 20), {}, name);
  }
}

TEST(Convert, BandsOfUnequalWidthAreExact) {
  const TriangleSoup soup = shapes::torus_mesh(1.0, 0.4);
  for (const Band band : {Band{1, 1}, Band{5, 2}, Band{1.5, 6}}) {
    expect_exact(soup, convert(soup, 30, band), band, "torus");
  }
}

// Samples exactly on the surface and one voxel from it, at every place in a brick: the narrowest
// band must still part inside from outside.
TEST(Convert, NarrowestBandHoldsOnLatticeAlignedCubes) {
  for (int shift = 0; shift < 8; ++shift) {
    const TriangleSoup soup = shapes::box_mesh(glm::dvec3(shift), glm::dvec3(shift + 18));
    ConvertOptions options;
    options.voxel = 1;
    options.band = {1, 1};
    const Grid grid = convert_mesh(soup, options, Job()).grid;
    for (int x = -3; x < 30; ++x) {
      for (int z = -3; z < 30; ++z) {
        const auto within = [&](int c) { return c > shift && c < shift + 18; };
        const bool on = x == shift || x == shift + 18 || z == shift || z == shift + 18;
        if (on) continue;
        const float value = grid.value({x, shift + 9, z});
        ASSERT_EQ(value < 0, within(x) && within(z)) << shift << ' ' << x << ' ' << z;
      }
    }
  }
}

TEST(Convert, HugeTrianglesKeepTheirAccuracy) {
  // Twelve triangles, 900 voxels large: what a float kernel gets wrong if it measures from a
  // corner.
  const TriangleSoup soup =
      shapes::transformed(shapes::box_mesh(glm::dvec3(-1), glm::dvec3(1)), Random(3).rotation());
  const Conversion conversion = convert(soup, 900);
  const ReferenceDistance reference(soup);
  const Lattice lattice = conversion.grid.lattice();
  Random random(4);
  double worst = 0;
  std::size_t checked = 0;
  for (auto it = vdb(conversion.grid)->cbeginValueOn(); it; ++it) {
    if (random.unit() > 0.01) continue;
    const openvdb::Coord c = it.getCoord();
    const double exact = reference.signed_distance(lattice.to_world({c.x(), c.y(), c.z()}));
    worst = std::max(worst, std::abs(*it - exact) / lattice.voxel);
    ++checked;
  }
  EXPECT_GT(checked, 10000U);
  EXPECT_LT(worst, kVoxelError);
}

// Far from the surface floats are coarse: the stated error must say so, and not more than that.
TEST(Convert, WideBandsKeepTheirStatedError) {
  const TriangleSoup soup =
      shapes::transformed(shapes::box_mesh(glm::dvec3(-1), glm::dvec3(1)), Random(5).rotation());
  const Band band{100, 3};
  const Conversion conversion = convert(soup, 8, band);
  const ReferenceDistance reference(soup);
  const Lattice lattice = conversion.grid.lattice();
  Random random(6);
  double worst = 0;
  for (auto it = vdb(conversion.grid)->cbeginValueOn(); it; ++it) {
    if (random.unit() > 0.02) continue;
    const openvdb::Coord c = it.getCoord();
    const double exact = reference.signed_distance(lattice.to_world({c.x(), c.y(), c.z()}));
    worst = std::max(worst, std::abs(*it - exact) / lattice.voxel);
  }
  EXPECT_GT(worst, 1e-5);
  EXPECT_LT(worst, convert_error(band));
  EXPECT_LE(convert_error(band), 4e-5);
  EXPECT_DOUBLE_EQ(convert_error({3, 100}), convert_error(band));
}

TEST(Convert, DimIsTheLongestSideInVoxelsAndVoxelIsTheSize) {
  const TriangleSoup soup = shapes::box_mesh({0, 0, 0}, {4, 2, 1});
  EXPECT_DOUBLE_EQ(convert(soup, 40).grid.lattice().voxel, 0.1);
  ConvertOptions options;
  options.voxel = 0.25;
  EXPECT_DOUBLE_EQ(convert_mesh(soup, options, Job()).grid.lattice().voxel, 0.25);
}

TEST(Convert, UnsignedGridsHoldDistancesWithoutSignAndSaySo) {
  const TriangleSoup soup = shapes::with_hole(shapes::icosphere(2, 1.0), 0, 30);
  const Conversion conversion = convert(soup, 20, {}, SignMethod::no_sign);
  EXPECT_FALSE(conversion.grid.is_level_set());
  const ReferenceDistance reference(soup);
  const Lattice lattice = conversion.grid.lattice();
  for (auto it = vdb(conversion.grid)->cbeginValueOn(); it; ++it) {
    const openvdb::Coord c = it.getCoord();
    ASSERT_NEAR(*it, reference.distance(lattice.to_world({c.x(), c.y(), c.z()})),
                kVoxelError * lattice.voxel);
  }
}

TEST(Convert, SameFileAtAnyNumberOfThreads) {
  const auto holed = shapes::with_hole(shapes::icosphere(3, 1.0), 100, 40);
  for (const auto& soup : {shapes::icosphere(4, 1.0), holed}) {
    std::vector<char> first;
    for (const int threads : {1, 2, 8}) {
      const ThreadLimit limit(threads);
      const std::string path = temporary("threads.vdb");
      write_grid(convert(soup, 60).grid, path);
      const std::vector<char> bytes = bytes_of(path);
      std::filesystem::remove(path);
      ASSERT_GT(bytes.size(), 10000U);
      if (first.empty()) first = bytes;
      ASSERT_TRUE(bytes == first) << threads << " threads";
    }
  }
}

TEST(Convert, FilesComeBackAsTheyWere) {
  const std::string path = temporary("round.vdb");
  Conversion conversion = convert(shapes::torus_mesh(1.0, 0.4), 40);
  conversion.grid.set_metadata("sdfgrid:method", "exact");
  write_grid(conversion.grid, path);
  const Grid back = read_grid(path);
  std::filesystem::remove(path);
  EXPECT_EQ(back.name(), "surface");
  EXPECT_TRUE(back.is_level_set());
  EXPECT_EQ(back.metadata("sdfgrid:method"), "exact");
  EXPECT_EQ(back.active_voxels(), conversion.grid.active_voxels());
  EXPECT_EQ(back.background(), conversion.grid.background());
  EXPECT_TRUE(vdb(back)->tree().hasSameTopology(vdb(conversion.grid)->tree()));
  const auto ours = vdb(conversion.grid)->getConstAccessor();
  for (auto it = vdb(back)->cbeginValueAll(); it; ++it) {
    ASSERT_EQ(*it, ours.getValue(it.getCoord()));
  }
}

// Whoever reads a grid sizes bands and boxes by its background.
TEST(Convert, GridsWithoutAFiniteBackgroundAreRefused) {
  for (const float background : {INFINITY, NAN}) {
    try {
      (void)from_vdb(openvdb::FloatGrid::create(background), "wide.vdb");
      FAIL() << background;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_NE(std::string(error.what()).find("wide.vdb: background"), std::string::npos)
          << error.what();
    }
  }
}

TEST(Convert, OpenVdbToolsTakeTheGrid) {
  const TriangleSoup soup = shapes::icosphere(4, 1.0);
  const Conversion conversion = convert(soup, 64);
  const auto grid = vdb(conversion.grid);
  EXPECT_EQ(grid->getGridClass(), openvdb::GRID_LEVEL_SET);
  // Its isosurface lies on the mesh.
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, points, quads);
  ASSERT_GT(points.size(), 1000U);
  const ReferenceDistance reference(soup);
  for (const openvdb::Vec3s& p : points) {
    ASSERT_LT(reference.distance({p.x(), p.y(), p.z()}), 0.1 * conversion.grid.lattice().voxel);
  }
  // Its interior is one ball of the right volume.
  const auto inside = openvdb::tools::sdfInteriorMask(*grid);
  const double volume = static_cast<double>(inside->activeVoxelCount()) *
                        std::pow(conversion.grid.lattice().voxel, 3);
  EXPECT_NEAR(volume, 4.0 / 3.0 * 3.14159265, 0.02);
}

TEST(Convert, RefusesWhatCannotBeDone) {
  const auto kind_of = [](const TriangleSoup& soup, const ConvertOptions& options) {
    try {
      (void)convert_mesh(soup, options, Job());
    } catch (const Error& e) {
      return e.kind();
    }
    ADD_FAILURE() << "nothing was thrown";
    return ErrorKind::failed;
  };
  const TriangleSoup sphere = shapes::icosphere(2, 1.0);
  EXPECT_EQ(kind_of({}, {}), ErrorKind::input);
  ConvertOptions options;
  options.max_memory = 100'000'000;
  options.dim = 4000;
  EXPECT_EQ(kind_of(sphere, options), ErrorKind::failed);
  options = {};
  options.band = {0.5, 3};
  EXPECT_EQ(kind_of(sphere, options), ErrorKind::usage);
  options = {};
  options.voxel = 1e-12;
  options.max_memory = ~std::size_t{0};
  EXPECT_EQ(kind_of(sphere, options), ErrorKind::usage);
  options = {};
  options.sign = SignMethod::normal;
  EXPECT_EQ(kind_of(shapes::with_hole(sphere, 0, 3), options), ErrorKind::input);
}

TEST(Convert, CancellationLeavesNothingAndSaysSo) {
  const Job job;
  job.cancel();
  try {
    (void)convert_mesh(shapes::icosphere(2, 1.0), {}, job);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::cancelled);
  }
}

TEST(Convert, MemoryEstimateCoversTheGridWithoutExaggeration) {
  const auto check = [](const TriangleSoup& soup, int dim, const Band& band) {
    ConvertOptions options;
    options.dim = dim;
    options.band = band;
    const double fixed =
        estimate_memory({}, {}, options) + 450.0 * static_cast<double>(soup.triangles.size());
    const double estimate = estimate_memory(soup, choose_lattice(soup, options), options) - fixed;
    const auto bytes = static_cast<double>(convert_mesh(soup, options, Job()).grid.bytes());
    EXPECT_GT(estimate, 0.8 * bytes);
    EXPECT_LT(estimate, 2.0 * bytes);
  };
  check(shapes::icosphere(5, 1.0), 300, {});
  check(shapes::torus_mesh(1.0, 0.1, 96, 24), 400, {});
  check(shapes::icosphere(4, 1.0), 200, {10, 10});
  check(shapes::box_mesh(glm::dvec3(-1), glm::dvec3(1)), 24, {60, 3});
}

}  // namespace
}  // namespace sdfgrid
