#include "sdfgrid/edit/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <sstream>

#include "sdfgrid/core/atomic_file.h"
#include "sdfgrid/core/error.h"

namespace sdfgrid {
namespace {

std::uint64_t record_hash(std::uint64_t before, std::size_t number, std::string_view text) {
  const std::string prefix = fmt::format("{:016x} {} ", before, number);
  return fnv_hash(text, fnv_hash(prefix));
}

std::string record_line(std::uint64_t before, std::size_t number, const std::string& text) {
  return fmt::format("{} {} {:016x} {}\n", number, text.size(), record_hash(before, number, text),
                     text);
}

struct Line {
  std::size_t number = 0;
  std::uint64_t hash = 0;
  std::string_view text;
  std::size_t bytes = 0;  // with the line break
};

// One number and the space after it; false if there is none.
bool take(std::string_view& in, int base, std::uint64_t& value) {
  const auto [end, error] = std::from_chars(in.data(), in.data() + in.size(), value, base);
  if (error != std::errc() || end == in.data() + in.size() || *end != ' ') return false;
  in.remove_prefix(static_cast<std::size_t>(end - in.data()) + 1);
  return true;
}

// Whether what stands at the beginning has the form of a line up to its text and, by the length
// that it states, room for the line break; be that, or the hash, right or not.
bool read_line_of_any_end(std::string_view in, Line& line) {
  const std::size_t whole = in.size();
  std::uint64_t number = 0;
  std::uint64_t length = 0;
  if (!take(in, 10, number) || !take(in, 10, length)) return false;
  const std::size_t before = in.size();
  if (!take(in, 16, line.hash) || before - in.size() != 17) return false;
  if (length >= in.size()) return false;
  line.number = number;
  line.text = in.substr(0, length);
  line.bytes = whole - in.size() + length + 1;
  return true;
}

// Whether a line of the right form stands at the beginning, be its hash right or not.
bool read_line(std::string_view in, Line& line) {
  return read_line_of_any_end(in, line) && in[line.bytes - 1] == '\n';
}

// What follows the last good record. The line break is a record's last byte: what has one, or as
// many bytes as it says, was written to its end.
JournalContent::End end_of(std::string_view rest) {
  if (rest.empty()) return JournalContent::End::whole;
  Line line;
  const bool was_whole =
      rest.find('\n') != std::string_view::npos || read_line_of_any_end(rest, line);
  return was_whole ? JournalContent::End::damaged : JournalContent::End::torn;
}

// The records that can be told apart in what follows a bad one, with numbers above `number`.
std::size_t count_lines(std::string_view in, std::size_t number) {
  std::size_t count = 0;
  while (!in.empty()) {
    Line line;
    const bool found = read_line(in, line) && line.number > number;
    count += found ? 1 : 0;
    in.remove_prefix(found ? line.bytes : 1);
  }
  return count;
}

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream bytes;
  // An empty file makes << fail, too.
  if (!in || (in.peek() != std::ifstream::traits_type::eof() && !(bytes << in.rdbuf()))) {
    throw input_error(path, "", "it cannot be read", "check that this is a session's folder");
  }
  return bytes.str();
}

[[noreturn]] void fail(const std::string& path, int reason) {
  throw Error(ErrorKind::failed, fmt::format("{}: cannot be written ({}); what was recorded before "
                                             "is safe",
                                             path, std::strerror(reason)));
}

}  // namespace

std::uint64_t fnv_hash(std::string_view bytes, std::uint64_t hash) {
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

std::uint64_t fnv_hash_of_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw input_error(path, "", "it cannot be read", "restore it from a copy");
  std::uint64_t hash = fnv_hash("");
  std::vector<char> chunk(1 << 20);
  while (in.read(chunk.data(), static_cast<std::streamsize>(chunk.size())) || in.gcount() > 0) {
    hash = fnv_hash({chunk.data(), static_cast<std::size_t>(in.gcount())}, hash);
  }
  return hash;
}

JournalContent parse_journal(std::string_view bytes) {
  JournalContent content;
  content.bytes = bytes.size();
  std::uint64_t hash = 0;
  std::string_view rest = bytes;
  Line line;
  while (read_line(rest, line) && line.number == content.records.size() &&
         rest.substr(0, line.bytes) == record_line(hash, line.number, std::string(line.text))) {
    hash = line.hash;
    content.records.push_back({std::string(line.text), hash});
    rest.remove_prefix(line.bytes);
  }
  content.good_bytes = bytes.size() - rest.size();
  content.end = end_of(rest);
  content.records_after_damage = count_lines(rest, content.records.size());
  return content;
}

JournalContent read_journal(const std::string& path) { return parse_journal(bytes_of(path)); }

std::string keep_copy(const std::string& path, std::uint64_t from, const std::string& what) {
  const std::string bytes = bytes_of(path).substr(from);
  std::string copy = path + "." + what;
  for (int i = 2; std::filesystem::exists(copy); ++i) copy = fmt::format("{}.{}-{}", path, what, i);
  write_bytes_atomically(copy, std::as_bytes(std::span(bytes)));
  return std::filesystem::path(copy).filename().string();
}

Journal::Journal(std::string path, const JournalContent& content)
    : path_(std::move(path)), size_(content.good_bytes), count_(content.records.size()) {
  if (!content.records.empty()) hash_ = content.records.back().hash;
  file_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
  if (file_ < 0) fail(path_, errno);
  if (content.bytes > size_ &&
      (::ftruncate(file_, static_cast<off_t>(size_)) != 0 || ::fsync(file_) != 0)) {
    const int reason = errno;
    ::close(file_);
    fail(path_, reason);
  }
}

Journal::~Journal() { ::close(file_); }

void Journal::append(const std::string& text) {
  if (untidy_) {
    throw Error(ErrorKind::failed, path_ +
                                       ": after a write that failed its end is not what was "
                                       "acknowledged; open the session anew");
  }
  const std::string line = record_line(hash_, count_, text);
  std::size_t written = 0;
  int reason = 0;
  while (written < line.size() && reason == 0) {
    const ssize_t n = ::pwrite(file_, line.data() + written, line.size() - written,
                               static_cast<off_t>(size_ + written));
    if (n < 0 && errno != EINTR) reason = errno;
    if (n > 0) written += static_cast<std::size_t>(n);
  }
  if (reason == 0 && ::fdatasync(file_) != 0) reason = errno;
  if (reason != 0) {
    // Best effort: a torn record is recognized when the journal is read.
    untidy_ = ::ftruncate(file_, static_cast<off_t>(size_)) != 0;
    fail(path_, reason);
  }
  size_ += line.size();
  hash_ = record_hash(hash_, count_, text);
  ++count_;
}

void create_journal(const std::string& path, const std::string& first) {
  write_atomically(path, [&](const std::string& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out << record_line(0, 0, first);
    if (!out.flush()) throw Error(ErrorKind::failed, path + ": cannot be written");
  });
}

}  // namespace sdfgrid
