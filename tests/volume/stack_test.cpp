// Stacks of pictures and TIFFs of many pages, written by OpenImageIO.
#include "sdfgrid/image/stack.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "volume/volumes.h"

namespace sdfgrid {
namespace {

using namespace testing;
namespace fs = std::filesystem;

std::vector<std::uint16_t> slice(int k) {
  std::vector<std::uint16_t> pixels;
  for (int j = 0; j < kPatternDims.y; ++j) {
    for (int i = 0; i < kPatternDims.x; ++i) {
      pixels.push_back(static_cast<std::uint16_t>(pattern(i, j, k)));
    }
  }
  return pixels;
}

void write_picture(const std::string& path, int k, int channels = 1) {
  const OIIO::ImageSpec spec(kPatternDims.x, kPatternDims.y, channels, OIIO::TypeDesc::UINT16);
  const auto output = OIIO::ImageOutput::create(path);
  ASSERT_TRUE(output && output->open(path, spec));
  std::vector<std::uint16_t> pixels;
  for (const std::uint16_t p : slice(k)) pixels.insert(pixels.end(), channels, p);
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::UINT16, pixels.data()) && output->close());
}

std::string refused(const std::string& path) {
  try {
    (void)read_image_stack(path, Job());
  } catch (const Error& error) {
    return error.kind() == ErrorKind::input ? error.what() : "";
  }
  return "";
}

class Stack : public ::testing::Test {
 protected:
  TempDir folder_;
  std::string slices_ = folder_.path("slices");
  void SetUp() override { fs::create_directory(slices_); }
};

// Names out of the order of letters: 9 before 10.
TEST_F(Stack, AFolderInTheOrderOfItsNumbers) {
  for (int k = 0; k < 3; ++k) write_picture(fmt::format("{}/ct-{}.png", slices_, 8 + k), k);
  const VolumeFile file = read_image_stack(slices_, Job());
  EXPECT_TRUE(holds_pattern(file.volume));
  EXPECT_EQ(type_name(file.volume.samples), "uint16");
}

TEST_F(Stack, PagesOfATiff) {
  const std::string path = folder_.path("stack.tif");
  const std::vector<OIIO::ImageSpec> specs(
      3, OIIO::ImageSpec(kPatternDims.x, kPatternDims.y, 1, OIIO::TypeDesc::UINT16));
  const auto output = OIIO::ImageOutput::create(path);
  ASSERT_TRUE(output && output->open(path, 3, specs.data()));
  for (int k = 0; k < 3; ++k) {
    ASSERT_TRUE(k == 0 || output->open(path, specs[k], OIIO::ImageOutput::AppendSubimage));
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::UINT16, slice(k).data()));
  }
  ASSERT_TRUE(output->close());
  EXPECT_TRUE(holds_pattern(read_image_stack(path, Job()).volume));
  std::string bytes;
  {
    std::ifstream in(path, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  EXPECT_NE(refused(folder_.write("cut.tif", bytes.substr(0, 60))), "");
}

TEST_F(Stack, OtherSizesColoursAndFilesAreRefused) {
  EXPECT_NE(refused(slices_).find("no files"), std::string::npos);
  EXPECT_NE(refused(folder_.path("gone")).find("no such"), std::string::npos);
  write_picture(slices_ + "/1.png", 0);
  std::ofstream(slices_ + "/2.png") << "no picture";
  EXPECT_NE(refused(slices_).find("2.png"), std::string::npos) << refused(slices_);
  fs::remove(slices_ + "/2.png");
  write_picture(slices_ + "/2.png", 1, 3);
  EXPECT_NE(refused(slices_).find("grey"), std::string::npos) << refused(slices_);
  const OIIO::ImageSpec small(2, 2, 1, OIIO::TypeDesc::UINT16);
  const auto output = OIIO::ImageOutput::create(slices_ + "/2.png");
  ASSERT_TRUE(output && output->open(slices_ + "/2.png", small));
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::UINT16, slice(0).data()) && output->close());
  EXPECT_NE(refused(slices_).find("2 x 2"), std::string::npos) << refused(slices_);
}

}  // namespace
}  // namespace sdfgrid
