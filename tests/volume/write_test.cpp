// What is written, read by other programs' code: teem, NanoVDB, and parsers of a few lines here.
#include "sdfgrid/volume/write.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nanovdb/util/IO.h>
#include <teem/nrrd.h>

#include <cmath>
#include <fstream>
#include <regex>

#include "sdfgrid/grid/convert.h"
#include "sdfgrid/grid/dense.h"
#include "sdfgrid/grid/vdb.h"
#include "volume/volumes.h"

namespace sdfgrid {
namespace {

using namespace testing;

Volume placed_volume() {
  Volume volume = pattern_volume<float>();
  volume.spacing = {0.1, 1.0 / 3, 2};
  volume.origin = {1e6 + 0.125, -2, 3};
  volume.axes = glm::dmat3({0, 1, 0}, {-1, 0, 0}, {0, 0, 1});
  return volume;
}

std::string file_bytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class Write : public ::testing::Test {
 protected:
  TempDir folder_;
};

TEST_F(Write, EveryTypeComesBackFromNpyAndNrrd) {
  for (const std::string& type : type_names()) {
    Volume volume = pattern_volume<double>();
    const std::vector<double> values = std::get<std::vector<double>>(volume.samples);
    volume.samples = samples_of_type(type);
    std::visit([&](auto& out) { out.assign(values.begin(), values.end()); }, volume.samples);
    for (const char* name : {"a.npy", "a.nrrd"}) {
      write_volume(volume, folder_.path(name), Job());
      const VolumeFile file = read(folder_.path(name));
      EXPECT_TRUE(holds_pattern(file.volume)) << name << " " << type;
      EXPECT_EQ(type_name(file.volume.samples), type) << name;
    }
  }
}

TEST_F(Write, NpyAsNumpyExpectsIt) {
  write_volume(pattern_volume<float>(), folder_.path("a.npy"), Job());
  const std::string bytes = file_bytes(folder_.path("a.npy"));
  EXPECT_EQ(bytes.size(), 128U + 4 * 60);
  EXPECT_EQ(bytes.substr(0, 10), std::string("\x93NUMPY\x01\0\x76\0", 10));
  EXPECT_EQ(bytes.substr(10, 63),
            "{'descr': '<f4', 'fortran_order': True, 'shape': (5, 4, 3), }  ");
  EXPECT_EQ(bytes[127], '\n');
}

TEST_F(Write, TeemReadsPlaceAndOrientation) {
  const Volume volume = placed_volume();
  write_volume(volume, folder_.path("a.nrrd"), Job());
  ::Nrrd* nrrd = nrrdNew();
  ASSERT_EQ(nrrdLoad(nrrd, folder_.path("a.nrrd").c_str(), nullptr), 0);
  EXPECT_EQ(nrrd->type, nrrdTypeFloat);
  ASSERT_EQ(nrrd->dim, 3U);
  for (int a = 0; a < 3; ++a) {
    EXPECT_EQ(nrrd->axis[a].size, static_cast<std::size_t>(volume.dims[a]));
    EXPECT_EQ(nrrd->spaceOrigin[a], volume.origin[a]);
    for (int row = 0; row < 3; ++row) {
      EXPECT_NEAR(nrrd->axis[a].spaceDirection[row], volume.spacing[a] * volume.axes[a][row],
                  1e-15);
    }
  }
  EXPECT_EQ(static_cast<const float*>(nrrd->data)[volume.place({3, 2, 1})], pattern(3, 2, 1));
  nrrdNuke(nrrd);
  const Volume back = read(folder_.path("a.nrrd")).volume;
  EXPECT_TRUE(holds_pattern(back));
  EXPECT_NEAR(back.spacing.y, volume.spacing.y, 1e-15);
  EXPECT_EQ(back.axes, volume.axes);
}

// As VTK's reader takes it: attributes from the XML, samples 8 bytes behind the underscore.
TEST_F(Write, VtiHoldsWhatItSays) {
  const Volume volume = placed_volume();
  write_volume(volume, folder_.path("a.vti"), Job());
  const std::string bytes = file_bytes(folder_.path("a.vti"));
  const auto attribute = [&](const std::string& name) {
    std::smatch match;
    const std::string head = bytes.substr(0, bytes.find("<AppendedData"));
    return std::regex_search(head, match, std::regex(" " + name + "=\"([^\"]*)\"")) ? match[1].str()
                                                                                    : std::string();
  };
  EXPECT_EQ(attribute("WholeExtent"), "0 4 0 3 0 2");
  EXPECT_EQ(attribute("Extent"), "0 4 0 3 0 2");
  EXPECT_EQ(attribute("Origin"), "1000000.125 -2 3");
  EXPECT_EQ(attribute("Spacing"), fmt::format("0.1 {} 2", 1.0 / 3));
  EXPECT_EQ(attribute("Direction"), "0 -1 0 1 0 0 0 0 1");
  EXPECT_EQ(attribute("byte_order"), "LittleEndian");
  const std::size_t at = bytes.find("encoding=\"raw\">_") + 16;
  EXPECT_EQ(bytes.substr(at, 8), bytes_of(std::uint64_t{240}));
  EXPECT_EQ(bytes.substr(at + 8, 240), sample_bytes<float>(volume));
  EXPECT_EQ(bytes.substr(at + 248), "\n</AppendedData></VTKFile>\n");
}

TEST_F(Write, OtherNamesAreUsageAndNothingIsLeft) {
  try {
    write_volume(pattern_volume<float>(), folder_.path("a.tiff"), Job());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
  }
  Volume broken = pattern_volume<float>();
  broken.dims.x = 6;
  EXPECT_THROW(write_volume(broken, folder_.path("a.npy"), Job()), Error);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path("")));
}

TriangleSoup octahedron() {
  TriangleSoup soup;
  soup.points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  soup.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return soup;
}

TEST_F(Write, NanoVdbHoldsEveryValueOfTheGrid) {
  ConvertOptions options;
  options.dim = 40;
  const Grid grid = convert_mesh(octahedron(), options, Job()).grid;
  write_grid(grid, folder_.path("a.nvdb"));
  const auto handle = nanovdb::io::readGrid(folder_.path("a.nvdb"));
  const auto* nano = handle.grid<float>();
  ASSERT_NE(nano, nullptr);
  EXPECT_TRUE(nano->isLevelSet());
  EXPECT_EQ(nano->activeVoxelCount(), grid.active_voxels());
  EXPECT_NEAR(nano->voxelSize()[0], grid.lattice().voxel, 1e-15);
  const auto accessor = nano->getAccessor();
  for (int i = -30; i <= 30; ++i) {
    for (int j = -30; j <= 30; ++j) {
      for (int k = -30; k <= 30; ++k) {
        ASSERT_EQ(accessor.getValue({i, j, k}), grid.value({i, j, k})) << i << " " << j << " " << k;
      }
    }
  }
}

TEST_F(Write, DenseVolumesAndGridsTurnIntoEachOther) {
  ConvertOptions options;
  options.dim = 20;
  const Grid grid = convert_mesh(octahedron(), options, Job()).grid;
  const Volume volume = to_volume(grid);
  glm::ivec3 lo;
  glm::ivec3 hi;
  grid.active_bounds(lo, hi);
  ASSERT_EQ(volume.dims, hi - lo + 1);
  EXPECT_EQ(volume.origin, grid.lattice().to_world(glm::dvec3(lo)));
  EXPECT_EQ(volume.spacing.x, grid.lattice().voxel);
  const Grid back = to_grid(volume);
  EXPECT_EQ(back.active_voxels(), volume.size());
  EXPECT_TRUE(back.is_level_set());
  for (int i = 0; i < volume.dims.x; ++i) {
    for (int j = 0; j < volume.dims.y; ++j) {
      for (int k = 0; k < volume.dims.z; ++k) {
        const float expected = grid.value(lo + glm::ivec3(i, j, k));
        ASSERT_EQ(value_at(volume, i, j, k), expected);
        ASSERT_EQ(back.value({i, j, k}), expected);
      }
    }
  }
  Volume turned = volume;
  turned.spacing.z *= 2;
  EXPECT_THROW((void)to_grid(turned), Error);
}

TEST_F(Write, FogIsReadByItsName) {
  openvdb::initialize();
  const auto fog = openvdb::FloatGrid::create(0.0F);
  fog->setName("density");
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  fog->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 4; ++j) {
      for (int k = 0; k < 3; ++k) {
        fog->tree().setValueOn({i + 7, j, k}, static_cast<float>(pattern(i, j, k)));
      }
    }
  }
  const auto surface = openvdb::FloatGrid::create(3.0F);
  surface->setName("a surface");
  surface->setGridClass(openvdb::GRID_LEVEL_SET);
  surface->tree().setValueOn({0, 0, 0}, 1.0F);
  openvdb::io::File(folder_.path("fog.vdb")).write({surface, fog});
  const Volume volume = to_volume(read_scalar_grid(folder_.path("fog.vdb")));
  EXPECT_TRUE(holds_pattern(volume));
  EXPECT_EQ(volume.origin, glm::dvec3(3.5, 0, 0));
  EXPECT_EQ(value_at(to_volume(read_scalar_grid(folder_.path("fog.vdb")), 1), 0, 0, 0), 0);
}

}  // namespace
}  // namespace sdfgrid
