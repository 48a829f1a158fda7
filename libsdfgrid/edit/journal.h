// edit/journal.h: an append-only file of records, each on its way to the disk before append()
// returns, that survives being cut off anywhere. A record is one line,
//
//   NUMBER LENGTH HASH TEXT
//
// with the text's length in bytes and a hash (FNV-1a, 64 bits, sixteen hexadecimal digits) of the
// hash before it, the number and the text: a record that was changed, lost, doubled or moved is
// noticed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sdfgrid {

struct JournalRecord {
  std::string text;
  std::uint64_t hash = 0;  // of this record and, through the chain, of all before it
};

struct JournalContent {
  enum class End {
    whole,
    torn,     // the last record was not written to its end, so it was never acknowledged
    damaged,  // a record that was once whole is not what was written
  };

  std::vector<JournalRecord> records;
  std::uint64_t good_bytes = 0;  // up to the end of the last good record
  std::uint64_t bytes = 0;       // of the whole file
  End end = End::whole;
  // Records after the first bad one, as far as they can be told apart.
  std::size_t records_after_damage = 0;

  [[nodiscard]] bool torn() const { return end == End::torn; }
  [[nodiscard]] bool damaged() const { return end == End::damaged; }
};

// Understands a journal's bytes; never throws, whatever they are.
[[nodiscard]] JournalContent parse_journal(std::string_view bytes);

// Throws Error{input} if the file cannot be read.
[[nodiscard]] JournalContent read_journal(const std::string& path);

class Journal {
 public:
  // Opens the file behind `content`, which was read from it, and cuts off what comes after its good
  // records. Throws Error{failed}.
  Journal(std::string path, const JournalContent& content);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  // When this returns the record is on the disk. Throws Error{failed} if it cannot be written; the
  // file then ends after the record before. `text` must not contain a line break.
  void append(const std::string& text);
  [[nodiscard]] std::uint64_t hash() const { return hash_; }  // of the last record
  [[nodiscard]] std::size_t records() const { return count_; }

 private:
  std::string path_;
  int file_ = -1;
  bool untidy_ = false;  // a record that was not acknowledged may stand at its end
  std::uint64_t size_ = 0;
  std::size_t count_ = 0;
  std::uint64_t hash_ = 0;
};

// Writes a new journal with one record, whole or not at all.
void create_journal(const std::string& path, const std::string& first);

// Copies what the file holds from byte `from` on into a new file, which is on the disk when this
// returns: PATH.WHAT or, where there is one, PATH.WHAT-2 and so on. Returns its name without the
// folder. Throws Error{failed}.
std::string keep_copy(const std::string& path, std::uint64_t from, const std::string& what);

// FNV-1a over `bytes`, going on from `hash`.
[[nodiscard]] std::uint64_t fnv_hash(std::string_view bytes,
                                     std::uint64_t hash = 0xcbf29ce484222325ULL);
// The same over what a file holds. Throws Error{input} if it cannot be read.
[[nodiscard]] std::uint64_t fnv_hash_of_file(const std::string& path);

}  // namespace sdfgrid
