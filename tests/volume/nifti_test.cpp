// NIfTI files made by hand after nifti1.h, both byte orders, and by libnifti's writer.
#include <gtest/gtest.h>
#include <nifti/nifti2_io.h>

#include "volume/volumes.h"

namespace sdfgrid {
namespace {

using namespace testing;

// A NIfTI-1 header, 348 bytes and the four that say that no extension follows.
struct Header {
  std::endian order = std::endian::little;
  std::vector<int> dims = {3, 5, 4, 3, 1, 1, 1, 1};
  std::int16_t datatype = 4;  // int16
  std::int16_t bits = 16;
  float slope = 0;
  float inter = 0;
  float offset = 352;
  std::int16_t sform = 0;
  std::string magic = std::string("n+1") + '\0';
  std::vector<float> pixdim = {1, 0.5F, 1, 2, 0, 0, 0, 0};
  std::vector<float> srow = std::vector<float>(12, 0);

  [[nodiscard]] std::string bytes() const {
    std::string out(352, '\0');
    const auto put = [&](std::size_t at, auto value) {
      out.replace(at, sizeof(value), bytes_of(value, order));
    };
    put(0, std::int32_t{348});
    for (std::size_t a = 0; a < 8; ++a) put(40 + 2 * a, static_cast<std::int16_t>(dims[a]));
    put(70, datatype);
    put(72, bits);
    for (std::size_t a = 0; a < 8; ++a) put(76 + 4 * a, pixdim[a]);
    put(108, offset);
    put(112, slope);
    put(116, inter);
    put(254, sform);
    for (std::size_t n = 0; n < 12; ++n) put(280 + 4 * n, srow[n]);
    out.replace(344, 4, magic);
    return out;
  }
};

std::string samples(std::endian order = std::endian::little) {
  return sample_bytes<std::int16_t>(pattern_volume<std::int16_t>(), order);
}

class Nifti : public ::testing::Test {
 protected:
  TempDir folder_;

  void expect_refused(const std::string& bytes, const std::string& part,
                      const std::string& name = "bad.nii") {
    const std::string message = refusal(folder_.write(name, bytes));
    EXPECT_NE(message.find(name), std::string::npos) << part;
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
};

TEST_F(Nifti, BothByteOrdersAndGzip) {
  Header header;
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    header.order = order;
    const std::string bytes = header.bytes() + samples(order);
    const VolumeFile plain = read(folder_.write("a.nii", bytes));
    EXPECT_TRUE(holds_pattern(plain.volume));
    EXPECT_EQ(plain.format, "NIfTI-1");
    EXPECT_EQ(type_name(plain.volume.samples), "int16");
    EXPECT_EQ(plain.volume.spacing, glm::dvec3(0.5, 1, 2));
    EXPECT_EQ(plain.warnings.size(), 1U) << "no orientation";
    EXPECT_TRUE(holds_pattern(read(folder_.write("a.nii.gz", gzip(bytes))).volume));
  }
}

TEST_F(Nifti, ScalingMakesFloats) {
  Header header;
  header.slope = 0.5F;
  header.inter = -1024;
  const VolumeFile file = read(folder_.write("a.nii", header.bytes() + samples()));
  EXPECT_EQ(type_name(file.volume.samples), "float32");
  EXPECT_TRUE(holds_pattern(file.volume, 0.5, -1024));
}

TEST_F(Nifti, PlaceAndOrientationAreKept) {
  Header header;
  header.sform = 1;
  header.srow = {-2, 0, 0, 90, 0, 0.5F, 0, -126, 0, 0, 3, -72};
  const Volume volume = read(folder_.write("a.nii", header.bytes() + samples())).volume;
  EXPECT_EQ(volume.spacing, glm::dvec3(2, 0.5, 3));
  EXPECT_EQ(volume.to_world({1, 2, 1}), glm::dvec3(88, -125, -69));
  header.srow = {1, 0, 0, 0, 2, 0, 0, 0, 0, 0, 1, 0};
  expect_refused(header.bytes() + samples(), "span no volume");
}

// An image of floats with the pattern, in libnifti's own form.
nifti_image* pattern_image() {
  const std::int64_t dims[] = {3, 5, 4, 3, 1, 1, 1, 1};
  nifti_image* image = nifti_make_new_nim(dims, DT_FLOAT32, 1);
  for (std::int64_t n = 0; n < image->nvox; ++n) {
    const int i = static_cast<int>(n % 5);
    const int j = static_cast<int>(n / 5 % 4);
    static_cast<float*>(image->data)[n] =
        static_cast<float>(pattern(i, j, static_cast<int>(n / 20)));
  }
  return image;
}

TEST_F(Nifti, WhatLibniftiWrites) {
  const std::string path = folder_.path("lib.nii");
  nifti_image* image = pattern_image();
  nifti_set_filenames(image, path.c_str(), 0, 1);
  nifti_image_write(image);
  const VolumeFile file = read(path);
  EXPECT_TRUE(holds_pattern(file.volume));
  EXPECT_EQ(file.format, "NIfTI-1");

  image->nifti_type = NIFTI_FTYPE_NIFTI2_1;
  image->iname_offset = 544;
  nifti_2_header header;
  ASSERT_EQ(nifti_convert_nim2n2hdr(image, &header), 0);
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof(header));
  bytes.resize(544, '\0');
  bytes.append(static_cast<const char*>(image->data), 240);
  nifti_image_free(image);
  const VolumeFile second = read(folder_.write("second.nii", bytes));
  EXPECT_TRUE(holds_pattern(second.volume));
  EXPECT_EQ(second.format, "NIfTI-2");
}

TEST_F(Nifti, MalformedOnesAreRefused) {
  const Header good;
  expect_refused("", "empty");
  expect_refused("NRRD0004", "byte 0");
  expect_refused(good.bytes().substr(0, 200), "byte 0");
  expect_refused(good.bytes() + samples().substr(1), "announces 120 bytes");
  expect_refused(gzip(good.bytes() + samples().substr(1)), "samples", "short.nii.gz");
  const std::string packed = gzip(good.bytes() + samples());
  expect_refused(packed.substr(0, packed.size() - 20), "samples", "cut.nii.gz");
  Header header = good;
  header.magic = std::string("ni1") + '\0';
  expect_refused(header.bytes() + samples(), ".hdr and .img");
  header = good;
  header.datatype = 128;  // RGB
  header.bits = 24;
  expect_refused(header.bytes() + samples() + samples(), "type 128");
  header = good;
  header.dims = {4, 5, 4, 3, 2, 1, 1, 1};
  expect_refused(header.bytes() + samples() + samples(), "2 volumes");
  header = good;
  header.dims = {3, 32000, 32000, 32000, 1, 1, 1, 1};
  expect_refused(header.bytes() + samples(), "announces");
  header = good;
  header.dims = {3, 5, -4, 3, 1, 1, 1, 1};
  expect_refused(header.bytes() + samples(), "axis 1 has 0 samples");
}

}  // namespace
}  // namespace sdfgrid
