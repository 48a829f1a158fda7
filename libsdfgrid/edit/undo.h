// edit/undo.h: what strokes changed, so that they can be undone and redone to the last bit.
//
// A record holds the other state of each brick that its stroke changed: while the stroke stands,
// what was there before; once it is undone, what it made. Undo and redo exchange the two, so one
// copy is enough. Old records are compressed beyond a budget of memory, and beyond that handed to a
// store if there is one (a file, say: this room opens none itself), else forgotten.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "sdfgrid/edit/undo_pool.h"
#include "sdfgrid/grid/bricks.h"

namespace sdfgrid {

class UndoRecord {
 public:
  explicit UndoRecord(UndoPool& pool) : pool_(&pool) {}
  void reserve(std::size_t bricks);  // at most about so many are added
  // Adds the state of a brick as it is now, and says which of its samples change. Each brick once.
  void add(const BrickChange& change, const GridBrick& now);
  // More samples of brick i, in the order of add(), change.
  void add_samples(std::size_t i, const std::uint64_t (&samples)[kBrickWords]);
  // The same of its paint: GridBricks::paint().
  void add_paint(const glm::ivec3& brick, const std::int32_t* now);
  // Exchanges every brick's state with the grid's.
  void exchange(GridBricks& grid);

  // Of painted bricks no samples.
  [[nodiscard]] std::vector<BrickChange> changes() const;
  [[nodiscard]] std::size_t size() const { return states_.size() + painted_.size(); }
  [[nodiscard]] std::size_t bytes() const;  // of memory

  // The record as one block of bytes, compressed without loss, and back.
  [[nodiscard]] std::vector<std::byte> pack() const;
  [[nodiscard]] static UndoRecord unpack(std::span<const std::byte> packed, UndoPool& pool);

 private:
  struct State {
    BrickChange change;
    float constant;     // if it has no samples
    std::int32_t slot;  // of its samples, -1 for none
  };
  void store(State& state, const GridBrick& now);
  std::size_t add_slot();
  float* values(std::size_t slot) const {
    return chunks_[slot / UndoChunk::kSlots]->values[slot % UndoChunk::kSlots];
  }
  std::uint64_t* active(std::size_t slot) const {
    return chunks_[slot / UndoChunk::kSlots]->active[slot % UndoChunk::kSlots];
  }

  UndoPool* pool_;
  std::vector<State> states_;
  std::vector<UndoPool::Chunk> chunks_;
  std::size_t slots_ = 0;
  std::vector<State> painted_;
  std::vector<std::int32_t> materials_;  // kBrickSamples a slot
};

// Where records go that memory has no room for.
class UndoStore {
 public:
  virtual ~UndoStore() = default;
  // Keeps the bytes and returns a name for them. Throws Error{failed} if it cannot.
  virtual std::size_t put(std::span<const std::byte> bytes) = 0;
  // Gives them back. Throws Error{failed} if it cannot.
  [[nodiscard]] virtual std::vector<std::byte> get(std::size_t name) = 0;
  // They are not asked for again.
  virtual void forget(std::size_t name) = 0;
};

struct UndoOptions {
  // Of records as they are, 0: keep none. Those furthest from where undo and redo stand are
  // compressed, but for the nearest.
  std::size_t full_bytes = 256U << 20;
  // Of compressed ones; those furthest are spilled, or forgotten if that cannot be.
  std::size_t packed_bytes = 256U << 20;
  UndoStore* store = nullptr;  // must outlive the history
};

// The strokes that can be undone and those that can be redone.
class UndoHistory {
 public:
  explicit UndoHistory(const UndoOptions& options = {}) : options_(options) {}

  [[nodiscard]] UndoRecord new_record() { return UndoRecord(pool_); }

  // A new stroke: what could be redone is gone. If it throws, the record is untouched.
  void push(UndoRecord&& record);
  // Exchange the last stroke (the last undone one) with the grid and return what changed; nothing
  // happens, and nothing is returned, if there is none.
  std::vector<BrickChange> undo(GridBricks& grid);
  std::vector<BrickChange> redo(GridBricks& grid);
  // The same as undo(), but as if the stroke had not been: it cannot be redone.
  std::vector<BrickChange> take_back(GridBricks& grid);

  [[nodiscard]] std::size_t undoable() const { return done_; }
  [[nodiscard]] std::size_t redoable() const { return entries_.size() - done_; }
  [[nodiscard]] std::size_t bytes() const;  // of memory

 private:
  enum class Where { full, packed, spilled };
  struct Entry {
    Where where = Where::full;
    std::optional<UndoRecord> record;  // where it is full
    std::vector<std::byte> packed;
    std::size_t name = 0;
  };
  std::vector<BrickChange> exchange(Entry& entry, GridBricks& grid);
  void keep_within_budget();
  bool keep(Entry& entry, bool nearest, std::size_t& full, std::size_t& packed);
  bool spill(Entry& entry);
  void forget(std::size_t begin, std::size_t end);

  UndoOptions options_;
  UndoPool pool_;
  std::deque<Entry> entries_;  // oldest first
  std::size_t done_ = 0;       // the first so many of them stand
};

}  // namespace sdfgrid
