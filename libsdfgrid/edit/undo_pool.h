// edit/undo_pool.h: memory for the samples that undo keeps, from large pages: the first touch of
// small ones takes longer than the copy that is kept there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "sdfgrid/grid/bricks.h"

namespace sdfgrid {

// The samples and states of some bricks, so that a record grows without being copied and without
// memory that it does not need.
struct UndoChunk {
  static constexpr std::size_t kSlots = 4;
  float values[kSlots][kBrickSamples];
  std::uint64_t active[kSlots][kBrickWords];
};

// Hands out chunks and takes them back; must outlive them. For one thread at a time.
class UndoPool {
 public:
  struct GiveBack {
    void operator()(UndoChunk* chunk) const;
  };
  using Chunk = std::unique_ptr<UndoChunk, GiveBack>;

  UndoPool();
  UndoPool(const UndoPool&) = delete;
  UndoPool& operator=(const UndoPool&) = delete;
  ~UndoPool();

  // Its contents are not set.
  [[nodiscard]] Chunk take();

 private:
  struct Slab;
  void give(Slab* slab, UndoChunk* chunk);

  std::size_t slabs_ = 0;
  std::vector<Slab*> with_room_;  // those that have free chunks, in no order
};

}  // namespace sdfgrid
