// mesh/read_formats.h: the readers behind read_mesh(), one a format (not installed).
//
// OpenMesh 9 reads only its own format here. Its readers of the other four parse coordinates into
// float, so that a mesh in UTM coordinates loses its millimetres; hand on uninitialized memory, and
// report success, where an OFF file has a comment; drop the faces of an STL file that have two
// corners in one place; open files that an OBJ's `mtllib` names; and trust the header's counts. To
// guard them, every number of the file would have to be read and checked beforehand, and that is
// all of the work. tests/mesh compares these readers with OpenMesh's on files which those read
// right.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "sdfgrid/core/job.h"

namespace sdfgrid::mesh_io {

// A file's contents in memory, and its name for messages.
struct Source {
  const std::string& path;
  std::string_view bytes;
  const Job& job;
};

// What a file holds, before triangulation. Every index is below points.size() and every coordinate
// is finite.
struct Polygons {
  std::vector<glm::dvec3> points;
  std::vector<std::uint32_t> corners;  // indices into points, face after face
  std::vector<std::uint32_t> sizes;    // corners of each face; may be below three
  std::string format;
  std::vector<std::string> warnings;
};

[[nodiscard]] Polygons read_obj(const Source& source);
[[nodiscard]] Polygons read_off(const Source& source);
[[nodiscard]] Polygons read_om(const Source& source);
[[nodiscard]] Polygons read_ply(const Source& source);
[[nodiscard]] Polygons read_stl(const Source& source);

// "3 lines", "1 line".
[[nodiscard]] std::string counted(std::size_t count, std::string_view thing);

}  // namespace sdfgrid::mesh_io
