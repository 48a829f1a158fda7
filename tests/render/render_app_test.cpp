// `sdfgrid render` as a user's script sees it: exit codes, keys, channels, files.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/process.h"
#include "render/scenes.h"
#include "sdfgrid/grid/vdb.h"
#include "sdfgrid/image/image.h"

namespace sdfgrid::test {
namespace {

using nlohmann::json;
using Names = std::vector<std::string>;

class RenderApp : public ::testing::Test {
 protected:
  // A ball of radius 1 about the origin.
  RenderApp() { write_grid(unit_sphere(), ball_); }

  [[nodiscard]] Outcome render(std::vector<std::string> more) const {
    more.insert(more.begin(), {"render", ball_, "--json"});
    if (std::find(more.begin(), more.end(), "--size") == more.end()) {
      more.insert(more.end(), {"--size", "80x60"});
    }
    return run(more);
  }
  [[nodiscard]] std::string bytes(const std::string& name) const {
    std::ifstream in(folder_.path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  Folder folder_;
  std::string ball_ = folder_.path("ball.vdb");
  std::string png_ = folder_.path("a.png");
  std::string exr_ = folder_.path("a.exr");
};

int channel(const Image& image, const std::string& name) {
  const auto at = std::find(image.channels.begin(), image.channels.end(), name);
  return at == image.channels.end() ? -1 : static_cast<int>(at - image.channels.begin());
}

TEST_F(RenderApp, WritesAPictureAndItsNumbers) {
  const Outcome outcome = render({"-o", png_});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  const json result = json::parse(outcome.out);
  EXPECT_EQ(result["width"], 80);
  EXPECT_EQ(result["height"], 60);
  EXPECT_EQ(result["rays"], 80 * 60);
  EXPECT_GT(result["hits"], 1000);
  EXPECT_LT(result["hits"], 80 * 60);
  EXPECT_GE(result["steps_max"].get<double>(), result["steps_mean"].get<double>());
  for (const char* key : {"load", "trace", "shade", "write", "total"}) {
    EXPECT_GE(result["seconds"][key].get<double>(), 0) << key;
  }
  const Image image = read_image(png_);
  EXPECT_EQ(image.width, 80);
  EXPECT_EQ(image.height, 60);
  EXPECT_EQ(image.channels, (Names{"R", "G", "B"}));
  EXPECT_EQ(folder_.files(), (Names{"a.png", "ball.vdb"}));
}

TEST_F(RenderApp, AovsAreChannelsOfTheExr) {
  const Outcome outcome = render({"-o", exr_, "--aov", "depth,normal,steps,id,curvature", "--eye",
                                  "0,0,4", "--target", "0,0,0", "--fov", "40"});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  const Image image = read_image(exr_);
  for (const char* name : {"R", "G", "B", "depth.Z", "normal.X", "normal.Y", "normal.Z", "steps.N",
                           "id.I", "curvature.K"}) {
    EXPECT_GE(channel(image, name), 0) << name;
  }
  ASSERT_EQ(image.channels.size(), 10U);
  const auto at = [&](int x, int y, const char* name) {
    return image.at(x, y, channel(image, name));
  };
  EXPECT_NEAR(at(40, 30, "depth.Z"), 3, 0.01);
  EXPECT_NEAR(at(40, 30, "normal.Z"), 1, 0.01);
  EXPECT_GT(at(50, 30, "normal.X"), 0.1);
  EXPECT_GT(at(40, 20, "normal.Y"), 0.1) << "y is up in the picture";
  EXPECT_GE(at(40, 30, "steps.N"), 1);
  EXPECT_EQ(at(40, 30, "id.I"), 1);
  EXPECT_NEAR(at(40, 30, "curvature.K"), 1, 0.05);
  EXPECT_EQ(at(0, 0, "depth.Z"), INFINITY);
  EXPECT_EQ(at(0, 0, "normal.Z"), 0);
  EXPECT_EQ(at(0, 0, "id.I"), 0);
  const json result = json::parse(outcome.out);
  int hits = 0;
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) hits += static_cast<int>(at(x, y, "id.I"));
  }
  EXPECT_EQ(result["hits"], hits);
}

TEST_F(RenderApp, APngCannotHoldAovs) {
  const Outcome outcome = render({"-o", png_, "--aov", "depth"});
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.error.find(".exr"), std::string::npos) << outcome.error;
  EXPECT_EQ(folder_.files(), (Names{"ball.vdb"}));
}

TEST_F(RenderApp, MistakesAreUsageErrorsWithARemedy) {
  const auto refused = [&](const std::vector<std::string>& words, const std::string& remedy) {
    const Outcome outcome = render(words);
    EXPECT_EQ(outcome.exit, 2) << words.back();
    EXPECT_NE(outcome.error.find(remedy), std::string::npos) << outcome.error;
  };
  refused({"-o", folder_.path("a.jpg")}, ".png or .exr");
  refused({"-o", exr_, "--aov", "dept"}, "depth");
  refused({"-o", png_, "--size", "100"}, "1024x768");
  refused({"-o", png_, "--size", "0x10"}, "32768");
  refused({"-o", png_, "--eye", "1,2"}, "three numbers");
  refused({"-o", png_, "--eye", "1,2,nan"}, "three numbers");
  refused({"-o", png_, "--up", "w"}, "three numbers");
  refused({"-o", png_, "--up", "0,0,0"}, "direction");
  refused({"-o", png_, "--eye", "1,1,1", "--target", "1,1,1"}, "same point");
  refused({"-o", png_, "--fov", "180"}, "fov");
  refused({"-o", png_, "--samples", "0"}, "samples");
  refused({"-o", png_, "--eye", "1,2,3", "--turn", "10"}, "turn");
  EXPECT_EQ(folder_.files(), (Names{"ball.vdb"}));
}

TEST_F(RenderApp, KeepsAnExistingPictureUnlessForced) {
  ASSERT_EQ(render({"-o", png_}).exit, 0);
  const std::string before = bytes("a.png");
  EXPECT_EQ(render({"-o", png_, "--turn", "90", "--tilt", "60"}).exit, 2);
  EXPECT_EQ(bytes("a.png"), before);
  EXPECT_EQ(render({"-o", png_, "--tilt", "60", "--force"}).exit, 0);
  EXPECT_NE(bytes("a.png"), before);
}

TEST_F(RenderApp, GivesTheSameBytesAtAnyNumberOfThreads) {
  ASSERT_EQ(render({"-o", png_, "--threads", "1"}).exit, 0);
  const std::string alone = bytes("a.png");
  ASSERT_EQ(render({"-o", png_, "--threads", "3", "--force"}).exit, 0);
  EXPECT_EQ(bytes("a.png"), alone);
}

TEST_F(RenderApp, ShowsAMesh) {
  const std::string cube = folder_.write("cube.off", cube_off());
  const Outcome outcome = run({"render", cube, "-o", exr_, "--json", "--size", "64x64", "--dim",
                               "40", "--aov", "normal", "--turn", "0", "--tilt", "0"});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  const Image image = read_image(exr_);
  EXPECT_NEAR(image.at(32, 32, channel(image, "normal.Z")), 1, 1e-3) << "the face towards +z";
}

TEST_F(RenderApp, FramesAllOfACoarseGrid) {
  const std::string cube = folder_.write("cube.off", cube_off());
  for (const char* dim : {"4", "9", "16", "32"}) {
    for (const char* turn : {"30", "45", "200"}) {
      const Outcome outcome = run({"render", cube, "-o", exr_, "--size", "64x64", "--dim", dim,
                                   "--aov", "id", "--turn", turn, "--force"});
      ASSERT_EQ(outcome.exit, 0) << outcome.error;
      const Image image = read_image(exr_);
      const int id = channel(image, "id.I");
      for (int i = 0; i < 64; ++i) {
        EXPECT_EQ(
            image.at(i, 0, id) + image.at(i, 63, id) + image.at(0, i, id) + image.at(63, i, id), 0)
            << dim << " " << turn << " " << i;
      }
    }
  }
}

TEST_F(RenderApp, TurnFramesAScenesContentWhateverItsCamera) {
  const std::string plain =
      folder_.write("plain.yaml", "sdfgrid: 1\nscene: {box: {size: [1, 2, 3]}}\n");
  const std::string seen = folder_.write("seen.yaml",
                                         "sdfgrid: 1\nscene: {box: {size: [1, 2, 3]}}\ncamera: "
                                         "{eye: [0, 9, 40], target: [0, 1, 0]}\n");
  const auto picture = [&](const std::string& scene, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"render", scene, "-o", png_, "--size", "40x40", "--force"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.exit, 0) << outcome.error;
    return bytes("a.png");
  };
  EXPECT_EQ(picture(seen, {"--turn", "70"}), picture(plain, {"--turn", "70"}));
  EXPECT_EQ(picture(seen, {"--tilt", "70"}), picture(plain, {"--tilt", "70"}));
  EXPECT_NE(picture(seen, {}), picture(plain, {}));
}

TEST_F(RenderApp, UpMayBeAnyAxis) {
  ASSERT_EQ(render({"-o", exr_, "--up", "z", "--aov", "normal", "--turn", "0", "--tilt", "0"}).exit,
            0);
  const Image image = read_image(exr_);
  EXPECT_NEAR(image.at(40, 30, channel(image, "normal.Y")), -1, 0.01) << "seen from -y";
  EXPECT_GT(image.at(40, 15, channel(image, "normal.Z")), 0.3) << "z is up";
}

TEST_F(RenderApp, AnEmptyGridIsAWarningAndTheBackground) {
  write_grid(Grid(), ball_);
  const Outcome outcome = render({"-o", png_});
  EXPECT_EQ(outcome.exit, 0) << outcome.error;
  const json result = json::parse(outcome.out);
  EXPECT_EQ(result["hits"], 0);
  ASSERT_EQ(result["warnings"].size(), 1U);
  EXPECT_NE(outcome.error.find("no surface"), std::string::npos) << outcome.error;
}

// Density is no distance: tracing it as one would show something, and be wrong.
TEST_F(RenderApp, FogNeedsAnIsoValue) {
  Grid fog = unit_sphere();
  vdb(fog)->setGridClass(openvdb::GRID_FOG_VOLUME);
  write_grid(fog, ball_);
  EXPECT_EQ(json::parse(run({"info", ball_, "--json"}).out)["class"], "fog volume");
  const std::string npy = folder_.path("a.npy");
  for (const std::vector<std::string>& call :
       {std::vector<std::string>{"render", ball_, "-o", png_, "--size", "8x8"},
        {"sample", ball_, "-o", npy, "--random", "9"},
        {"compare", ball_, ball_}}) {
    const Outcome outcome = run(call);
    EXPECT_EQ(outcome.exit, 4) << call[0];
    EXPECT_NE(outcome.error.find("fog volume"), std::string::npos) << outcome.error;
    EXPECT_NE(outcome.error.find("--iso"), std::string::npos) << outcome.error;
  }
  const Outcome shown = render({"-o", png_, "--iso", "0", "--below"});
  ASSERT_EQ(shown.exit, 0) << shown.error;
  EXPECT_GT(json::parse(shown.out)["hits"], 100);
}

TEST_F(RenderApp, InsideIsAWarning) {
  const Outcome outcome = render({"-o", png_, "--eye", "0,0,0.1"});
  EXPECT_EQ(outcome.exit, 0) << outcome.error;
  EXPECT_NE(outcome.error.find("inside"), std::string::npos) << outcome.error;
}

TEST_F(RenderApp, RefusesWhatItCannotRead) {
  const std::string broken = folder_.write("broken.vdb", "not a grid");
  EXPECT_EQ(run({"render", broken, "-o", png_}).exit, 4);
  EXPECT_EQ(run({"render", folder_.path("none.vdb"), "-o", png_}).exit, 4);
  EXPECT_EQ(run({"render", folder_.path("none.off"), "-o", png_}).exit, 4);
  EXPECT_EQ(folder_.files(), (Names{"ball.vdb", "broken.vdb"}));
}

}  // namespace
}  // namespace sdfgrid::test
