// edit/spill_file.h: the undo records that memory has no room for, in a file that nobody else sees
// and that is gone with the process, however that ends.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "sdfgrid/edit/undo.h"

namespace sdfgrid {

class SpillFile : public UndoStore {
 public:
  // In this folder; made when the first bytes are put.
  explicit SpillFile(std::string folder) : folder_(std::move(folder)) {}
  ~SpillFile() override;
  SpillFile(const SpillFile&) = delete;
  SpillFile& operator=(const SpillFile&) = delete;

  std::size_t put(std::span<const std::byte> bytes) override;
  [[nodiscard]] std::vector<std::byte> get(std::size_t name) override;
  void forget(std::size_t name) override;

  [[nodiscard]] std::uint64_t bytes() const { return end_; }  // of the file

 private:
  void open();
  std::uint64_t find_place(std::uint64_t size);

  std::string folder_;
  int file_ = -1;
  std::uint64_t end_ = 0;
  std::map<std::uint64_t, std::uint64_t> used_;  // offset, which is the name, and size
  std::map<std::uint64_t, std::uint64_t> free_;  // offset and size of the gaps between
};

}  // namespace sdfgrid
