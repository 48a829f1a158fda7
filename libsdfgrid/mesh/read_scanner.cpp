#include "sdfgrid/mesh/read_scanner.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "sdfgrid/core/error.h"

namespace sdfgrid::mesh_io {
namespace {

constexpr const char* kExportAgain = "export the mesh again";

// A word as it can be shown in a message: short, and without bytes that upset a terminal.
std::string shown(std::string_view word) {
  std::string text(word.substr(0, 32));
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');
  return word.size() > 32 ? text + "..." : text;
}

std::string_view without_plus(std::string_view word) {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
  return plus ? word.substr(1) : word;
}

}  // namespace

std::optional<double> to_number(std::string_view word) {
  word = without_plus(word);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    // from_chars does not tell too large from too small.
    const std::size_t exponent = word.find_first_of("eE");
    const bool tiny = exponent != std::string_view::npos && word.substr(exponent + 1, 1) == "-";
    value = tiny ? 0.0 : HUGE_VAL;
  }
  return value;
}

std::optional<std::int64_t> to_integer(std::string_view word) {
  word = without_plus(word);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || error != std::errc()) return std::nullopt;
  return value;
}

std::string counted(std::size_t count, std::string_view thing) {
  return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

TextScanner::TextScanner(const Source& source, Comments comments)
    : source_(source), text_(source.bytes), comments_(comments == Comments::yes) {
  const std::size_t zero = text_.find('\0');
  if (zero != std::string_view::npos) {
    throw input_error(source.path, fmt::format("byte {}", zero),
                      "a zero byte where text was expected",
                      "check that the extension names the file's format");
  }
  newline_ = text_.find('\n') == std::string_view::npos ? '\r' : '\n';
  if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;  // a byte order mark
}

void TextScanner::skip_blanks() {
  while (at_ < text_.size()) {
    const char c = text_[at_];
    if (c == newline_) return;
    if (c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f') {
      ++at_;
    } else if (c == '#' && comments_) {
      at_ = std::min(text_.find(newline_, at_), text_.size());
    } else if (c == '\\') {
      std::size_t next = at_ + 1;
      if (next < text_.size() && text_[next] == '\r' && newline_ == '\n') ++next;
      if (next >= text_.size() || text_[next] != newline_) return;
      at_ = next + 1;
      ++line_;
    } else {
      return;
    }
  }
}

std::string_view TextScanner::word_in_line() {
  skip_blanks();
  const std::size_t begin = at_;
  while (at_ < text_.size()) {
    const char c = text_[at_];
    if (c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == '\v' || c == '\f') break;
    if (c == '#' && comments_) break;
    if (c == '\\' && at_ > begin) break;
    ++at_;
  }
  return text_.substr(begin, at_ - begin);
}

std::string_view TextScanner::word() {
  for (;;) {
    const std::string_view found = word_in_line();
    if (!found.empty() || at_end()) return found;
    skip_line();
  }
}

void TextScanner::skip_line() {
  const std::size_t end = text_.find(newline_, at_);
  at_ = end == std::string_view::npos ? text_.size() : end + 1;
  if (end != std::string_view::npos) ++line_;
}

double TextScanner::finite(std::string_view word, const char* what) const {
  if (word.empty()) {
    if (at_end()) fail_truncated(what);
    fail(fmt::format("{} is missing", what), kExportAgain);
  }
  const std::optional<double> value = to_number(word);
  if (!value) fail(fmt::format("expected {}, found '{}'", what, shown(word)), kExportAgain);
  if (!std::isfinite(*value)) {
    fail(fmt::format("{} is not finite: '{}'", what, shown(word)),
         "remove the point and the faces that use it");
  }
  return *value;
}

glm::dvec3 TextScanner::point() {
  glm::dvec3 p;
  for (int axis = 0; axis < 3; ++axis) p[axis] = finite(word(), "a coordinate");
  return p;
}

std::uint32_t TextScanner::index(std::size_t limit) {
  const std::string_view found = word();
  if (found.empty()) fail_truncated("a point's index");
  const std::optional<std::int64_t> value = to_integer(found);
  if (!value) fail(fmt::format("expected a point's index, found '{}'", shown(found)), kExportAgain);
  if (*value < 0 || static_cast<std::uint64_t>(*value) >= limit) {
    fail(fmt::format("index {} is out of range: the file has {}", *value, counted(limit, "point")),
         kExportAgain);
  }
  return static_cast<std::uint32_t>(*value);
}

std::uint64_t TextScanner::count(const char* what) {
  const std::string_view found = word();
  if (found.empty()) fail_truncated(what);
  const std::optional<std::int64_t> value = to_integer(found);
  if (!value || *value < 0) {
    fail(fmt::format("expected {}, found '{}'", what, shown(found)), kExportAgain);
  }
  return static_cast<std::uint64_t>(*value);
}

void TextScanner::fail(const std::string& problem, const std::string& remedy) const {
  throw input_error(source_.path, fmt::format("line {}", line_), problem, remedy);
}

void TextScanner::fail_truncated(const std::string& expected) const {
  fail(fmt::format("the file ends where {} was expected", expected),
       "it is truncated: copy or export it again");
}

void ByteScanner::fail(std::size_t size, const std::string& problem,
                       const std::string& remedy) const {
  throw input_error(source_.path, fmt::format("byte {}", at_ - size), problem, remedy);
}

void ByteScanner::fail_truncated() const {
  throw input_error(source_.path, fmt::format("byte {}", source_.bytes.size()),
                    "the file ends in the middle of its data",
                    "it is truncated: copy or export it again");
}

}  // namespace sdfgrid::mesh_io
