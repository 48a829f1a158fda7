// chart and convert --tolerance on the command line.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/process.h"

namespace sdfgrid::test {
namespace {

using nlohmann::json;

std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class Chart : public ::testing::Test {
 protected:
  Folder folder_;
  std::string cube_ = folder_.write("cube.off", cube_off());
  std::string chart_ = folder_.path("chart.svg");
};

TEST_F(Chart, WritesPicturesAndTables) {
  const Outcome made =
      run({"chart", cube_, "-o", chart_, "--dims", "8,16,32", "--methods", "exact,sweep",
           "--samples", "500", "--repeat", "1", "--threads", "1", "--json", "--quiet"});
  ASSERT_EQ(made.exit, 0) << made.error;
  EXPECT_EQ(folder_.files(), (std::vector<std::string>{"chart.csv", "chart.json", "chart.png",
                                                       "chart.svg", "cube.off"}));
  EXPECT_EQ(read_file(folder_.path("chart.png")).substr(1, 3), "PNG");
  const std::string svg = read_file(chart_);
  for (const char* text :
       {"exact", "sweep", "Pareto front", "cube.off", "--threads 1", "smooth", "edge", "medial"}) {
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  }
  const std::string csv = read_file(folder_.path("chart.csv"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 7);
  const json result = json::parse(made.out);
  ASSERT_EQ(result["points"].size(), 6U);
  // The front: nobody is better in both.
  for (const json& point : result["points"]) {
    const bool beaten =
        std::any_of(result["points"].begin(), result["points"].end(), [&](const json& other) {
          return other["seconds"] < point["seconds"] &&
                 other["between"]["max_error"] < point["between"]["max_error"];
        });
    EXPECT_FALSE(point["on_front"].get<bool>() && beaten);
    EXPECT_GT(point["bytes"].get<double>(), 0);
    EXPECT_GT(point["seconds"].get<double>(), 0);
    if (point["method"] == "exact") {
      EXPECT_LT(point["voxels"]["max_error"].get<double>(), 1e-5 * point["voxel"].get<double>());
    }
  }
  EXPECT_EQ(run({"chart", cube_, "-o", chart_, "--dims", "8"}).exit, 2) << "--force is needed";
}

TEST_F(Chart, KnowsEveryMethodOfConvert) {
  const std::string mask = folder_.write("mask.txt", "1 0 0 1\n1 1 0 1.41\n1 1 1 1.7 # diagonal\n");
  const Outcome made = run({"chart", cube_, "-o", chart_, "--dims", "8", "--samples", "200",
                            "--repeat", "1", "--mask", mask, "--json", "--quiet"});
  ASSERT_EQ(made.exit, 0) << made.error;
  const json result = json::parse(made.out);
  std::vector<std::string> charted;
  for (const json& point : result["points"]) charted.push_back(point["method"]);
  for (const std::string& method : charted) {
    if (method == "openvdb" || method == "sweep") continue;
    const std::string grid = folder_.path(method + ".vdb");
    std::vector<std::string> call = {"convert", cube_,      "-o",   grid,     "--dim",
                                     "8",       "--method", method, "--json", "--quiet"};
    if (method == "chamfer") call.insert(call.end(), {"--mask", mask});
    const Outcome converted = run(call);
    EXPECT_EQ(converted.exit, 0) << converted.error;
    EXPECT_EQ(json::parse(converted.out)["method"], method);
  }
  EXPECT_EQ(charted.size(), 12U) << "exact, nine transforms, two peers";
}

// A sheet has no inside: the exact method does it without a sign, the mask's transform has nothing.
TEST_F(Chart, LeavesOutWhatCannotBeMeasured) {
  const std::string sheet =
      folder_.write("sheet.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n");
  const auto chart = [&](const std::string& methods) {
    return run({"chart", sheet, "-o", chart_, "--dims", "8,16", "--methods", methods, "--samples",
                "200", "--repeat", "1", "--json"});
  };
  const Outcome nothing = chart("meijster");
  EXPECT_EQ(nothing.exit, 4) << nothing.error;
  EXPECT_NE(nothing.error.find("sheet.off"), std::string::npos) << nothing.error;
  EXPECT_EQ(folder_.files(), (std::vector<std::string>{"cube.off", "sheet.off"}));
  const Outcome made = chart("exact,meijster");
  ASSERT_EQ(made.exit, 0) << made.error;
  const json result = json::parse(made.out);
  ASSERT_EQ(result["points"].size(), 2U);
  for (const json& point : result["points"]) EXPECT_EQ(point["method"], "exact");
  for (const char* text : {"meijster at 8 voxels", "meijster at 16 voxels", "no active voxels"}) {
    EXPECT_NE(made.error.find(text), std::string::npos) << text << made.error;
  }
}

TEST_F(Chart, SaysWhatItWrites) {
  const Outcome made = run({"chart", cube_, "-o", chart_, "--dims", "8", "--methods", "exact",
                            "--samples", "200", "--repeat", "1", "--quiet"});
  ASSERT_EQ(made.exit, 0) << made.error;
  for (const char* name : {"chart.svg", "chart.png", "chart.csv", "chart.json"}) {
    EXPECT_NE(made.out.find(folder_.path(name)), std::string::npos) << made.out;
  }
}

// On the surface of a level set; what has no inside is refused with a remedy.
TEST_F(Chart, DoesGrids) {
  const std::string grid = folder_.path("cube.vdb");
  ASSERT_EQ(run({"convert", cube_, "-o", grid, "--dim", "32", "--quiet"}).exit, 0);
  const auto chart = [&] {
    return run({"chart", grid, "-o", chart_, "--force", "--dims", "16", "--methods", "exact",
                "--samples", "500", "--repeat", "1", "--json", "--quiet"});
  };
  const Outcome made = chart();
  ASSERT_EQ(made.exit, 0) << made.error;
  const json result = json::parse(made.out);
  ASSERT_EQ(result["points"].size(), 1U);
  const json& point = result["points"][0];
  EXPECT_LT(point["voxels"]["max_error"].get<double>(), 1e-5 * point["voxel"].get<double>());
  ASSERT_EQ(run({"convert", cube_, "-o", grid, "--force", "--sign", "unsigned", "--quiet"}).exit,
            0);
  const Outcome refused = chart();
  EXPECT_EQ(refused.exit, 4);
  EXPECT_NE(refused.error.find("no sign"), std::string::npos) << refused.error;
}

TEST_F(Chart, DoesScenes) {
  const std::string scene =
      folder_.write("scene.yaml", "sdfgrid: 1\nscene:\n  - sphere: {radius: 1}\n");
  const Outcome made = run({"chart", scene, "-o", chart_, "--dims", "16,32", "--methods", "exact",
                            "--samples", "500", "--repeat", "1", "--json", "--quiet"});
  ASSERT_EQ(made.exit, 0) << made.error;
  const json result = json::parse(made.out);
  ASSERT_EQ(result["points"].size(), 4U);
  for (const json& point : result["points"]) {
    // A ball's field is its distance; its triangles lie within a hundredth of a voxel of it.
    EXPECT_LT(point["voxels"]["max_error"].get<double>(), 0.01 * point["voxel"].get<double>());
    EXPECT_EQ(point["voxels"]["sign_errors"], 0);
  }
}

TEST_F(Chart, DenseFieldsFillTheBox) {
  const std::string scene =
      folder_.write("scene.yaml", "sdfgrid: 1\nscene:\n  - sphere: {radius: 1}\n");
  for (const std::string& in : {cube_, scene}) {
    for (const char* out : {"dense.npy", "dense.vdb"}) {
      const Outcome made = run({"convert", in, "-o", folder_.path(out), "--force", "--dim", "16",
                                "--dense", "--json", "--quiet"});
      ASSERT_EQ(made.exit, 0) << made.error;
      const json result = json::parse(made.out);
      const double samples = result["dims"][0].get<double>() * result["dims"][1].get<double>() *
                             result["dims"][2].get<double>();
      EXPECT_GE(samples, 22 * 22 * 22);
      EXPECT_EQ(result["active_voxels"].get<double>(), samples) << out;
    }
  }
  const std::string grid = folder_.path("cube.vdb");
  ASSERT_EQ(run({"convert", cube_, "-o", grid, "--dim", "16", "--dense", "--quiet"}).exit, 0);
  EXPECT_EQ(run({"compare", grid, cube_, "--quiet"}).exit, 0) << "the stated error holds";
  EXPECT_EQ(run({"convert", cube_, "-o", grid, "--force", "--dim", "16", "--dense", "--method",
                 "feature", "--quiet"})
                .exit,
            2);
}

TEST_F(Chart, MasksAreChecked) {
  const std::string grid = folder_.path("cube.vdb");
  const auto convert = [&](const std::string& mask) {
    return run({"convert", cube_, "-o", grid, "--dim", "8", "--method", "chamfer", "--mask", mask});
  };
  EXPECT_EQ(run({"convert", cube_, "-o", grid, "--dim", "8", "--method", "chamfer"}).exit, 2);
  EXPECT_EQ(convert(folder_.path("none.txt")).exit, 4);
  for (const char* text :
       {"1 0 0 1\n2 2 0 2.8\n", "1 0 0\n", "1 0 0 1 7\n", "1 1 0 1.4\n", "x\n", "1 0 0 -1\n", ""}) {
    const Outcome refused = convert(folder_.write("mask.txt", text));
    EXPECT_EQ(refused.exit, 4) << text;
    EXPECT_NE(refused.error.find("mask.txt"), std::string::npos) << refused.error;
  }
  EXPECT_NE(convert(folder_.write("mask.txt", "1 0 0 1\n2 2 0 2\n")).error.find("line 2"),
            std::string::npos);
}

TEST_F(Chart, OptionsOfOtherMethodsAreRefused) {
  const std::string grid = folder_.path("cube.vdb");
  const std::string mask = folder_.write("mask.txt", "1 0 0 1\n");
  const auto convert = [&](const std::string& method, const std::string& option,
                           const std::string& value) {
    return run(
        {"convert", cube_, "-o", grid, "--dim", "8", "--force", "--method", method, option, value});
  };
  for (const char* method : {"exact", "meijster", "chamfer345", "feature"}) {
    const Outcome refused = convert(method, "--bucket", "0.5");
    EXPECT_EQ(refused.exit, 2) << method;
    EXPECT_NE(refused.error.find("fmm2"), std::string::npos) << refused.error;
    EXPECT_EQ(convert(method, "--mask", mask).exit, 2) << method;
  }
  for (const char* method : {"fmm", "fmm2", "cpm"}) {
    EXPECT_EQ(convert(method, "--bucket", "0.5").exit, 0) << method;
  }
}

TEST_F(Chart, WordsAreChecked) {
  EXPECT_EQ(run({"chart", cube_, "-o", chart_, "--methods", "exakt"}).exit, 2);
  EXPECT_EQ(run({"chart", cube_, "-o", folder_.path("chart.pdf")}).exit, 2);
  EXPECT_EQ(run({"chart", folder_.path("none.off"), "-o", chart_}).exit, 4);
}

TEST_F(Chart, ConvertWithinATolerance) {
  const std::string grid = folder_.path("cube.vdb");
  const Outcome made =
      run({"convert", cube_, "-o", grid, "--tolerance", "2%", "--json", "--quiet"});
  ASSERT_EQ(made.exit, 0) << made.error;
  const json result = json::parse(made.out);
  EXPECT_EQ(result["tolerance"], 0.02);
  EXPECT_LE(result["error"].get<double>(), 0.02);
  EXPECT_EQ(result["within"], true);
  EXPECT_GE(result["trials"].size(), 2U);
  const Outcome check = run({"compare", grid, cube_, "--json", "--quiet"});
  EXPECT_EQ(check.exit, 0) << check.error;
}

TEST_F(Chart, ConvertASceneWithinATolerance) {
  const std::string scene =
      folder_.write("scene.yaml", "sdfgrid: 1\nscene:\n  - sphere: {radius: 1}\n");
  const std::string grid = folder_.path("scene.vdb");
  const Outcome made =
      run({"convert", scene, "-o", grid, "--tolerance", "0.5%", "--json", "--quiet"});
  ASSERT_EQ(made.exit, 0) << made.error;
  const json result = json::parse(made.out);
  EXPECT_NEAR(result["tolerance"].get<double>(), 0.01, 1e-3);
  EXPECT_LE(result["error"].get<double>(), result["tolerance"].get<double>());
  EXPECT_EQ(result["method"], "field");
  EXPECT_EQ(run({"convert", scene, "-o", grid, "--force", "--tolerance", "1e-7", "--budget-s",
                 "0.5", "--quiet"})
                .exit,
            3);
}

TEST_F(Chart, AToleranceOutOfReachIsThreeAndTheBestIsWritten) {
  const std::string grid = folder_.path("cube.vdb");
  const Outcome made = run({"convert", cube_, "-o", grid, "--tolerance", "1e-9", "--budget-mb",
                            "60", "--json", "--quiet"});
  EXPECT_EQ(made.exit, 3) << made.error;
  EXPECT_EQ(json::parse(made.out)["within"], false);
  EXPECT_TRUE(std::ifstream(grid).good());
  for (const char* wrong : {"0", "-1", "1m", "%"}) {
    EXPECT_EQ(run({"convert", cube_, "-o", grid, "--force", "--tolerance", wrong}).exit, 2)
        << wrong;
  }
  EXPECT_EQ(run({"convert", cube_, "-o", grid, "--force", "--tolerance", "1", "--dim", "9"}).exit,
            2);
  EXPECT_EQ(run({"convert", cube_, "-o", grid, "--force", "--budget-s", "1"}).exit, 2);
}

}  // namespace
}  // namespace sdfgrid::test
