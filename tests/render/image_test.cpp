// image/: what is written is what is read, and what cannot be written is refused.
#include "sdfgrid/image/image.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "sdfgrid/core/error.h"

namespace sdfgrid {
namespace {

class ImageTest : public testing::Test {
 protected:
  void SetUp() override {
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = std::filesystem::temp_directory_path() /
              ("sdfgrid_image_" + std::to_string(::getpid()) + "_" + name);
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_), {}));
  }

 private:
  std::filesystem::path folder_;
};

ErrorKind kind_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& e) {
    return e.kind();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorKind::cancelled;
}

Image ramp(int width, int height, std::vector<std::string> channels) {
  Image image{width, height, std::move(channels), {}};
  image.pixels.resize(static_cast<std::size_t>(width) * height * image.channels.size());
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = static_cast<float>(i) / static_cast<float>(image.pixels.size() - 1);
  }
  return image;
}

int channel(const Image& image, const std::string& name) {
  const auto at = std::ranges::find(image.channels, name);
  EXPECT_NE(at, image.channels.end()) << name;
  return static_cast<int>(at - image.channels.begin());
}

TEST_F(ImageTest, ExrKeepsEveryChannelBitForBit) {
  Image image = ramp(7, 5, {"R", "G", "B", "depth.Z", "normal.X", "id.I"});
  image.at(6, 4, 3) = std::numeric_limits<float>::infinity();
  image.at(0, 0, 0) = 37.5F;
  image.at(1, 0, 4) = -0.25F;
  write_image(path("a.exr"), image);
  const Image back = read_image(path("a.exr"));
  ASSERT_EQ(back.width, 7);
  ASSERT_EQ(back.height, 5);
  ASSERT_EQ(back.channels.size(), image.channels.size());
  for (std::size_t c = 0; c < image.channels.size(); ++c) {
    const int other = channel(back, image.channels[c]);
    for (int y = 0; y < 5; ++y) {
      for (int x = 0; x < 7; ++x) {
        EXPECT_EQ(back.at(x, y, other), image.at(x, y, static_cast<int>(c)));
      }
    }
  }
}

TEST_F(ImageTest, PngKeepsColoursToOneCode) {
  const Image image = ramp(64, 48, {"R", "G", "B"});
  write_image(path("a.png"), image);
  const Image back = read_image(path("a.png"));
  ASSERT_EQ(back.pixels.size(), image.pixels.size());
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    EXPECT_NEAR(srgb_from_linear(back.pixels[i]), srgb_from_linear(image.pixels[i]), 1.0 / 255);
  }
}

TEST_F(ImageTest, PngAlphaIsNotEncoded) {
  Image image = ramp(2, 1, {"R", "G", "B", "A"});
  image.at(0, 0, 3) = 0.5F;
  write_image(path("a.png"), image);
  EXPECT_NEAR(read_image(path("a.png")).at(0, 0, 3), 0.5F, 0.5 / 255 + 1e-6);
}

// A soft gradient keeps its local mean where plain rounding would make steps of a whole code.
TEST_F(ImageTest, DitherKeepsTheMeanBetweenTwoCodes) {
  const float between = linear_from_srgb(100.25F / 255);
  Image image = ramp(8, 8, {"R", "G", "B"});
  for (float& v : image.pixels) v = between;
  write_image(path("a.png"), image);
  double mean = 0;
  for (const float v : read_image(path("a.png")).pixels) mean += 255 * srgb_from_linear(v);
  EXPECT_NEAR(mean / (8 * 8 * 3), 100.25, 0.01);
}

TEST_F(ImageTest, PngOfValuesOutOfRangeIsClipped) {
  Image image{4, 1, {"R", "G", "B"}, {-1, -1, -1, 2, 2, 2, 1, 1, 1, NAN, NAN, NAN}};
  write_image(path("a.png"), image);
  const Image back = read_image(path("a.png"));
  EXPECT_EQ(back.at(0, 0, 0), 0);
  EXPECT_NEAR(back.at(1, 0, 0), 1, 1e-6);
  EXPECT_NEAR(back.at(2, 0, 0), 1, 1e-6);
  EXPECT_EQ(back.at(3, 0, 0), 0);
}

TEST(Srgb, FollowsTheStandard) {
  EXPECT_NEAR(srgb_from_linear(0.18F), 0.46135F, 1e-4);  // mid grey is code 118 of 255
  EXPECT_NEAR(srgb_from_linear(0.0031308F), 0.04045F, 1e-5);
  for (float v = 0; v <= 1; v += 1 / 64.0F) {
    EXPECT_NEAR(linear_from_srgb(srgb_from_linear(v)), v, 1e-6);
  }
}

TEST_F(ImageTest, RefusesWhatTheFormatCannotHold) {
  const Image extra = ramp(2, 2, {"R", "G", "B", "depth.Z"});
  EXPECT_EQ(kind_of([&] { write_image(path("a.png"), extra); }), ErrorKind::usage);
  EXPECT_EQ(kind_of([&] { write_image(path("a.gif"), extra); }), ErrorKind::usage);
  Image wrong = ramp(2, 2, {"R", "G", "B"});
  wrong.width = 3;
  EXPECT_EQ(kind_of([&] { write_image(path("a.png"), wrong); }), ErrorKind::usage);
  EXPECT_EQ(kind_of([&] { write_image(path("a.png"), Image{}); }), ErrorKind::usage);
  EXPECT_EQ(files(), 0U);
}

TEST_F(ImageTest, AFailedWriteLeavesNothing) {
  const Image image = ramp(2, 2, {"R", "G", "B"});
  EXPECT_EQ(kind_of([&] { write_image(path("missing/a.png"), image); }), ErrorKind::failed);
  EXPECT_EQ(files(), 0U);
  // The picture is made, but cannot take the place of a folder.
  std::filesystem::create_directories(path("a.png/full"));
  EXPECT_EQ(kind_of([&] { write_image(path("a.png"), image); }), ErrorKind::failed);
  EXPECT_EQ(files(), 1U);
}

TEST_F(ImageTest, RefusesUnreadablePictures) {
  EXPECT_EQ(kind_of([&] { (void)read_image(path("none.exr")); }), ErrorKind::input);
  std::ofstream(path("broken.png")) << "\x89PNG\r\n\x1a\n then nothing";
  EXPECT_EQ(kind_of([&] { (void)read_image(path("broken.png")); }), ErrorKind::input);
}

}  // namespace
}  // namespace sdfgrid
