// Grids and scenes as brushes: against closed forms and OpenVDB's CSG, and in sessions that outlive
// the files.
#include "sdfgrid/scene/stamp.h"

#include <gtest/gtest.h>
#include <openvdb/tools/Composite.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "app/process.h"
#include "edit/grids.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/sculptor.h"
#include "sdfgrid/edit/session.h"
#include "sdfgrid/edit/stroke_file.h"
#include "sdfgrid/grid/vdb.h"

namespace sdfgrid {
namespace {

using namespace sdfgrid::test;
namespace fs = std::filesystem;
constexpr int kExtent = 30;

// A bar of 30 x 6 x 6 voxels of 0.1 whose middle is at (8, 0, 0): no symmetry hides a mistake.
Grid bar_grid(double voxel = 0.1) {
  return make_grid(
      [voxel](const glm::dvec3& p) {
        const double s = 0.1 / voxel;
        const glm::dvec3 q = glm::abs(p - glm::dvec3(8 * s, 0, 0)) - glm::dvec3(15, 3, 3) * s;
        return glm::length(glm::max(q, glm::dvec3(0))) + std::min(std::max({q.x, q.y, q.z}), 0.0);
      },
      static_cast<int>(27 * 0.1 / voxel), voxel);
}

class Stamps : public ::testing::Test {
 protected:
  Stroke stroke(const std::string& text) {
    return parse_stroke(text, "test", {&stamps_, folder_.path(""), false});
  }
  Folder folder_;
  Job job_;
  FileStamps stamps_{job_};
};

TEST_F(Stamps, OnItsOwnLatticeAGridIsCombinedAsOpenVdbCombinesIt) {
  write_grid(bar_grid(), folder_.path("bar.vdb"));
  for (const bool unite : {true, false}) {
    const Grid grid = ball_grid(12);
    const Grid expected = grid.clone();
    const Grid other = bar_grid();
    if (unite) {
      openvdb::tools::csgUnion(*vdb(expected), *vdb(other));
    } else {
      openvdb::tools::csgDifference(*vdb(expected), *vdb(other));
    }
    SculptOptions options;
    options.redistance = Redistance::off;
    Sculptor sculptor(grid, options);
    (void)sculptor.apply(stroke(std::string("{op: ") + (unite ? "stamp" : "difference") +
                                ", brush: {grid: {file: bar.vdb}}, path: [[0, 0, 0]]}"),
                         Job());
    const Content got = content_of(grid, kExtent);
    const Content want = content_of(expected, kExtent);
    for (std::size_t i = 0; i < got.size(); ++i) {
      ASSERT_NEAR(got[i].first, want[i].first, 1e-6) << i << " " << unite;
    }
  }
}

// Turned, moved, scaled, beside other shapes, mirrored: against the box itself.
TEST_F(Stamps, AGridIsAPartOfABrush) {
  write_grid(bar_grid(), folder_.path("bar.vdb"));
  const Grid grid = ball_grid(3);
  Sculptor sculptor(grid);
  (void)sculptor.apply(
      stroke("{op: union, brush: {union: [{sphere: {radius: 0.2}}, {rotate: {by: [0, 0, 90], of: "
             "{grid: {file: bar.vdb}}}}]}, path: [[1, 0, 0]], mirror: [y]}"),
      Job());
  // The bar's middle is now at (10, 8, 0) and, mirrored, at (10, -8, 0): together 46 long in y.
  for (int y = -30; y <= 30; ++y) {
    for (int x = 5; x <= 15; ++x) {
      const glm::dvec3 q(std::abs(x - 10) - 3.0, std::abs(y) - 23.0, 0 - 3.0);
      const double truth =
          glm::length(glm::max(q, glm::dvec3(0))) + std::min(std::max({q.x, q.y, q.z}), 0.0);
      // Trilinear interpolation rounds the bar's edges off.
      if (std::abs(q.y) < 4 && q.x > -3) continue;
      ASSERT_NEAR(grid.value({x, y, 0}) / 0.1, glm::clamp(truth, -3.0, 3.0), 0.1) << x << " " << y;
    }
  }
}

TEST_F(Stamps, AStampIsPutDownAtThePointsAlone) {
  write_grid(ball_grid(3), folder_.path("ball.vdb"));
  const Grid grid = ball_grid(10);
  Sculptor sculptor(grid);
  const StrokeReport report = sculptor.apply(
      stroke("{op: stamp, brush: {grid: {file: ball.vdb}}, path: [[1.5, 0, 0], [0, 1.5, 0]]}"),
      Job());
  EXPECT_EQ(report.dabs, 2U);
  EXPECT_LT(grid.value({15, 0, 0}), 0);
  EXPECT_LT(grid.value({0, 15, 0}), 0);
  EXPECT_GT(grid.value({8, 8, 0}), 0);  // between the two
}

// A band in the stamp that is narrower than the grid's says less than the grid needs: what it does
// not know is measured, never taken for a distance.
TEST_F(Stamps, AFinerStampHasItsDistancesMeasured) {
  write_grid(ball_grid(24, 0.05), folder_.path("fine.vdb"));  // 12 voxels of the grid
  const Grid grid = ball_grid(12);
  Sculptor sculptor(grid);
  (void)sculptor.apply(stroke("{op: union, brush: {grid: {file: fine.vdb}}, path: [[1.4, 0, 0]]}"),
                       Job());
  const TwoBalls balls{{0, 0, 0}, {14, 0, 0}, 12, 12};
  double worst = 0;
  for (int x = -20; x <= 30; ++x) {
    for (int y = -20; y <= 20; ++y) {
      for (int z = -20; z <= 20; ++z) {
        const glm::dvec3 p(x, y, z);
        const double truth = balls.unite(p);
        const double got = grid.value({x, y, z}) / 0.1;
        if (std::abs(truth) > 0.05) {
          ASSERT_EQ(got < 0, truth < 0) << x << " " << y << " " << z;
        }
        if (balls.to_crease(p) < std::abs(truth) + 2) continue;
        worst = std::max(worst, std::abs(got - glm::clamp(truth, -3.0, 3.0)));
      }
    }
  }
  EXPECT_LT(worst, 0.05);
}

// One whose solid lies far from its origin costs what the solid costs.
TEST_F(Stamps, FarFromItsOriginItIsNoLarger) {
  (void)folder_.write("far.yaml",
                      "sdfgrid: 1\nscene: [{sphere: {radius: 0.4}, at: [200, 0, 0]}]\n");
  const Grid grid = ball_grid(12);
  Sculptor sculptor(grid);
  const StrokeReport report = sculptor.apply(
      stroke("{op: difference, brush: {scene: {file: far.yaml}}, path: [[-198.8, 0, 0]]}"), Job());
  EXPECT_TRUE(report.warnings.empty());
  const TwoBalls balls{{0, 0, 0}, {12, 0, 0}, 12, 4};
  for (int x = 0; x <= 20; ++x) {
    // Scenes are read in single precision: 200 to the last of 24 bits is 2e-5.
    EXPECT_NEAR(grid.value({x, 0, 0}) / 0.1, glm::clamp(balls.subtract({x, 0, 0}), -3.0, 3.0), 1e-3)
        << x;
  }
}

TEST_F(Stamps, RefusesWithThePlaceAndTheRemedy) {
  write_grid(bar_grid(), folder_.path("bar.vdb"));
  (void)folder_.write("bad.yaml", "sdfgrid: 1\nscene: [{grid: {file: missing.vdb}}]\n");
  (void)folder_.write("endless.yaml", "sdfgrid: 1\nscene: [{plane: {normal: [0, 0, 1]}}]\n");
  const auto refused = [&](const std::string& op, const std::string& brush,
                           const std::string& why) {
    try {
      (void)stroke("{op: " + op + ", brush: " + brush + ", path: [[0, 0, 0]]}");
      FAIL() << "not refused: " << brush;
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::input);
      EXPECT_NE(std::string(e.what()).find(why), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("test: line 1"), std::string::npos) << e.what();
    }
  };
  refused("stamp", "{grid: {file: nothing.vdb}}", "nothing.vdb");
  refused("stamp", "{grid: {file: bar.vdb, size: 3}}", "nothing else");
  refused("stamp", "{grid: bar.vdb}", "as in {grid: {file: name.vdb}}");
  refused("stamp", "{sphere: {radius: 1}}", "a grid or a scene");
  refused("union", "{scene: {file: bad.yaml}}", "missing.vdb");
  refused("union", "{scene: {file: endless.yaml}}", "no end");
  EXPECT_THROW(
      (void)parse_stroke("{op: stamp, brush: {grid: {file: bar.vdb}}, path: [[0,0,0]]}", "test"),
      Error);
}

// The scene names a grid in another folder; the session keeps both.
class StampSession : public Stamps {
 protected:
  void SetUp() override {
    fs::create_directories(folder_.path("parts"));
    write_grid(bar_grid(), folder_.path("parts/bar.vdb"));
    (void)folder_.write("cross.yaml",
                        "sdfgrid: 1\nscene:\n  - grid: {file: parts/bar.vdb}\n"
                        "  - grid: {file: parts/bar.vdb}\n    rotate: [0, 90, 0]\n");
    (void)folder_.write("strokes.yaml",
                        "sdfgrid-strokes: 1\nstrokes:\n"
                        "  - {op: stamp, brush: {scene: {file: cross.yaml}}, path: [[0, 1, 0]]}\n"
                        "  - {op: difference, brush: {rotate: {by: [30, 0, 0], of: {grid: {file: "
                        "parts/bar.vdb}}}}, path: [[0.3, 0, 0.8]]}\n");
    create_session(session_, ball_grid(12), Redistance::local);
    options_.stamps = &stamps_;
  }
  // What the strokes make without a session.
  Content expected() {
    const Grid grid = ball_grid(12);
    SculptOptions options;
    options.range = Sculptor(grid).range();
    Sculptor sculptor(grid, options);
    for (const Stroke& s : read_strokes(folder_.path("strokes.yaml"), &stamps_).strokes) {
      (void)sculptor.apply(s, Job());
    }
    return content_of(grid, kExtent);
  }
  void apply_all() {
    Session session(session_, options_, Job());
    for (const Stroke& s : read_strokes(folder_.path("strokes.yaml"), &stamps_).strokes) {
      (void)session.apply(s, Job());
      EXPECT_EQ(session.strokes().back(), session.recorded_text(s));
    }
  }
  std::string session_ = folder_.path("session");
  SessionOptions options_;
};

TEST_F(StampSession, OutlivesTheFiles) {
  const Content want = expected();
  apply_all();
  fs::remove(folder_.path("cross.yaml"));
  write_grid(ball_grid(5), folder_.path("parts/bar.vdb"));
  FileStamps fresh(job_);
  options_.stamps = &fresh;
  Session session(session_, options_, Job());
  EXPECT_EQ(content_of(session.grid(), kExtent), want);
  EXPECT_EQ(session.undo(2, Job()), 2U);
  EXPECT_EQ(session.redo(2, Job()), 2U);
  EXPECT_EQ(content_of(session.grid(), kExtent), want);
}

TEST_F(StampSession, KeepsEachFileOnce) {
  apply_all();
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(session_ + "/stamps")) {
    count += entry.is_regular_file() ? 1 : 0;
  }
  EXPECT_EQ(count, 2U);  // the scene and the bar
}

// Asking what would be recorded makes no copies, in a session that is only read neither.
TEST_F(StampSession, TheRecordedTextIsAskedForWithoutCopies) {
  const Stroke s = stroke("{op: stamp, brush: {grid: {file: parts/bar.vdb}}, path: [[0, 1, 0]]}");
  options_.read_only = true;
  const Session session(session_, options_, Job());
  EXPECT_NE(session.recorded_text(s).find("stamps/"), std::string::npos);
  EXPECT_FALSE(fs::exists(session_ + "/stamps"));
}

// What takes the place of a stamp may not fit, but a text without stamps that cannot be read is not
// recorded.
TEST_F(StampSession, OnlyTextsThatAreReadAgainAreRecordable) {
  EXPECT_NO_THROW(check_recordable("{op: stamp, brush: {grid: {file: a.vdb}}, path: [[0, 0, 0]]}"));
  EXPECT_NO_THROW(
      check_recordable("{op: union, brush: {twist: {turns: 9, of: {scale: {by: 1e9, of: {scene: "
                       "{file: a.yaml}}}}}}, "
                       "path: [[0, 0, 0]]}"));
  for (const char* text :
       {"{op: unoin, brush: {sphere: {radius: 1}}, path: [[0, 0, 0]]}",
        "{op: union, brush: {sphere: {radius: -1}}, path: [[0, 0, 0]]}",
        "{op: union, brush: {sphere: {radius: 1}}, path: [[0, 0, 0]], pat: 1}"}) {
    EXPECT_THROW(check_recordable(text), Error) << text;
  }
}

TEST_F(StampSession, AChangedCopyIsRefused) {
  apply_all();
  for (const auto& entry : fs::directory_iterator(session_ + "/stamps")) {
    if (entry.path().extension() == ".vdb") write_grid(ball_grid(5), entry.path().string());
  }
  FileStamps fresh(job_);
  options_.stamps = &fresh;
  try {
    const Session session(session_, options_, Job());
    FAIL() << "a changed stamp was taken";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::input);
    EXPECT_NE(std::string(e.what()).find("record 1"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("not the stamp that was kept"), std::string::npos);
  }
}

// Between its reading and its keeping the file was written over: nothing is recorded.
TEST_F(StampSession, AFileThatChangesMeanwhileIsNotRecorded) {
  Session session(session_, options_, Job());
  const Stroke s = stroke("{op: stamp, brush: {grid: {file: parts/bar.vdb}}, path: [[0, 1, 0]]}");
  write_grid(ball_grid(5), folder_.path("parts/bar.vdb"));
  EXPECT_THROW((void)session.apply(s, Job()), Error);
  EXPECT_TRUE(session.strokes().empty());
  EXPECT_EQ(content_of(session.grid(), kExtent), content_of(ball_grid(12), kExtent));
}

}  // namespace
}  // namespace sdfgrid
