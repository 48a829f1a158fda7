// mesh/read_scanner.h: the words of a text and the numbers of a binary file, with the place of each
// for messages (not installed).
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "sdfgrid/mesh/read_formats.h"

namespace sdfgrid::mesh_io {

// The number that a whole word spells; infinite if it is too large for a double, empty if the word
// is not a number. Independent of the locale.
[[nodiscard]] std::optional<double> to_number(std::string_view word);
[[nodiscard]] std::optional<std::int64_t> to_integer(std::string_view word);

// Reads a text word by word. Lines end in \n, \r\n or (in files that have no \n) \r; `#` begins a
// comment if the format has those, and a backslash at a line's end joins it with the next.
class TextScanner {
 public:
  enum class Comments : bool { no, yes };

  // Throws Error{input} if there is a zero byte, which no text has.
  TextScanner(const Source& source, Comments comments);

  // The next word of this line; empty at its end.
  std::string_view word_in_line();
  // The next word of the file; empty at its end.
  std::string_view word();
  void skip_line();  // to the beginning of the next line
  [[nodiscard]] bool at_end() const { return at_ >= text_.size(); }
  [[nodiscard]] std::size_t left() const { return text_.size() - at_; }
  [[nodiscard]] std::size_t line() const { return line_; }

  // A finite coordinate from `word`; `what` names it in the message.
  [[nodiscard]] double finite(std::string_view word, const char* what) const;
  // The next three words of the file.
  [[nodiscard]] glm::dvec3 point();
  // The next word of the file as an integer in [0, limit).
  [[nodiscard]] std::uint32_t index(std::size_t limit);
  // The next word of the file as a count.
  [[nodiscard]] std::uint64_t count(const char* what);

  // Throws Error{input} at this line.
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy) const;
  [[noreturn]] void fail_truncated(const std::string& expected) const;

 private:
  void skip_blanks();

  const Source& source_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  char newline_;
  bool comments_;
};

// Reads numbers of a binary file.
class ByteScanner {
 public:
  ByteScanner(const Source& source, std::size_t at, std::endian order)
      : source_(source), at_(at), swap_(order != std::endian::native) {}

  [[nodiscard]] std::size_t at() const { return at_; }
  [[nodiscard]] std::size_t left() const { return source_.bytes.size() - at_; }

  // The next number of type T. Throws Error{input} at the end of the file.
  template <class T>
  [[nodiscard]] T next() {
    if (left() < sizeof(T)) fail_truncated();
    T value;
    std::memcpy(&value, source_.bytes.data() + at_, sizeof(T));
    at_ += sizeof(T);
    if (swap_) reverse(value);
    return value;
  }
  void skip(std::size_t bytes) {
    if (left() < bytes) fail_truncated();
    at_ += bytes;
  }

  // Throws Error{input} at the number of `size` bytes that was just read.
  [[noreturn]] void fail(std::size_t size, const std::string& problem,
                         const std::string& remedy) const;
  [[noreturn]] void fail_truncated() const;

 private:
  template <class T>
  static void reverse(T& value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
    std::memcpy(&value, bytes, sizeof(T));
  }

  const Source& source_;
  std::size_t at_;
  bool swap_;
};

// Asks the job whether to go on, and reports how far the file is read, now and then.
class Pace {
 public:
  explicit Pace(const Source& source) : source_(source) {}
  void at(std::size_t byte) {
    if (byte < next_) return;
    next_ = byte + (std::size_t{1} << 20);
    source_.job.checkpoint();
    source_.job.report("read",
                       static_cast<double>(byte) / static_cast<double>(source_.bytes.size()));
  }

 private:
  const Source& source_;
  std::size_t next_ = 0;
};

}  // namespace sdfgrid::mesh_io
