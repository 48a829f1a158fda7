// tests/mesh/mesh_files.h: mesh files made in code, in a folder that goes with the test.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/vec3.hpp>
#include <iomanip>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

namespace sdfgrid::testing {

class TempDir {
 public:
  TempDir() {
    std::string pattern = (std::filesystem::temp_directory_path() / "sdfgrid-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~TempDir() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;

  // Writes a file and returns its path.
  [[nodiscard]] std::string write(const std::string& name, const std::string& bytes) const {
    const std::string path = (path_ / name).string();
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  [[nodiscard]] std::string path(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

// A mesh as files have it.
struct PolygonMesh {
  std::vector<glm::dvec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
};

inline PolygonMesh unit_cube() {
  PolygonMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.points.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
  mesh.faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  return mesh;
}

// All faces cut into fans, which STL needs.
inline PolygonMesh fans(const PolygonMesh& mesh) {
  PolygonMesh result{mesh.points, {}};
  for (const auto& face : mesh.faces) {
    for (std::size_t k = 1; k + 1 < face.size(); ++k) {
      result.faces.push_back({face[0], face[k], face[k + 1]});
    }
  }
  return result;
}

inline std::string text_of(const glm::dvec3& p) {
  std::ostringstream text;
  text << std::setprecision(17) << p.x << ' ' << p.y << ' ' << p.z;
  return text.str();
}

template <class T>
std::string bytes_of(T value, std::endian order = std::endian::little) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (order != std::endian::native) bytes.assign(bytes.rbegin(), bytes.rend());
  return bytes;
}

inline std::string obj_text(const PolygonMesh& mesh) {
  std::string text = "# made in code\nmtllib none.mtl\no thing\n";
  for (const glm::dvec3& p : mesh.points) text += "v " + text_of(p) + "\nvn 0 0 1\n";
  text += "usemtl grey\ns off\n";
  for (const auto& face : mesh.faces) {
    text += "f";
    for (const std::uint32_t i : face) {
      text += " " + std::to_string(i + 1) + "//" + std::to_string(i + 1);
    }
    text += "\n";
  }
  return text;
}

inline std::string off_text(const PolygonMesh& mesh) {
  std::string text = "OFF\n" + std::to_string(mesh.points.size()) + " " +
                     std::to_string(mesh.faces.size()) + " 0\n";
  for (const glm::dvec3& p : mesh.points) text += text_of(p) + "\n";
  for (const auto& face : mesh.faces) {
    text += std::to_string(face.size());
    for (const std::uint32_t i : face) text += " " + std::to_string(i);
    text += "\n";
  }
  return text;
}

// Little-endian as OpenMesh writes it, big-endian as Geomview does (with colours, none here).
inline std::string off_binary(const PolygonMesh& mesh, std::endian order) {
  const auto number = [&](std::size_t n) { return bytes_of(static_cast<std::uint32_t>(n), order); };
  std::string bytes =
      "OFF BINARY\n" + number(mesh.points.size()) + number(mesh.faces.size()) + number(0);
  for (const glm::dvec3& p : mesh.points) {
    for (int a = 0; a < 3; ++a) bytes += bytes_of(static_cast<float>(p[a]), order);
  }
  for (const auto& face : mesh.faces) {
    bytes += number(face.size());
    for (const std::uint32_t i : face) bytes += number(i);
    if (order == std::endian::big) bytes += number(0);
  }
  return bytes;
}

inline std::string ply_header(const PolygonMesh& mesh, const std::string& format,
                              const std::string& coordinate) {
  return "ply\nformat " + format + " 1.0\ncomment made in code\nobj_info none\nelement vertex " +
         std::to_string(mesh.points.size()) + "\nproperty " + coordinate + " x\nproperty " +
         coordinate + " y\nproperty " + coordinate + " z\nproperty uchar red\nelement face " +
         std::to_string(mesh.faces.size()) +
         "\nproperty list uchar int vertex_indices\nproperty uchar flags\nend_header\n";
}

inline std::string ply_text(const PolygonMesh& mesh) {
  std::string text = ply_header(mesh, "ascii", "double");
  for (const glm::dvec3& p : mesh.points) text += text_of(p) + " 255\n";
  for (const auto& face : mesh.faces) {
    text += std::to_string(face.size());
    for (const std::uint32_t i : face) text += " " + std::to_string(i);
    text += " 0\n";
  }
  return text;
}

// Coordinate is float or double.
template <class Coordinate>
std::string ply_binary(const PolygonMesh& mesh, std::endian order) {
  const bool little = order == std::endian::little;
  std::string bytes = ply_header(mesh, little ? "binary_little_endian" : "binary_big_endian",
                                 sizeof(Coordinate) == 8 ? "double" : "float");
  for (const glm::dvec3& p : mesh.points) {
    for (int a = 0; a < 3; ++a) bytes += bytes_of(static_cast<Coordinate>(p[a]), order);
    bytes += '\xff';
  }
  for (const auto& face : mesh.faces) {
    bytes += static_cast<char>(face.size());
    for (const std::uint32_t i : face) bytes += bytes_of(static_cast<std::int32_t>(i), order);
    bytes += '\0';
  }
  return bytes;
}

inline std::string stl_text(const PolygonMesh& mesh) {
  std::string text = "solid made in code\n";
  for (const auto& face : fans(mesh).faces) {
    text += "  facet normal 0 0 0\n    outer loop\n";
    for (const std::uint32_t i : face) text += "      vertex " + text_of(mesh.points[i]) + "\n";
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid made in code\n";
}

inline std::string stl_binary(const PolygonMesh& mesh) {
  const PolygonMesh triangles = fans(mesh);
  // Binary files may begin with the word that begins a text.
  std::string bytes = "solid";
  bytes.resize(80, ' ');
  bytes += bytes_of(static_cast<std::uint32_t>(triangles.faces.size()), std::endian::little);
  for (const auto& face : triangles.faces) {
    bytes.append(12, '\0');
    for (const std::uint32_t i : face) {
      for (int a = 0; a < 3; ++a) {
        bytes += bytes_of(static_cast<float>(mesh.points[i][a]), std::endian::little);
      }
    }
    bytes.append(2, '\0');
  }
  return bytes;
}

struct NamedFile {
  std::string name;
  std::string format;  // as read_mesh() calls it
  std::string bytes;
};

// How GoogleTest names a parameter.
// NOLINTNEXTLINE(readability-identifier-naming)
inline void PrintTo(const NamedFile& file, std::ostream* out) { *out << file.name; }

// The mesh in every variant that does not need OpenMesh to write it.
inline std::vector<NamedFile> all_variants(const PolygonMesh& mesh) {
  using std::endian;
  return {
      {"a.obj", "OBJ", obj_text(mesh)},
      {"a.off", "OFF", off_text(mesh)},
      {"little.off", "OFF binary little-endian", off_binary(mesh, endian::little)},
      {"big.off", "OFF binary big-endian", off_binary(mesh, endian::big)},
      {"a.ply", "PLY text", ply_text(mesh)},
      {"float_little.ply", "PLY binary little-endian", ply_binary<float>(mesh, endian::little)},
      {"float_big.ply", "PLY binary big-endian", ply_binary<float>(mesh, endian::big)},
      {"double_little.ply", "PLY binary little-endian", ply_binary<double>(mesh, endian::little)},
      {"double_big.ply", "PLY binary big-endian", ply_binary<double>(mesh, endian::big)},
      {"text.stl", "STL text", stl_text(mesh)},
      {"binary.stl", "STL binary", stl_binary(mesh)}};
}

}  // namespace sdfgrid::testing
