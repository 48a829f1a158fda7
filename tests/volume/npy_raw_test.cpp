// .npy files as numpy writes them (headers copied by hand from numpy 1.24), and raw ones.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "volume/volumes.h"

namespace sdfgrid {
namespace {

using namespace testing;

std::string npy(const std::string& descr, bool fortran, const std::string& shape,
                const std::string& samples, char version = 1) {
  std::string text = fmt::format("{{'descr': '{}', 'fortran_order': {}, 'shape': {}, }}", descr,
                                 fortran ? "True" : "False", shape);
  const std::size_t start = version == 1 ? 10 : 12;
  text.append(63 - (start + text.size()) % 64, ' ');
  text += '\n';
  const std::string length = version == 1 ? bytes_of(static_cast<std::uint16_t>(text.size()))
                                          : bytes_of(static_cast<std::uint32_t>(text.size()));
  return std::string("\x93NUMPY") + version + '\0' + length + text + samples;
}

// The pattern with the last index fastest, as numpy has it.
template <class T>
std::string c_order(std::endian order = std::endian::little) {
  std::string bytes;
  for (int i = 0; i < kPatternDims.x; ++i) {
    for (int j = 0; j < kPatternDims.y; ++j) {
      for (int k = 0; k < kPatternDims.z; ++k) {
        bytes += bytes_of(static_cast<T>(pattern(i, j, k)), order);
      }
    }
  }
  return bytes;
}

class Npy : public ::testing::Test {
 protected:
  TempDir folder_;

  template <class T>
  void expect_read(const std::string& code, const std::string& type) {
    for (const std::endian order : {std::endian::little, std::endian::big}) {
      const std::string descr = (sizeof(T) == 1                 ? "|"
                                 : order == std::endian::little ? "<"
                                                                : ">") +
                                code;
      const std::string path =
          folder_.write("a.npy", npy(descr, false, "(5, 4, 3)", c_order<T>(order)));
      const VolumeFile file = read(path);
      EXPECT_TRUE(holds_pattern(file.volume)) << descr;
      EXPECT_EQ(type_name(file.volume.samples), type);
      const std::string turned = folder_.write(
          "f.npy", npy(descr, true, "(5, 4, 3)", sample_bytes<T>(pattern_volume<T>(), order)));
      EXPECT_TRUE(holds_pattern(read(turned).volume)) << descr << " in Fortran order";
    }
  }

  void expect_refused(const std::string& bytes, const std::string& part) {
    const std::string message = refusal(folder_.write("bad.npy", bytes));
    EXPECT_NE(message.find("bad.npy"), std::string::npos) << part;
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
};

TEST_F(Npy, EveryTypeOrderAndEndianness) {
  expect_read<std::uint8_t>("u1", "uint8");
  expect_read<std::int8_t>("i1", "int8");
  expect_read<std::uint16_t>("u2", "uint16");
  expect_read<std::int16_t>("i2", "int16");
  expect_read<std::uint32_t>("u4", "uint32");
  expect_read<std::int32_t>("i4", "int32");
  expect_read<std::uint64_t>("u8", "uint64");
  expect_read<std::int64_t>("i8", "int64");
  expect_read<float>("f4", "float32");
  expect_read<double>("f8", "float64");
}

TEST_F(Npy, BooleansVersionTwoAndTwoAxes) {
  EXPECT_TRUE(holds_pattern(
      read(folder_.write("b.npy", npy("|b1", false, "(5, 4, 3)", c_order<std::uint8_t>())))
          .volume));
  EXPECT_TRUE(holds_pattern(
      read(folder_.write("v.npy", npy("<f4", false, "(5, 4, 3)", c_order<float>(), 2))).volume));
  const VolumeFile flat = read(folder_.write("2.npy", npy("|u1", false, "(2, 3)", "abcdef")));
  EXPECT_EQ(flat.volume.dims, glm::ivec3(2, 3, 1));
  EXPECT_EQ(value_at(flat.volume, 1, 0, 0), 'd');
}

TEST_F(Npy, MalformedOnesAreRefused) {
  const std::string good = npy("<f4", false, "(5, 4, 3)", c_order<float>());
  expect_refused("", "empty");
  expect_refused("PK\x03\x04 and so on", "byte 0");
  expect_refused(good.substr(0, 40), "byte 8");
  expect_refused(good.substr(0, good.size() - 1), "announces 240 bytes");
  expect_refused(npy("<f2", false, "(5, 4, 3)", c_order<float>()), "'<f2'");
  expect_refused(npy("<c8", false, "(5, 4, 3)", c_order<float>()), "'<c8'");
  expect_refused(npy("<f2", false, "(5, 4, 3)", c_order<float>()), "type '<f2'; save it");
  std::string fields = good;
  fields.replace(fields.find("'<f4'"), 5, "[('a'");
  expect_refused(fields, "of several fields; save it");
  expect_refused(npy("<f4", false, "(60,)", c_order<float>()), "1 axes");
  expect_refused(npy("<f4", false, "(5, 0, 3)", c_order<float>()), "axis 1 has 0 samples");
  expect_refused(npy("<f4", false, "(5, -4, 3)", c_order<float>()), "shape");
  expect_refused(npy("<f4", false, "(5000000000, 4, 3)", c_order<float>()), "axis 0");
  expect_refused(npy("<f4", false, "(2000000000, 2000000000, 2000000000)", c_order<float>()),
                 "no machine");
  expect_refused(npy("<f4", false, "(100000, 100000, 100)", c_order<float>()), "announces");
  std::string version = good;
  version[6] = 9;
  expect_refused(version, "byte 6");
}

TEST_F(Npy, SamplesThatAreNotFiniteAreNamed) {
  Volume volume = pattern_volume<float>();
  std::get<std::vector<float>>(volume.samples)[volume.place({4, 1, 2})] = NAN;
  std::get<std::vector<float>>(volume.samples)[volume.place({0, 2, 2})] = INFINITY;
  expect_refused(npy("<f4", true, "(5, 4, 3)", sample_bytes<float>(volume)), "sample (4, 1, 2)");
}

TEST(Raw, ShapeTypeOrderAndSkipAreTheCallers) {
  const TempDir folder;
  const std::string path = folder.write(
      "a.raw",
      "header" + sample_bytes<std::int16_t>(pattern_volume<std::int16_t>(), std::endian::big));
  const RawLayout layout{kPatternDims, "int16", true, 6};
  const VolumeFile file = read_volume(path, layout, Job());
  EXPECT_TRUE(holds_pattern(file.volume));
  EXPECT_TRUE(file.warnings.empty());
  const RawLayout shorter{{5, 4, 2}, "int16", true, 6};
  EXPECT_EQ(read_volume(path, shorter, Job()).warnings.size(), 1U);
  const RawLayout longer{{5, 4, 4}, "int16", true, 6};
  EXPECT_THROW((void)read_volume(path, longer, Job()), Error);
  try {
    (void)read(path);
    FAIL() << "read without a layout";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
  }
}

}  // namespace
}  // namespace sdfgrid
