#include "sdfgrid/edit/undo_pool.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <new>

#include "sdfgrid/core/memory.h"

namespace sdfgrid {
namespace {

constexpr std::size_t kSlabBytes = std::size_t{1} << 21;  // a large page

// What stands in a chunk that was given back.
struct FreeChunk {
  FreeChunk* next;
};

}  // namespace

// Lies at the start of a large page; a chunk finds its slab by its address.
struct UndoPool::Slab {
  static constexpr std::size_t kHead = 64;
  static constexpr std::size_t kMost = (kSlabBytes - kHead) / sizeof(UndoChunk);

  UndoPool* pool;
  std::size_t begun = 0;      // chunks before this one were handed out once
  std::size_t used = 0;       // so many are now
  FreeChunk* free = nullptr;  // given back

  [[nodiscard]] bool has_room() const { return used < kMost; }
  UndoChunk* chunk(std::size_t i) {
    return reinterpret_cast<UndoChunk*>(reinterpret_cast<char*>(this) + kHead) + i;
  }
};

UndoPool::UndoPool() { static_assert(sizeof(Slab) <= Slab::kHead); }

UndoPool::~UndoPool() {
  for (Slab* slab : with_room_) {
    assert(slab->used == 0);
    std::free(slab);
  }
}

UndoPool::Chunk UndoPool::take() {
  if (with_room_.empty()) {
    with_room_.reserve(slabs_ + 1);  // give() must not throw
    void* memory = std::aligned_alloc(kSlabBytes, kSlabBytes);
    if (memory == nullptr) throw std::bad_alloc();
    prefer_large_pages(memory, kSlabBytes);
    with_room_.push_back(new (memory) Slab{this});
    ++slabs_;
  }
  Slab& slab = *with_room_.back();
  UndoChunk* chunk = nullptr;
  if (slab.free != nullptr) {
    chunk = reinterpret_cast<UndoChunk*>(slab.free);
    slab.free = slab.free->next;
  } else {
    chunk = slab.chunk(slab.begun++);
  }
  ++slab.used;
  if (!slab.has_room()) with_room_.pop_back();
  return Chunk(chunk);
}

// A slab without chunks goes back to the system unless it is the last one with room.
void UndoPool::give(Slab* slab, UndoChunk* chunk) {
  if (!slab->has_room()) with_room_.push_back(slab);
  slab->free = new (chunk) FreeChunk{slab->free};
  --slab->used;
  if (slab->used > 0 || with_room_.size() == 1) return;
  with_room_.erase(std::find(with_room_.begin(), with_room_.end(), slab));
  std::free(slab);
  --slabs_;
}

void UndoPool::GiveBack::operator()(UndoChunk* chunk) const {
  const auto address = reinterpret_cast<std::uintptr_t>(chunk);
  auto* slab = reinterpret_cast<Slab*>(address & ~(kSlabBytes - 1));
  slab->pool->give(slab, chunk);
}

}  // namespace sdfgrid
