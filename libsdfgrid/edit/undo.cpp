#include "sdfgrid/edit/undo.h"

#include <blosc.h>

#include <algorithm>
#include <cstring>

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
  std::vector<std::byte> piece(kPiece + BLOSC_MAX_OVERHEAD);
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

void UndoRecord::reserve(std::size_t bricks) {
  states_.reserve(bricks);
  values_.reserve(bricks * kBrickSamples);
  active_.reserve(bricks * kBrickWords);
}

void UndoRecord::store(State& state, const GridBrick& now) {
  state.slot = -1;
  state.constant = now.constant;
  if (now.values == nullptr) return;
  state.slot = static_cast<std::int32_t>(values_.size() / kBrickSamples);
  values_.insert(values_.end(), now.values, now.values + kBrickSamples);
  active_.insert(active_.end(), now.active, now.active + kBrickWords);
}

void UndoRecord::add(const glm::ivec3& brick, const GridBrick& now) {
  State state{brick, 0, -1};
  store(state, now);
  states_.push_back(state);
}

void UndoRecord::exchange(GridBricks& grid) {
  UndoRecord other;
  other.reserve(states_.size());
  for (const State& state : states_) other.add(state.brick, grid.find(state.brick));
  for (const State& state : states_) {
    if (state.slot < 0) {
      grid.drop(state.brick, state.constant);
      continue;
    }
    const GridBrick brick = grid.make(state.brick);
    std::memcpy(brick.values, values_.data() + std::size_t(state.slot) * kBrickSamples,
                sizeof(float) * kBrickSamples);
    std::memcpy(brick.active, active_.data() + std::size_t(state.slot) * kBrickWords,
                sizeof(std::uint64_t) * kBrickWords);
  }
  *this = std::move(other);
}

std::vector<glm::ivec3> UndoRecord::bricks() const {
  std::vector<glm::ivec3> all;
  all.reserve(states_.size());
  for (const State& state : states_) all.push_back(state.brick);
  return all;
}

std::size_t UndoRecord::bytes() const {
  return sizeof *this + states_.capacity() * sizeof(State) + values_.capacity() * sizeof(float) +
         active_.capacity() * sizeof(std::uint64_t);
}

std::vector<std::byte> UndoRecord::pack() const {
  std::vector<std::byte> out;
  pack_vector(states_, out);
  pack_vector(values_, out);
  pack_vector(active_, out);
  out.shrink_to_fit();
  return out;
}

UndoRecord UndoRecord::unpack(std::span<const std::byte> packed) {
  UndoRecord record;
  record.states_ = unpack_vector<State>(packed);
  record.values_ = unpack_vector<float>(packed);
  record.active_ = unpack_vector<std::uint64_t>(packed);
  return record;
}

void UndoHistory::push(UndoRecord record) {
  entries_.resize(done_);
  if (options_.full_bytes == 0) return;
  entries_.emplace_back();
  entries_.back().record = std::move(record);
  ++done_;
  keep_within_budget();
}

std::vector<glm::ivec3> UndoHistory::exchange(Entry& entry, GridBricks& grid) {
  if (entry.where == Where::spilled) entry.packed = options_.store->get(entry.name);
  if (entry.where != Where::full) entry.record = UndoRecord::unpack(entry.packed);
  entry.packed = {};
  entry.where = Where::full;
  entry.record.exchange(grid);
  return entry.record.bricks();
}

std::vector<glm::ivec3> UndoHistory::undo(GridBricks& grid) {
  if (done_ == 0) return {};
  return exchange(entries_[--done_], grid);
}

std::vector<glm::ivec3> UndoHistory::redo(GridBricks& grid) {
  if (done_ == entries_.size()) return {};
  return exchange(entries_[done_++], grid);
}

std::size_t UndoHistory::bytes() const {
  std::size_t sum = 0;
  for (const Entry& entry : entries_) {
    sum += entry.where == Where::full ? entry.record.bytes() : entry.packed.capacity();
  }
  return sum;
}

void UndoHistory::keep_within_budget() {
  std::size_t full = 0;
  std::size_t packed = 0;
  for (auto entry = entries_.rbegin(); entry != entries_.rend(); ++entry) {
    if (entry->where == Where::full) {
      full += entry->record.bytes();
      if (full > options_.full_bytes && entry != entries_.rbegin()) {
        full -= entry->record.bytes();
        entry->packed = entry->record.pack();
        entry->record = UndoRecord();
        entry->where = Where::packed;
      }
    }
    if (entry->where != Where::packed) continue;
    packed += entry->packed.capacity();
    if (packed <= options_.packed_bytes) continue;
    packed -= entry->packed.capacity();
    if (options_.store == nullptr) {
      // Older strokes cannot be undone any more.
      const auto forgotten = static_cast<std::size_t>(entries_.rend() - entry);
      entries_.erase(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(forgotten));
      done_ -= forgotten;
      return;
    }
    entry->name = options_.store->put(entry->packed);
    entry->packed = {};
    entry->where = Where::spilled;
  }
}

}  // namespace sdfgrid
