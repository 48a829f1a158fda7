// tests/mesh/om_files.h: what OpenMesh itself writes and reads.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "mesh/mesh_files.h"

namespace sdfgrid::testing {

// A manifold mesh as an OM file with positions in double or float, with normals and a
// property of our own on the points, both of which readers must step over.
[[nodiscard]] std::string om_bytes(const PolygonMesh& mesh, bool doubles);

using OpenMeshTriangle = std::array<std::array<float, 3>, 3>;

// A file's triangles by OpenMesh's readers and its half-edge mesh.
[[nodiscard]] std::vector<OpenMeshTriangle> triangles_by_openmesh(const std::string& path);

}  // namespace sdfgrid::testing
