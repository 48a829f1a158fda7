#include "sdfgrid/edit/undo.h"

#include <blosc.h>

#include <algorithm>
#include <cstring>
#include <exception>

#include "sdfgrid/core/error.h"

namespace sdfgrid {
namespace {

void append(std::vector<std::byte>& out, const void* data, std::size_t size) {
  if (size == 0) return;
  out.resize(out.size() + size);
  std::memcpy(out.data() + (out.size() - size), data, size);
}

std::uint64_t take_number(std::span<const std::byte>& in) {
  std::uint64_t value = 0;
  std::memcpy(&value, in.data(), sizeof value);
  in = in.subspan(sizeof value);
  return value;
}

// Pieces below what blosc takes at once.
constexpr std::size_t kPiece = std::size_t{1} << 24;

template <class T>
void pack_vector(const std::vector<T>& values, std::vector<std::byte>& out) {
  const std::uint64_t size = values.size() * sizeof(T);
  append(out, &size, sizeof size);
  std::vector<std::byte> piece(std::min<std::size_t>(kPiece, size) + BLOSC_MAX_OVERHEAD);
  for (std::size_t at = 0; at < size; at += kPiece) {
    const std::size_t count = std::min<std::size_t>(kPiece, size - at);
    const int packed =
        blosc_compress_ctx(5, BLOSC_SHUFFLE, std::min<std::size_t>(sizeof(T), 4), count,
                           reinterpret_cast<const std::byte*>(values.data()) + at, piece.data(),
                           piece.size(), BLOSC_LZ4_COMPNAME, 0, 1);
    if (packed <= 0) throw Error(ErrorKind::failed, "an undo record could not be compressed");
    const auto length = static_cast<std::uint64_t>(packed);
    append(out, &length, sizeof length);
    append(out, piece.data(), length);
  }
}

template <class T>
std::vector<T> unpack_vector(std::span<const std::byte>& in) {
  const std::uint64_t size = take_number(in);
  std::vector<T> values(size / sizeof(T));
  for (std::size_t at = 0; at < size; at += kPiece) {
    const std::uint64_t length = take_number(in);
    if (blosc_decompress_ctx(in.data(), reinterpret_cast<std::byte*>(values.data()) + at, size - at,
                             1) < 0) {
      throw Error(ErrorKind::failed, "an undo record is damaged");
    }
    in = in.subspan(length);
  }
  return values;
}

}  // namespace

void UndoRecord::reserve(std::size_t bricks) { states_.reserve(bricks); }

std::size_t UndoRecord::add_slot() {
  if (slots_ % UndoChunk::kSlots == 0) chunks_.push_back(pool_->take());
  return slots_++;
}

void UndoRecord::store(State& state, const GridBrick& now) {
  state.slot = -1;
  state.constant = now.constant;
  if (now.values == nullptr) return;
  const std::size_t slot = add_slot();
  state.slot = static_cast<std::int32_t>(slot);
  std::copy(now.values, now.values + kBrickSamples, values(slot));
  std::copy(now.active, now.active + kBrickWords, active(slot));
}

void UndoRecord::add(const BrickChange& change, const GridBrick& now) {
  states_.push_back({change, 0, -1});
  store(states_.back(), now);
}

void UndoRecord::add_samples(std::size_t i, const std::uint64_t (&samples)[kBrickWords]) {
  for (int x = 0; x < kBrickWords; ++x) states_[i].change.samples[x] |= samples[x];
}

void UndoRecord::add_paint(const glm::ivec3& brick, const std::int32_t* now) {
  State state{{brick, {}}, 0, -1};
  if (now != nullptr) {
    state.slot = static_cast<std::int32_t>(materials_.size() / kBrickSamples);
    materials_.insert(materials_.end(), now, now + kBrickSamples);
  }
  painted_.push_back(state);
}

void UndoRecord::exchange(GridBricks& grid) {
  UndoRecord other(*pool_);
  other.reserve(states_.size());
  for (const State& state : states_) other.add(state.change, grid.find(state.change.brick));
  for (const State& state : states_) {
    if (state.slot < 0) {
      grid.drop(state.change.brick, state.constant);
      continue;
    }
    const GridBrick brick = grid.make_unset(state.change.brick);
    const auto slot = static_cast<std::size_t>(state.slot);
    std::copy(values(slot), values(slot) + kBrickSamples, brick.values);
    std::copy(active(slot), active(slot) + kBrickWords, brick.active);
  }
  grid.finish();
  for (const State& state : painted_) {
    const glm::ivec3& brick = state.change.brick;
    other.add_paint(brick, grid.paint(brick));
  }
  for (const State& state : painted_) {
    const std::size_t first = std::size_t(std::max(state.slot, 0)) * kBrickSamples;
    grid.set_paint(state.change.brick, state.slot < 0 ? nullptr : materials_.data() + first);
  }
  *this = std::move(other);
}

std::vector<BrickChange> UndoRecord::changes() const {
  std::vector<BrickChange> all;
  all.reserve(size());
  for (const State& state : states_) all.push_back(state.change);
  for (const State& state : painted_) all.push_back(state.change);
  return all;
}

std::size_t UndoRecord::bytes() const {
  return sizeof *this + states_.capacity() * sizeof(State) +
         chunks_.size() * (sizeof(UndoChunk) + sizeof chunks_[0]) +
         painted_.capacity() * sizeof(State) + materials_.capacity() * sizeof(std::int32_t);
}

std::vector<std::byte> UndoRecord::pack() const {
  std::vector<std::byte> out;
  std::vector<float> all_values;
  std::vector<std::uint64_t> all_active;
  for (std::size_t i = 0; i < slots_; ++i) {
    all_values.insert(all_values.end(), values(i), values(i) + kBrickSamples);
    all_active.insert(all_active.end(), active(i), active(i) + kBrickWords);
  }
  pack_vector(states_, out);
  pack_vector(all_values, out);
  pack_vector(all_active, out);
  pack_vector(painted_, out);
  pack_vector(materials_, out);
  out.shrink_to_fit();
  return out;
}

UndoRecord UndoRecord::unpack(std::span<const std::byte> packed, UndoPool& pool) {
  UndoRecord record(pool);
  record.states_ = unpack_vector<State>(packed);
  const auto all_values = unpack_vector<float>(packed);
  const auto all_active = unpack_vector<std::uint64_t>(packed);
  for (std::size_t at = 0; at < all_values.size() / kBrickSamples; ++at) {
    const std::size_t slot = record.add_slot();
    std::copy_n(all_values.data() + at * kBrickSamples, kBrickSamples, record.values(slot));
    std::copy_n(all_active.data() + at * kBrickWords, kBrickWords, record.active(slot));
  }
  record.painted_ = unpack_vector<State>(packed);
  record.materials_ = unpack_vector<std::int32_t>(packed);
  return record;
}

void UndoHistory::push(UndoRecord&& record) {
  if (options_.full_bytes == 0) return forget(done_, entries_.size());
  entries_.emplace_back();  // nothing behind this fails
  entries_.back().record = std::move(record);
  forget(done_, entries_.size() - 1);
  ++done_;
  keep_within_budget();
}

std::vector<BrickChange> UndoHistory::exchange(Entry& entry, GridBricks& grid) {
  if (entry.where == Where::spilled) {
    entry.packed = options_.store->get(entry.name);
    options_.store->forget(entry.name);
    entry.where = Where::packed;
  }
  if (entry.where == Where::packed) entry.record = UndoRecord::unpack(entry.packed, pool_);
  entry.packed = std::vector<std::byte>();  // {} would keep the memory
  entry.where = Where::full;
  entry.record->exchange(grid);
  return entry.record->changes();
}

std::vector<BrickChange> UndoHistory::undo(GridBricks& grid) {
  if (done_ == 0) return {};
  const std::vector<BrickChange> changes = exchange(entries_[done_ - 1], grid);
  --done_;
  keep_within_budget();
  return changes;
}

std::vector<BrickChange> UndoHistory::redo(GridBricks& grid) {
  if (done_ == entries_.size()) return {};
  const std::vector<BrickChange> changes = exchange(entries_[done_], grid);
  ++done_;
  keep_within_budget();
  return changes;
}

std::vector<BrickChange> UndoHistory::take_back(GridBricks& grid) {
  const std::vector<BrickChange> changes = undo(grid);
  forget(done_, entries_.size());
  return changes;
}

std::size_t UndoHistory::bytes() const {
  std::size_t sum = 0;
  for (const Entry& entry : entries_) {
    sum += entry.where == Where::full ? entry.record->bytes() : entry.packed.capacity();
  }
  return sum;
}

void UndoHistory::forget(std::size_t begin, std::size_t end) {
  const auto first = entries_.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto last = entries_.begin() + static_cast<std::ptrdiff_t>(end);
  for (auto entry = first; entry != last; ++entry) {
    if (entry->where == Where::spilled) options_.store->forget(entry->name);
  }
  entries_.erase(first, last);
}

// From where undo and redo stand outwards, turn by turn.
void UndoHistory::keep_within_budget() {
  std::size_t full = 0;
  std::size_t packed = 0;
  std::size_t before = done_;  // the entries [before, after) are seen to
  std::size_t after = done_;
  while (before > 0 || after < entries_.size()) {
    const bool back = after == entries_.size() || (before > 0 && done_ - before <= after - done_);
    const std::size_t at = back ? before - 1 : after;
    if (keep(entries_[at], before == after, full, packed)) {
      (back ? before : after) = back ? at : at + 1;
    } else if (back) {  // what lies behind cannot be reached any more
      forget(0, before);
      done_ -= before;
      after -= before;
      before = 0;
    } else {
      forget(at, entries_.size());
    }
  }
}

// False if there is no place for it.
bool UndoHistory::keep(Entry& entry, bool nearest, std::size_t& full, std::size_t& packed) {
  if (entry.where == Where::full) {
    const std::size_t bytes = entry.record->bytes();
    if (nearest || full + bytes <= options_.full_bytes) {
      full += bytes;
      return true;
    }
    try {
      entry.packed = entry.record->pack();
    } catch (const std::exception&) {  // out of memory
      return false;
    }
    entry.record.reset();
    entry.where = Where::packed;
  }
  if (entry.where == Where::spilled) return true;
  if (packed + entry.packed.capacity() > options_.packed_bytes) return spill(entry);
  packed += entry.packed.capacity();
  return true;
}

// A store that is full does no harm to what stands: the stroke can only not be undone any more.
bool UndoHistory::spill(Entry& entry) {
  if (options_.store == nullptr) return false;
  try {
    entry.name = options_.store->put(entry.packed);
  } catch (const std::exception&) {
    return false;
  }
  entry.packed = std::vector<std::byte>();
  entry.where = Where::spilled;
  return true;
}

}  // namespace sdfgrid
