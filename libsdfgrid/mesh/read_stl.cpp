// STL: triangles without shared points, as text or binary. The stored normals are passed over: they
// are often wrong, and the corners' order says the same.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "sdfgrid/core/error.h"
#include "sdfgrid/mesh/read_scanner.h"

namespace sdfgrid::mesh_io {
namespace {

constexpr std::size_t kHeader = 84;  // 80 bytes of comment and the number of triangles
constexpr std::size_t kRecord = 50;  // normal, three corners, two bytes of attributes

void add_corner(Polygons& mesh, const glm::dvec3& p) {
  mesh.corners.push_back(static_cast<std::uint32_t>(mesh.points.size()));
  mesh.points.push_back(p);
}

bool same_word(std::string_view word, std::string_view lower_case) {
  return std::equal(word.begin(), word.end(), lower_case.begin(), lower_case.end(),
                    [](unsigned char a, char b) { return std::tolower(a) == b; });
}

class StlText {
 public:
  explicit StlText(const Source& source)
      : source_(source), scanner_(source, TextScanner::Comments::no), pace_(source) {
    mesh_.format = "STL text";
  }

  Polygons read() {
    expect("solid");
    scanner_.skip_line();  // the solid's name
    for (;;) {
      const std::string_view word = scanner_.word();
      if (same_word(word, "facet")) {
        facet();
      } else if (same_word(word, "endsolid")) {
        scanner_.skip_line();
        if (scanner_.word().empty()) return std::move(mesh_);
        scanner_.skip_line();  // another solid
      } else if (word.empty()) {
        scanner_.fail_truncated("'facet' or 'endsolid'");
      } else {
        unexpected(word, "facet");
      }
    }
  }

 private:
  void facet() {
    pace_.at(source_.bytes.size() - scanner_.left());
    scanner_.skip_line();  // the normal
    expect("outer");
    expect("loop");
    for (int k = 0; k < 3; ++k) {
      expect("vertex");
      add_corner(mesh_, scanner_.point());
    }
    mesh_.sizes.push_back(3);
    expect("endloop");
    expect("endfacet");
  }

  void expect(const char* keyword) {
    const std::string_view word = scanner_.word();
    if (word.empty()) scanner_.fail_truncated(fmt::format("'{}'", keyword));
    if (!same_word(word, keyword)) unexpected(word, keyword);
  }

  [[noreturn]] void unexpected(std::string_view word, const char* keyword) const {
    scanner_.fail(fmt::format("expected '{}', found '{}'", keyword, word.substr(0, 32)),
                  "export the mesh again");
  }

  const Source& source_;
  Polygons mesh_;
  TextScanner scanner_;
  Pace pace_;
};

Polygons read_binary(const Source& source, std::size_t triangles) {
  Polygons mesh;
  mesh.format = "STL binary";
  mesh.points.reserve(3 * triangles);
  mesh.corners.reserve(3 * triangles);
  mesh.sizes.assign(triangles, 3);
  ByteScanner scanner(source, kHeader, std::endian::little);
  Pace pace(source);
  for (std::size_t i = 0; i < triangles; ++i) {
    pace.at(scanner.at());
    scanner.skip(12);
    for (int k = 0; k < 3; ++k) {
      glm::dvec3 p;
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] = scanner.next<float>();
        if (!std::isfinite(p[axis])) {
          scanner.fail(4, "a coordinate is not finite", "remove the triangle");
        }
      }
      add_corner(mesh, p);
    }
    scanner.skip(2);
  }
  const std::size_t rest = scanner.left();
  if (rest > 0)
    mesh.warnings.push_back("ignored " + counted(rest, "byte") + " after the triangles");
  return mesh;
}

// Binary files too may begin with "solid": the word that follows it in a text, or the size,
// decides.
bool is_text(const Source& source) {
  const std::string_view start = source.bytes.substr(0, 1024);
  const std::size_t word = start.find_first_not_of(" \t\r\n");
  if (word == std::string_view::npos || !same_word(start.substr(word, 5), "solid")) return false;
  return start.find('\0') == std::string_view::npos;
}

}  // namespace

Polygons read_stl(const Source& source) {
  const std::size_t size = source.bytes.size();
  if (size < kHeader) {
    if (is_text(source)) return StlText(source).read();
    throw input_error(source.path, fmt::format("byte {}", size),
                      "neither a text that begins with 'solid' nor a whole binary header",
                      "the file is truncated or not STL");
  }
  ByteScanner header(source, kHeader - 4, std::endian::little);
  const std::size_t triangles = header.next<std::uint32_t>();
  const std::size_t announced = kHeader + triangles * kRecord;
  if (announced != size && is_text(source)) return StlText(source).read();
  if (announced > size) {
    throw input_error(source.path, "byte 80",
                      fmt::format("{} announced make {} bytes, but the file has {}",
                                  counted(triangles, "triangle"), announced, size),
                      "the file is truncated or not STL: copy or export it again");
  }
  return read_binary(source, triangles);
}

}  // namespace sdfgrid::mesh_io
