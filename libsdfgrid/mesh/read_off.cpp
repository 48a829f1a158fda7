// OFF, the Object File Format of Geomview: text, binary big-endian as Geomview has it, and binary
// little-endian as OpenMesh writes it.
#include <fmt/format.h>

#include <cmath>

#include "sdfgrid/core/error.h"
#include "sdfgrid/mesh/read_scanner.h"

namespace sdfgrid::mesh_io {
namespace {

constexpr const char* kSaveAsPlain = "save it as plain OFF";

// The first word is [ST][C][N][4][n]OFF, each letter announcing more numbers a point. Some files
// have the number of points glued to it (ModelNet's "OFF490 518 0").
struct Magic {
  bool found = false;
  bool extra_dimensions = false;  // 4 or n
  std::string_view glued;
};

Magic parse_magic(std::string_view word) {
  Magic magic;
  const std::size_t off = word.find("OFF");
  if (off > 5) return magic;  // nor npos
  for (const char c : word.substr(0, off)) {
    if (c == '4' || c == 'n') {
      magic.extra_dimensions = true;
    } else if (c != 'S' && c != 'T' && c != 'C' && c != 'N') {
      return magic;
    }
  }
  magic.glued = word.substr(off + 3);
  magic.found = magic.glued.empty() || to_integer(magic.glued).has_value();
  return magic;
}

[[noreturn]] void fail_counts(const Source& source, const std::string& place, std::uint64_t points,
                              std::uint64_t faces, std::size_t left) {
  throw input_error(
      source.path, place,
      fmt::format("{} and {} are announced, but only {} follow", counted(points, "point"),
                  counted(faces, "face"), counted(left, "byte")),
      "the file is truncated or its counts are wrong: copy or export it again");
}

Polygons read_text(const Source& source) {
  TextScanner scanner(source, TextScanner::Comments::yes);
  Pace pace(source);
  const Magic magic = parse_magic(scanner.word());
  if (!magic.found) scanner.fail("the first word is not OFF", "check the file's format");
  if (magic.extra_dimensions) scanner.fail("points have more than 3 coordinates", kSaveAsPlain);
  const std::uint64_t points = magic.glued.empty()
                                   ? scanner.count("the number of points")
                                   : static_cast<std::uint64_t>(*to_integer(magic.glued));
  const std::uint64_t faces = scanner.count("the number of faces");
  // A point takes at least "0 0 0\n" and a face "0\n", but for the last line's end.
  if (points > scanner.left() / 6 + 1 || faces > scanner.left() / 2 + 1) {
    fail_counts(source, fmt::format("line {}", scanner.line()), points, faces, scanner.left());
  }
  scanner.skip_line();

  Polygons mesh;
  mesh.format = "OFF";
  mesh.points.reserve(points);
  mesh.sizes.reserve(faces);
  mesh.corners.reserve(3 * faces);
  for (std::uint64_t i = 0; i < points; ++i) {
    pace.at(source.bytes.size() - scanner.left());
    mesh.points.push_back(scanner.point());
    scanner.skip_line();  // a normal, a colour
  }
  for (std::uint64_t i = 0; i < faces; ++i) {
    pace.at(source.bytes.size() - scanner.left());
    const std::uint64_t size = scanner.count("a face's number of corners");
    if (size > scanner.left() / 2 + 1) {
      scanner.fail(fmt::format("a face of {} does not fit into the file", counted(size, "corner")),
                   "the file is truncated or damaged: copy or export it again");
    }
    for (std::uint64_t k = 0; k < size; ++k) mesh.corners.push_back(scanner.index(points));
    mesh.sizes.push_back(static_cast<std::uint32_t>(size));
    scanner.skip_line();
  }
  return mesh;
}

// The two binary dialects differ in byte order and in whether colours follow each face.
Polygons read_binary(const Source& source, std::size_t at, std::endian order) {
  const bool colours_follow = order == std::endian::big;
  ByteScanner scanner(source, at, order);
  Pace pace(source);
  const std::uint64_t points = scanner.next<std::uint32_t>();
  const std::uint64_t faces = scanner.next<std::uint32_t>();
  scanner.skip(4);  // the number of edges, which nobody needs
  if (points * 12 + faces * 4 > scanner.left()) {
    fail_counts(source, "header", points, faces, scanner.left());
  }
  Polygons mesh;
  mesh.format = order == std::endian::big ? "OFF binary big-endian" : "OFF binary little-endian";
  mesh.points.reserve(points);
  mesh.sizes.reserve(faces);
  for (std::uint64_t i = 0; i < points; ++i) {
    pace.at(scanner.at());
    glm::dvec3& p = mesh.points.emplace_back(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      p[axis] = scanner.next<float>();
      if (!std::isfinite(p[axis])) {
        scanner.fail(4, "a coordinate is not finite", "remove the point and the faces that use it");
      }
    }
  }
  for (std::uint64_t i = 0; i < faces; ++i) {
    pace.at(scanner.at());
    const std::uint64_t size = scanner.next<std::uint32_t>();
    if (size * 4 > scanner.left()) scanner.fail_truncated();
    for (std::uint64_t k = 0; k < size; ++k) {
      const auto index = scanner.next<std::uint32_t>();
      if (index >= points) {
        scanner.fail(
            4,
            fmt::format("index {} is out of range: there are {}", index, counted(points, "point")),
            "export the mesh again");
      }
      mesh.corners.push_back(index);
    }
    mesh.sizes.push_back(static_cast<std::uint32_t>(size));
    if (colours_follow) scanner.skip(4 * std::size_t{scanner.next<std::uint32_t>()});
  }
  return mesh;
}

// Whether the counts behind the header can be true in this byte order; the other one makes them
// huge.
bool counts_fit(const Source& source, std::size_t at, std::endian order) {
  ByteScanner scanner(source, at, order);
  const std::uint64_t points = scanner.next<std::uint32_t>();
  const std::uint64_t faces = scanner.next<std::uint32_t>();
  scanner.skip(4);
  return points * 12 + faces * 4 <= scanner.left();
}

}  // namespace

Polygons read_off(const Source& source) {
  const std::size_t line_end = source.bytes.find('\n');
  const std::string_view first = source.bytes.substr(0, line_end);
  if (!first.starts_with("OFF BINARY") && first.find("OFF BINARY") != std::string_view::npos) {
    throw input_error(source.path, "line 1", "a binary OFF with attributes or 4 coordinates",
                      kSaveAsPlain);
  }
  if (!first.starts_with("OFF BINARY")) return read_text(source);
  const std::size_t at = std::min(first.size() + 1, source.bytes.size());
  const bool big =
      !counts_fit(source, at, std::endian::little) && counts_fit(source, at, std::endian::big);
  return read_binary(source, at, big ? std::endian::big : std::endian::little);
}

}  // namespace sdfgrid::mesh_io
