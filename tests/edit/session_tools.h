// tests/edit/session_tools.h: what the tests of sessions share.
#pragma once

#include <sys/resource.h>

#include <csignal>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "edit/grids.h"
#include "edit/session_strokes.h"
#include "sdfgrid/edit/sculptor.h"
#include "sdfgrid/edit/session.h"
#include "sdfgrid/edit/stroke_file.h"

namespace sdfgrid::test {

constexpr int kExtent = 24;  // of the contents that are compared

inline std::string read_all(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void write_all(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

inline Stroke stroke(std::size_t number) { return parse_stroke(stroke_text(number), "test"); }

// What the strokes with those numbers make of the ball.
inline Content content_after(const std::vector<std::size_t>& numbers) {
  const Grid grid = ball_grid(12);
  SculptOptions options;
  options.range = Sculptor(grid).range();
  Sculptor sculptor(grid, options);
  for (const std::size_t number : numbers) (void)sculptor.apply(stroke(number), Job());
  return content_of(grid, kExtent);
}

// What the strokes 0 to count - 1 make.
inline Content expected_content(std::size_t count) {
  std::vector<std::size_t> numbers(count);
  for (std::size_t i = 0; i < count; ++i) numbers[i] = i;
  return content_after(numbers);
}

// A session of the ball with the strokes 0 to `strokes` - 1.
inline void make_session(const std::string& path, std::size_t strokes,
                         const SessionOptions& options = {}) {
  create_session(path, ball_grid(12), Redistance::local);
  Session session(path, options, Job());
  for (std::size_t i = 0; i < strokes; ++i) (void)session.apply(stroke(i), Job());
}

// While it lives no file may grow beyond so many bytes, as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(std::uintmax_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

}  // namespace sdfgrid::test
