// Volumes on the command line: convert, transform, render, compare and info with them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/process.h"

namespace sdfgrid::test {
namespace {

using nlohmann::json;

constexpr int kSize = 24;
const double kCenter[3] = {11.3, 12.1, 10.8};
constexpr double kRadius = 7;

// A ball of grey values: 100 at its surface, falling by 10 a sample outwards.
std::string ball_nrrd(const std::string& geometry = "") {
  std::string bytes = fmt::format(
      "NRRD0004\ntype: float\ndimension: 3\nsizes: {0} {0} {0}\nendian: little\nencoding: "
      "raw\n{1}\n",
      kSize, geometry);
  for (int k = 0; k < kSize; ++k) {
    for (int j = 0; j < kSize; ++j) {
      for (int i = 0; i < kSize; ++i) {
        const double r = std::hypot(i - kCenter[0], j - kCenter[1], k - kCenter[2]);
        const auto value = static_cast<float>(100 - 10 * (r - kRadius));
        bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
      }
    }
  }
  return bytes;
}

// Three labels in slabs along x: `first` for i < 4, 3 for i < 8, 5 beyond.
std::string labels_npy(int first = 0) {
  std::string header = "{'descr': '|u1', 'fortran_order': False, 'shape': (12, 6, 5), }";
  header.append(63 - (10 + header.size()) % 64, ' ');
  std::string bytes = std::string("\x93NUMPY\x01\0", 8) + static_cast<char>(header.size() + 1) +
                      '\0' + header + '\n';
  for (int i = 0; i < 12; ++i) bytes.append(30, static_cast<char>(i < 4 ? first : i < 8 ? 3 : 5));
  return bytes;
}

std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Sample (i, 2, 2) of a .npy of 12 x 6 x 5 floats as transform writes it, x fastest.
float distance_at(const std::string& npy, int i) {
  float value = 0;
  std::memcpy(&value, npy.data() + npy.size() - 4 * 360 + 4 * (i + 12 * (2 + 6 * 2)), 4);
  return value;
}

class VolumeCommand : public ::testing::Test {
 protected:
  Folder folder_;
  std::string ball_ = folder_.write("ball.nrrd", ball_nrrd());
  std::string grid_ = folder_.path("ball.vdb");
};

TEST_F(VolumeCommand, ConvertMakesASubvoxelLevelSet) {
  const Outcome made = run({"convert", ball_, "--iso", "100", "-o", grid_, "--json", "--quiet"});
  ASSERT_EQ(made.exit, 0) << made.error;
  EXPECT_EQ(json::parse(made.out)["voxel"], 1.0);
  EXPECT_EQ(json::parse(made.out)["sign"], "normal");
  EXPECT_TRUE(json::parse(made.out)["warnings"].empty());
  // Against the volume's own surface: exact.
  const Outcome same = run({"compare", grid_, ball_, "--iso", "100", "--json", "--quiet"});
  ASSERT_EQ(same.exit, 0) << same.error;
  EXPECT_LT(json::parse(same.out)["max_error"].get<double>(), 1e-5);
  EXPECT_EQ(json::parse(same.out)["sign_errors"], 0);
  const json info = json::parse(run({"info", grid_, "--json", "--quiet"}).out);
  for (int a = 0; a < 3; ++a) {
    const double lo = info["bounds"][0][a];
    const double hi = info["bounds"][1][a];
    EXPECT_NEAR(lo, kCenter[a] - kRadius - 3, 1.01);
    EXPECT_NEAR(hi, kCenter[a] + kRadius + 3, 1.01);
  }
}

TEST_F(VolumeCommand, AnisotropicVolumesTakeTheSmallestSpacing) {
  const std::string flat = folder_.write("flat.nrrd", ball_nrrd("spacings: 1 0.5 2\n"));
  const Outcome made = run({"convert", flat, "--iso", "100", "-o", grid_, "--json", "--quiet"});
  ASSERT_EQ(made.exit, 0) << made.error;
  EXPECT_EQ(json::parse(made.out)["voxel"], 0.5);
  const json dims = json::parse(made.out)["dims"];
  EXPECT_NEAR(dims[0].get<double>(), 2 * 14 + 6, 2);
  EXPECT_NEAR(dims[1].get<double>(), 14 + 6, 2);
  EXPECT_NEAR(dims[2].get<double>(), 4 * 14 + 6, 2);
}

TEST_F(VolumeCommand, EveryKindOfOutput) {
  for (const char* name : {"a.vdb", "a.nvdb", "a.npy", "a.nrrd", "a.vti"}) {
    const Outcome made = run({"convert", ball_, "--iso", "100", "-o", folder_.path(name)});
    EXPECT_EQ(made.exit, 0) << name << made.error;
    EXPECT_GT(read_file(folder_.path(name)).size(), 20000U) << name;
  }
  // A level set in a dense file is a volume whose inside is below 0.
  const Outcome back =
      run({"convert", folder_.path("a.nrrd"), "--iso", "0", "--below", "-o", grid_});
  ASSERT_EQ(back.exit, 0) << back.error;
  const json moved =
      json::parse(run({"compare", grid_, ball_, "--iso", "100", "--json", "--quiet"}).out);
  EXPECT_LT(moved["max_error"].get<double>(), 0.1);
}

TEST_F(VolumeCommand, ALevelSetIsNoFogButAGridToWriteInAnotherFormat) {
  const std::string npy = folder_.path("a.npy");
  const Outcome made = run({"convert", ball_, "--iso", "100", "-o", grid_, "--json", "--quiet"});
  ASSERT_EQ(made.exit, 0) << made.error;
  EXPECT_FALSE(json::parse(made.out).contains("origin")) << "a grid states its own";
  const Outcome fog = run({"convert", grid_, "--iso", "0", "-o", npy});
  EXPECT_EQ(fog.exit, 4);
  EXPECT_NE(fog.error.find("level set"), std::string::npos) << fog.error;
  EXPECT_NE(fog.error.find("without --iso"), std::string::npos) << fog.error;
  EXPECT_EQ(run({"convert", grid_, "-o", npy, "--dim", "9"}).exit, 2);

  const Outcome dense = run({"convert", grid_, "-o", npy, "--json", "--quiet"});
  ASSERT_EQ(dense.exit, 0) << dense.error;
  const json info = json::parse(run({"info", npy, "--json", "--quiet"}).out);
  EXPECT_EQ(info["dims"], json::parse(made.out)["dims"]);
  const json grid = json::parse(run({"info", grid_, "--json", "--quiet"}).out);
  EXPECT_EQ(json::parse(dense.out)["origin"], grid["bounds"][0]);
  // The same samples as straight from the volume.
  const std::string straight = folder_.path("b.npy");
  ASSERT_EQ(run({"convert", ball_, "--iso", "100", "-o", straight}).exit, 0);
  EXPECT_EQ(read_file(npy), read_file(straight));
}

TEST_F(VolumeCommand, WhatIsOnlyWrittenIsSaidToBe) {
  for (const char* name : {"a.nvdb", "a.vti"}) {
    const Outcome outcome = run({"info", folder_.write(name, "bytes")});
    EXPECT_EQ(outcome.exit, 4) << name;
    EXPECT_NE(outcome.error.find("written, but not read"), std::string::npos) << outcome.error;
  }
  // Whatever it is called, and where a grid is asked for.
  const std::string renamed = folder_.write("b.vdb", "NanoVDB0 and so on");
  const std::string scene = folder_.write(
      "s.yaml", "sdfgrid: 1\nscene:\n  - grid: {file: " + folder_.path("a.nvdb") + "}\n");
  for (const std::string& name : {renamed, scene}) {
    const Outcome outcome = run({"info", name});
    EXPECT_EQ(outcome.exit, 4) << name;
    EXPECT_NE(outcome.error.find("written, but not read"), std::string::npos) << outcome.error;
  }
  const Outcome outcome = run({"sample", ball_, "-o", folder_.path("s.npy"), "--random", "9"});
  EXPECT_EQ(outcome.exit, 4);
  EXPECT_NE(outcome.error.find("volume"), std::string::npos) << outcome.error;
}

TEST_F(VolumeCommand, AMeshThinnerThanAVoxelIsAWarning) {
  // A plate of 10 x 10 x 0.01 between the samples of voxel size 1.
  const std::string plate = folder_.write(
      "plate.off",
      "OFF\n8 6 0\n0.5 0.5 0.5\n10.5 0.5 0.5\n10.5 10.5 0.5\n0.5 10.5 0.5\n0.5 0.5 0.51\n"
      "10.5 0.5 0.51\n10.5 10.5 0.51\n0.5 10.5 0.51\n4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n"
      "4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n");
  const auto warned = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"convert", plate, "-o", grid_, "--force"});
    const Outcome outcome = run(more);
    EXPECT_EQ(outcome.exit, 0) << outcome.error;
    return outcome.error.find("no inside") != std::string::npos;
  };
  EXPECT_TRUE(warned({"--voxel", "1"}));
  EXPECT_TRUE(warned({"--voxel", "1", "--dense"}));
  EXPECT_FALSE(warned({"--voxel", "1", "--sign", "unsigned"}));
  EXPECT_FALSE(warned({"--voxel", "0.101"})) << "5 * 0.101 is within the plate";
}

TEST_F(VolumeCommand, AVolumeNeedsIsoAndAMeshMayNotHaveIt) {
  const Outcome without = run({"convert", ball_, "-o", grid_});
  EXPECT_EQ(without.exit, 2);
  EXPECT_NE(without.error.find("--iso"), std::string::npos);
  const std::string cube = folder_.write("cube.off", cube_off());
  EXPECT_EQ(run({"convert", cube, "--iso", "1", "-o", grid_}).exit, 2);
  EXPECT_EQ(run({"convert", ball_, "--iso", "1e9", "-o", grid_}).exit, 4);
  EXPECT_EQ(run({"convert", folder_.write("a.raw", "abcd"), "--iso", "1", "-o", grid_}).exit, 2);
  EXPECT_FALSE(std::ifstream(grid_).good());
}

TEST_F(VolumeCommand, RenderShowsAVolume) {
  const std::string picture = folder_.path("ball.png");
  const Outcome made =
      run({"render", ball_, "--iso", "100", "-o", picture, "--size", "64x64", "--json", "--quiet"});
  ASSERT_EQ(made.exit, 0) << made.error;
  EXPECT_GT(json::parse(made.out)["hits"].get<int>(), 1000);
}

TEST_F(VolumeCommand, InfoSaysWhatAVolumeHolds) {
  const json info = json::parse(run({"info", ball_, "--json", "--quiet"}).out);
  EXPECT_EQ(info["kind"], "volume");
  EXPECT_EQ(info["type"], "float32");
  EXPECT_EQ(info["dims"], json({kSize, kSize, kSize}));
  EXPECT_EQ(info["bounds"][1][0], kSize - 1.0);
  EXPECT_LT(info["range"][0].get<double>(), 100);
}

TEST_F(VolumeCommand, TransformMakesDistancesOfLabels) {
  const std::string labels = folder_.write("labels.npy", labels_npy());
  const std::string out = folder_.path("d.npy");
  const Outcome made = run({"transform", labels, "-o", out, "--json", "--quiet"});
  ASSERT_EQ(made.exit, 0) << made.error;
  const json result = json::parse(made.out);
  EXPECT_EQ(result["method"], "meijster");
  EXPECT_EQ(result["dims"], json({12, 6, 5}));
  EXPECT_EQ(result["voxels"], 360);
  for (const char* key : {"read", "transform", "write", "total"}) {
    EXPECT_TRUE(result["seconds"].contains(key)) << key;
  }
  std::string npy = read_file(out);
  for (int i = 0; i < 12; ++i) EXPECT_EQ(distance_at(npy, i), static_cast<float>(3.5 - i)) << i;

  ASSERT_EQ(run({"transform", labels, "-o", out, "--force", "--label", "3", "--inside"}).exit, 0);
  npy = read_file(out);
  const float slab[] = {0, 0, 0, 0, 1, 2, 2, 1, 0, 0, 0, 0};
  for (int i = 0; i < 12; ++i) EXPECT_EQ(distance_at(npy, i), slab[i]) << i;

  ASSERT_EQ(run({"transform", labels, "-o", out, "--force", "--label", "3", "--outside",
                 "--spacing", "0.5,1,1", "--window", "3"})
                .exit,
            0);
  npy = read_file(out);
  const float cut[] = {1.5, 1.5, 1, 0.5, 0, 0, 0, 0, 0.5, 1, 1.5, 1.5};
  for (int i = 0; i < 12; ++i) EXPECT_EQ(distance_at(npy, i), cut[i]) << i;
}

TEST_F(VolumeCommand, TransformOfGreyEdges) {
  // A ball whose edge is 20 grey levels deep: 0 outside, 100 inside.
  const std::string ball = folder_.write("ball.nrrd", ball_nrrd());
  const std::string out = folder_.path("d.nrrd");
  const std::vector<std::string> base = {"transform",   ball,      "-o",     out,      "--method",
                                         "antialiased", "--force", "--json", "--quiet"};
  auto with = base;
  with.insert(with.end(), {"--range", "95,105"});
  const Outcome made = run(with);
  ASSERT_EQ(made.exit, 0) << made.error;
  EXPECT_EQ(json::parse(made.out)["method"], "antialiased");
  // Sample (11, 12, 11) is 0.37 from the centre of the ball of radius 7.
  const std::string bytes = read_file(out);
  float value = 0;
  const std::size_t place = 11 + kSize * (12 + kSize * 11);
  std::memcpy(&value, bytes.data() + bytes.size() - 4 * (kSize * kSize * kSize - place), 4);
  EXPECT_NEAR(value, -6.63, 0.15);
  for (const auto& wrong : std::vector<std::vector<std::string>>{
           {"--range", "1"}, {"--range", "3,3"}, {"--iso", "100"}}) {
    auto refused = base;
    refused.insert(refused.end(), wrong.begin(), wrong.end());
    EXPECT_EQ(run(refused).exit, 2) << wrong.front();
  }
  EXPECT_EQ(run({"transform", ball, "-o", out, "--force", "--range", "0,1"}).exit, 2);
  EXPECT_EQ(run({"transform", ball, "-o", out, "--force", "--method", "chamfer"}).exit, 2);
}

TEST_F(VolumeCommand, TransformWritesEveryKindAndRefusesWhatAGridCannotHold) {
  const std::string labels = folder_.write("labels.npy", labels_npy());
  for (const char* name : {"a.npy", "a.nrrd", "a.vti", "a.vdb", "a.nvdb"}) {
    EXPECT_EQ(run({"transform", labels, "-o", folder_.path(name)}).exit, 0) << name;
  }
  const json info = json::parse(run({"info", folder_.path("a.vdb"), "--json", "--quiet"}).out);
  EXPECT_EQ(info["active_voxels"], 360);
  const Outcome flat =
      run({"transform", labels, "-o", folder_.path("b.vdb"), "--spacing", "1,1,2"});
  EXPECT_EQ(flat.exit, 2);
  EXPECT_NE(flat.error.find(".nrrd"), std::string::npos) << flat.error;
  EXPECT_EQ(run({"transform", labels, "-o", folder_.path("b.npy"), "--method", "meister"}).exit, 2);
  EXPECT_EQ(run({"transform", labels, "-o", folder_.path("b.npy"), "--label", "9"}).exit, 0);
}

TEST_F(VolumeCommand, InfiniteDistancesAreForArrays) {
  const std::string labels = folder_.write("labels.npy", labels_npy(/*first=*/1));
  for (const std::vector<std::string>& one_side :
       {std::vector<std::string>{}, {"--label", "9"}, {"--iso", "6"}, {"--method", "fmm2"}}) {
    for (const char* name : {"a.vdb", "a.nvdb", "a.npy"}) {
      std::vector<std::string> command = {"transform", labels, "-o", folder_.path(name), "--force"};
      command.insert(command.end(), one_side.begin(), one_side.end());
      const Outcome made = run(command);
      const bool array = std::string(name) == "a.npy";
      EXPECT_EQ(made.exit, array ? 0 : 4) << name;
      for (const char* text : {"labels.npy", "infinite", array ? "warning" : ".nrrd"}) {
        EXPECT_NE(made.error.find(text), std::string::npos) << made.error;
      }
      EXPECT_EQ(std::ifstream(folder_.path(name)).good(), array);
    }
  }
  EXPECT_EQ(run({"transform", labels, "-o", grid_, "--window", "3"}).exit, 0) << "3 is finite";
}

TEST_F(VolumeCommand, AntialiasedWarnsOfMasks) {
  const std::string labels = folder_.write("labels.npy", labels_npy());
  const auto warnings = [&](const std::string& input, const std::vector<std::string>& more) {
    std::vector<std::string> command = {
        "transform", input,         "-o",      folder_.path("d.npy"),
        "--method",  "antialiased", "--force", "--json"};
    command.insert(command.end(), more.begin(), more.end());
    const Outcome made = run(command);
    EXPECT_EQ(made.exit, 0) << made.error;
    return json::parse(made.out)["warnings"].dump();
  };
  EXPECT_EQ(warnings(ball_, {}), "[]");
  for (const char* text : {"labels.npy", "grey", "meijster"}) {
    EXPECT_NE(warnings(labels, {"--range", "0,3"}).find(text), std::string::npos) << text;
    EXPECT_NE(warnings(labels, {"--label", "3"}).find(text), std::string::npos) << text;
  }
}

TEST_F(VolumeCommand, MalformedVolumesAreRefused) {
  const std::string whole = ball_nrrd();
  const std::string cut = folder_.write("cut.nrrd", whole.substr(0, whole.size() / 2));
  for (const char* command : {"convert", "transform", "render"}) {
    const Outcome outcome =
        run({command, cut, "--iso", "1", "-o",
             folder_.path(std::string(command) == "render" ? "a.png" : "a.vdb")});
    EXPECT_EQ(outcome.exit, 4) << command;
    EXPECT_NE(outcome.error.find(cut), std::string::npos) << outcome.error;
  }
  EXPECT_EQ(run({"info", cut}).exit, 4);
}

}  // namespace
}  // namespace sdfgrid::test
