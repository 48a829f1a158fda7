// Memory for undo: chunks are apart from each other, keep what is in them, and are used again.
#include "sdfgrid/edit/undo_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

namespace sdfgrid {
namespace {

struct Held {
  UndoPool::Chunk chunk;
  float mark;

  void fill() const {
    for (auto& slot : chunk->values) std::fill(std::begin(slot), std::end(slot), mark);
    for (auto& slot : chunk->active) {
      std::fill(std::begin(slot), std::end(slot), static_cast<std::uint64_t>(mark));
    }
  }
  [[nodiscard]] bool is_whole() const {
    bool whole = true;
    for (const auto& slot : chunk->values) {
      for (const float value : slot) whole = whole && value == mark;
    }
    for (const auto& slot : chunk->active) {
      for (const std::uint64_t word : slot) whole = whole && word == std::uint64_t(mark);
    }
    return whole;
  }
};

TEST(UndoPool, ChunksAreApartAndKeepWhatIsInThem) {
  UndoPool pool;
  std::vector<Held> held;
  std::mt19937 random(3);
  float mark = 1;
  // More and fewer by turns, over several of the pool's pages.
  for (const std::size_t goal : {700U, 40U, 1200U, 0U, 300U}) {
    while (held.size() < goal) {
      held.push_back({pool.take(), mark++});
      held.back().fill();
    }
    while (held.size() > goal) {
      std::swap(held[random() % held.size()], held.back());
      ASSERT_TRUE(held.back().is_whole());
      held.pop_back();
    }
    for (const Held& one : held) ASSERT_TRUE(one.is_whole()) << one.mark;
  }
}

TEST(UndoPool, ChunksAreUsedAgain) {
  UndoPool pool;
  std::set<const UndoChunk*> places;
  for (int i = 0; i < 100; ++i) places.insert(pool.take().get());
  EXPECT_EQ(places.size(), 1U);
}

}  // namespace
}  // namespace sdfgrid
