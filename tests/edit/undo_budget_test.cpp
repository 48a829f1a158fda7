// Undo brings back every bit, whether its records are in memory, compressed, in a store or
// forgotten.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "edit/grids.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/sculptor.h"

namespace sdfgrid {
namespace {

using namespace sdfgrid::test;
constexpr int kExtent = 32;

TEST(UndoBudget, UndoAndRedoAreExact) {
  const Grid grid = ball_grid(15);
  Sculptor sculptor(grid);
  std::vector<Content> states = {content_of(grid, kExtent)};
  for (const Stroke& stroke : random_strokes(8, 1)) {
    const StrokeReport report = sculptor.apply(stroke, Job());
    EXPECT_EQ(report.bricks_touched, sculptor.touched().size());
    states.push_back(content_of(grid, kExtent));
  }
  for (int i = 7; i >= 0; --i) {
    ASSERT_TRUE(sculptor.undo());
    ASSERT_EQ(content_of(grid, kExtent), states[i]) << i;
  }
  EXPECT_FALSE(sculptor.undo());
  for (int i = 1; i <= 8; ++i) {
    ASSERT_TRUE(sculptor.redo());
    ASSERT_EQ(content_of(grid, kExtent), states[i]) << i;
  }
  EXPECT_FALSE(sculptor.redo());
}

class MemoryStore : public UndoStore {
 public:
  std::size_t put(std::span<const std::byte> bytes) override {
    kept_.emplace_back(bytes.begin(), bytes.end());
    return kept_.size() - 1;
  }
  std::vector<std::byte> get(std::size_t name) override { return kept_.at(name); }
  void forget(std::size_t name) override { kept_.at(name).clear(); }
  [[nodiscard]] std::size_t size() const { return kept_.size(); }

 private:
  std::vector<std::vector<std::byte>> kept_;
};

TEST(UndoBudget, CompressedAndSpilledRecordsUndoExactly) {
  MemoryStore store;
  SculptOptions options;
  options.undo.full_bytes = 300000;
  options.undo.packed_bytes = 60000;
  options.undo.store = &store;
  const Grid grid = ball_grid(15);
  Sculptor sculptor(grid, options);
  const Content before = content_of(grid, kExtent);
  for (const Stroke& stroke : random_strokes(20, 2)) (void)sculptor.apply(stroke, Job());
  EXPECT_GT(store.size(), 2U);
  EXPECT_LT(sculptor.history().bytes(), 1000000U);
  const Content after = content_of(grid, kExtent);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(sculptor.undo()) << i;
  EXPECT_EQ(content_of(grid, kExtent), before);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(sculptor.redo()) << i;
  EXPECT_EQ(content_of(grid, kExtent), after);
}

// However long the way back: what was undone is compressed and spilled, too.
TEST(UndoBudget, UndoingAndRedoingStayWithinTheBudget) {
  MemoryStore store;
  SculptOptions options;
  options.undo.full_bytes = 200000;
  options.undo.packed_bytes = 50000;
  options.undo.store = &store;
  const Grid grid = ball_grid(15);
  Sculptor sculptor(grid, options);
  std::vector<Content> states = {content_of(grid, kExtent)};
  const std::vector<Stroke> strokes = random_strokes(16, 3);
  std::size_t largest = 0;
  for (const Stroke& stroke : strokes) {
    const StrokeReport report = sculptor.apply(stroke, Job());
    // Of a record whose vectors were grown once.
    largest = std::max(largest, 2 * 2300 * report.bricks_touched);
    states.push_back(content_of(grid, kExtent));
  }
  std::mt19937 random(5);
  std::size_t at = strokes.size();
  for (int step = 0; step < 100; ++step) {
    // Far in one direction, then in the other, with turns on the way.
    const bool back = step / 25 % 2 == 0 ? random() % 5 != 0 : random() % 5 == 0;
    if (back ? sculptor.undo() : sculptor.redo()) back ? --at : ++at;
    ASSERT_EQ(sculptor.history().undoable(), at);
    ASSERT_EQ(sculptor.history().redoable(), strokes.size() - at);
    ASSERT_EQ(content_of(grid, kExtent), states[at]) << step;
    ASSERT_LT(sculptor.history().bytes(), 250000 + largest) << step;
  }
}

// A store that takes no more costs old undo steps, not the stroke.
TEST(UndoBudget, AFullStoreForgetsTheOldest) {
  class FullStore : public MemoryStore {
   public:
    std::size_t put(std::span<const std::byte> bytes) override {
      if (size() == 3) throw Error(ErrorKind::failed, "full");
      return MemoryStore::put(bytes);
    }
  };
  FullStore store;
  SculptOptions options;
  options.undo.full_bytes = 1;
  options.undo.packed_bytes = 0;
  options.undo.store = &store;
  const Grid grid = ball_grid(15);
  Sculptor sculptor(grid, options);
  std::vector<Content> states = {content_of(grid, kExtent)};
  for (const Stroke& stroke : random_strokes(8, 2)) {
    (void)sculptor.apply(stroke, Job());
    states.push_back(content_of(grid, kExtent));
  }
  const std::size_t undoable = sculptor.history().undoable();
  EXPECT_LT(undoable, 8U);
  for (std::size_t i = 1; i <= undoable; ++i) {
    ASSERT_TRUE(sculptor.undo());
    ASSERT_EQ(content_of(grid, kExtent), states[8 - i]) << i;
  }
  EXPECT_FALSE(sculptor.undo());
}

TEST(UndoBudget, WithoutAStoreTheOldestAreForgotten) {
  SculptOptions options;
  options.undo.full_bytes = 200000;
  options.undo.packed_bytes = 60000;
  Sculptor sculptor(ball_grid(15), options);
  for (const Stroke& stroke : random_strokes(20, 2)) (void)sculptor.apply(stroke, Job());
  EXPECT_LT(sculptor.history().undoable(), 20U);
  EXPECT_GT(sculptor.history().undoable(), 2U);
}

}  // namespace
}  // namespace sdfgrid
