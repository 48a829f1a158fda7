// mesh/read.h: meshes from files, as they are in the world, into a triangle soup.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/mesh/soup.h"

namespace sdfgrid {

struct MeshFile {
  TriangleSoup soup;
  std::string format;                 // "OBJ", "PLY binary little-endian", ...
  std::vector<std::string> warnings;  // what was dropped or guessed, with counts
  std::size_t points = 0;             // points in the file; the soup has each place once
  std::size_t faces = 0;              // faces in the file, polygons counted once
};

// The extensions of meshes, lower case with the dot.
[[nodiscard]] const std::vector<std::string>& mesh_extensions();

// Reads OBJ, PLY, STL and OFF (text and binary) and OpenMesh's OM; the file's extension says which.
//
// Polygons are triangulated, points that coincide exactly are merged, and whatever is not surface
// (materials, normals, colours, lines, points that no face uses) is passed over. Faces come in the
// order of the file, and none is lost without a warning: non-manifold, flipped, repeated and
// zero-area ones stay.
//
// Coordinates are read in double. Along an axis on which the mesh lies further from zero than twice
// its size, soup.origin is the (rounded) centre of its box, so that float keeps all of a survey's
// millimetres; along the others it is 0, and coordinates that are floats stay what they are.
//
// Throws Error{input}, naming the line or byte and a remedy, for a file that is missing, empty,
// truncated or malformed, that has indices out of range or coordinates that are not finite, or that
// announces more than its size can hold. Throws Error{cancelled}.
[[nodiscard]] MeshFile read_mesh(const std::string& path, const Job& job);

}  // namespace sdfgrid
