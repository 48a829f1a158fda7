// Undo and redo restore every byte of a grid's file, whatever the op and the brush.
#include <gtest/gtest.h>

#include <fstream>
#include <new>
#include <sstream>

#include "app/process.h"
#include "edit/grids.h"
#include "sdfgrid/edit/sculptor.h"
#include "sdfgrid/edit/stroke_file.h"
#include "sdfgrid/grid/bricks.h"
#include "sdfgrid/scene/stamp.h"

namespace sdfgrid {
namespace {

using namespace sdfgrid::test;

class Undo : public ::testing::Test {
 protected:
  void SetUp() override {
    write_grid(ball_grid(4), folder_.path("ball.vdb"));
    (void)folder_.write("pair.yaml",
                        "sdfgrid: 1\nscene:\n  - sphere: {radius: 0.4}\n"
                        "  - box: {size: 0.5}\n    at: [0.3, 0.2, 0]\n");
  }
  std::string bytes_of(const Grid& grid) {
    const Grid copy = grid.clone();
    compact(copy);
    write_grid(copy, folder_.path("bytes.vdb"));
    std::stringstream bytes;
    bytes << std::ifstream(folder_.path("bytes.vdb"), std::ios::binary).rdbuf();
    return bytes.str();
  }
  // One line of flow style without the braces around it.
  Stroke stroke(const std::string& text) {
    return parse_stroke("{" + text + "}", "test", {&stamps_, folder_.path(""), false});
  }
  void expect_exact(Redistance redistance);

  Folder folder_;
  Job job_;
  FileStamps stamps_{job_};
};

const char* const kOps[] = {"union",   "difference", "intersection", "inflate", "deflate",
                            "flatten", "smooth",     "pinch",        "paint"};
const char* const kBrushes[] = {
    "{sphere: {radius: 0.5}}",
    "{box: {size: [0.8, 0.6, 1]}}",
    "{formula: {f: 'x^2 + y^2 + z^2 - 0.25', bounds: [[-1, -1, -1], [1, 1, 1]]}}",
    "{twist: {turns: 0.3, of: {box: {size: [1, 0.5, 1]}}}}",
    "{grid: {file: ball.vdb}}",
    "{scene: {file: pair.yaml}}",
    "{rotate: {by: [20, 0, 40], of: {grid: {file: ball.vdb}}}}"};
const char* const kWays[] = {
    "path: [[0.61, 0.33, 0.72]]",
    // Swept or spaced, under falling pressure.
    "path: [[0.6, 0, 0.8], [0, 0.6, 0.8, 0.6], [-0.5, 0.6, 0.6, 0.4]], spacing: 0.5",
    "path: [[0.61, 0.33, 0.72, 0.8]], mirror: [x, {y: 0.1}]"};

void Undo::expect_exact(Redistance redistance) {
  SculptOptions options;
  options.redistance = redistance;
  const Grid grid = ball_grid(10);
  Sculptor sculptor(grid, options);
  const std::string base = bytes_of(grid);
  int tried = 0;
  for (const std::string op : kOps) {
    std::vector<Stroke> strokes;
    for (const std::string brush : kBrushes) {
      const std::string text = "op: " + op + ", brush: " + brush + ", " + kWays[tried++ % 3] +
                               (op == "paint" ? ", material: 3" : "");
      strokes.push_back(stroke(text));
      EXPECT_GT(sculptor.apply(strokes.back(), job_).bricks_touched, 0U) << text;
      const std::string after = bytes_of(grid);
      ASSERT_TRUE(after != base) << text;
      ASSERT_TRUE(sculptor.undo());
      ASSERT_TRUE(bytes_of(grid) == base) << text;
      ASSERT_TRUE(sculptor.redo());
      ASSERT_TRUE(bytes_of(grid) == after) << text;
      ASSERT_TRUE(sculptor.undo());
    }
    // One upon the other.
    if (op == "intersection" || op == "flatten") continue;  // too little may be left for the next
    for (const Stroke& each : strokes) (void)sculptor.apply(each, job_);
    const std::string last = bytes_of(grid);
    while (sculptor.undo()) continue;
    ASSERT_TRUE(bytes_of(grid) == base) << op;
    while (sculptor.redo()) continue;
    ASSERT_TRUE(bytes_of(grid) == last) << op;
    while (sculptor.undo()) continue;
  }
}

TEST_F(Undo, RestoresTheFileOfEveryOpAndBrush) { expect_exact(Redistance::local); }
TEST_F(Undo, WithoutReDistancingToo) { expect_exact(Redistance::off); }

// Memory or a disk that is full costs old strokes their undo, never the stroke that is made.
TEST_F(Undo, AStoreThatFailsHarmsNoStroke) {
  struct Broken : UndoStore {
    std::size_t put(std::span<const std::byte> /*bytes*/) override { throw std::bad_alloc(); }
    std::vector<std::byte> get(std::size_t /*name*/) override { return {}; }
    void forget(std::size_t /*name*/) override {}
  } broken;
  SculptOptions options;
  options.undo = {1, 1, &broken};
  const Grid grid = ball_grid(12);
  const Grid other = ball_grid(12);
  Sculptor sculptor(grid, options);
  Sculptor reference(other);
  for (const char* at : {"[1.2, 0, 0]", "[0, 1.2, 0]", "[0, 0, 1.2]"}) {
    const Stroke s =
        stroke(std::string("op: union, brush: {sphere: {radius: 0.4}}, path: [") + at + "]");
    EXPECT_NO_THROW((void)sculptor.apply(s, Job()));
    (void)reference.apply(s, Job());
    EXPECT_TRUE(bytes_of(grid) == bytes_of(other)) << at;
  }
  EXPECT_EQ(sculptor.history().undoable(), 1U);
}

}  // namespace
}  // namespace sdfgrid
