#include "sdfgrid/mesh/read.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <utility>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/file_name.h"
#include "sdfgrid/mesh/read_formats.h"
#include "sdfgrid/mesh/triangulate.h"

namespace sdfgrid {
namespace {

using mesh_io::counted;
using mesh_io::Polygons;
using mesh_io::Source;

using Reader = Polygons (*)(const Source&);

constexpr const char* kKnown = "convert it to OBJ, PLY, STL, OFF or OM";
// Ears cost the square of a polygon's corners.
constexpr std::size_t kMostCorners = 20000;

constexpr std::pair<const char*, Reader> kReaders[] = {
    {".obj", mesh_io::read_obj}, {".ply", mesh_io::read_ply}, {".stl", mesh_io::read_stl},
    {".off", mesh_io::read_off}, {".om", mesh_io::read_om},   {".stla", mesh_io::read_stl},
    {".stlb", mesh_io::read_stl}};

Reader reader_of(const std::string& path) {
  const std::string extension = extension_of(path);
  for (const auto& [known, reader] : kReaders) {
    if (extension == known) return reader;
  }
  std::error_code none;
  if (!std::filesystem::exists(path, none)) {
    throw input_error(path, "", "there is no such file", "check the path");
  }
  throw input_error(path, "name", fmt::format("'{}' is not the extension of a mesh", extension),
                    kKnown);
}

std::string read_bytes(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    throw input_error(path, "", "there is no such file", "check the path");
  }
  if (std::filesystem::is_directory(status)) {
    throw input_error(path, "", "it is a folder", "name a file in it");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) throw input_error(path, "", "it cannot be opened", "check its permissions");
  std::string bytes;
  if (std::filesystem::is_regular_file(status)) {
    bytes.resize(std::filesystem::file_size(path));
    file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(file.gcount()));
  } else {  // a pipe
    bytes.assign(std::istreambuf_iterator<char>(file), {});
  }
  if (file.bad()) throw input_error(path, "", "reading it failed", "check the disk");
  if (bytes.empty()) throw input_error(path, "byte 0", "the file is empty", "export it again");
  return bytes;
}

constexpr std::uint32_t kUnused = 0xffffffffU;

// For each point 0, or kUnused where no face of three corners uses it: a pivot or what an editor
// left behind is no part of the surface and must not count in its box.
std::vector<std::uint32_t> find_used(const Polygons& mesh) {
  std::vector<std::uint32_t> place(mesh.points.size(), kUnused);
  std::size_t first = 0;
  for (const std::uint32_t size : mesh.sizes) {
    for (std::size_t k = first; size >= 3 && k < first + size; ++k) place[mesh.corners[k]] = 0;
    first += size;
  }
  return place;
}

Box box_of(const Polygons& mesh, const std::vector<std::uint32_t>& place) {
  Box box;
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] != kUnused) box.add(mesh.points[i]);
  }
  return box;
}

// See read_mesh(). Rounded to a power of two near a quarter of the size: then neither the origin
// nor the differences from coordinates that are floats need more digits than a float has.
glm::dvec3 choose_origin(const Box& box) {
  const glm::dvec3 size = box.size();
  const double extent = std::max({size.x, size.y, size.z});
  glm::dvec3 origin(0.0);
  if (!(extent > 0.0)) return origin;
  const double unit = std::exp2(std::floor(std::log2(extent)) - 2.0);
  for (int a = 0; a < 3; ++a) {
    const double offset = std::max(std::abs(box.lo[a]), std::abs(box.hi[a]));
    if (offset > 2.0 * extent) origin[a] = std::round(box.center()[a] / unit) * unit;
  }
  return origin;
}

// Puts points into soup.points, each place once; returns the position there of every point.
class PointMerger {
 public:
  PointMerger(std::size_t expected, TriangleSoup& soup)
      : soup_(soup), slots_(std::bit_ceil(2 * expected + 1), kFree), mask_(slots_.size() - 1) {}

  std::uint32_t add(const glm::dvec3& world) {
    // Adding zero makes -0 the same place as 0.
    const glm::vec3 p = glm::vec3(world - soup_.origin) + 0.0F;
    for (std::size_t slot = hash(p) & mask_;; slot = (slot + 1) & mask_) {
      if (slots_[slot] == kFree) {
        slots_[slot] = static_cast<std::uint32_t>(soup_.points.size());
        soup_.points.push_back(p);
      }
      if (soup_.points[slots_[slot]] == p) return slots_[slot];
    }
  }

 private:
  static constexpr std::uint32_t kFree = 0xffffffffU;

  static std::uint64_t hash(const glm::vec3& p) {
    std::uint64_t h = 0;
    for (int a = 0; a < 3; ++a) {
      h = (h ^ std::bit_cast<std::uint32_t>(p[a])) * 0x9e3779b97f4a7c15ULL;
      h ^= h >> 32;
    }
    return h;
  }

  TriangleSoup& soup_;
  std::vector<std::uint32_t> slots_;
  std::size_t mask_;
};

// Sets the place of every used point.
void merge_points(const Polygons& mesh, TriangleSoup& soup, std::vector<std::uint32_t>& place) {
  soup.points.reserve(mesh.points.size());
  PointMerger merger(mesh.points.size(), soup);
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] != kUnused) place[i] = merger.add(mesh.points[i]);
  }
}

void cut_polygons(const Source& source, const Polygons& mesh,
                  const std::vector<std::uint32_t>& place, MeshFile& file) {
  std::size_t dropped = 0, crossing = 0, first = 0;
  const auto emit = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    file.soup.triangles.emplace_back(place[a], place[b], place[c]);
  };
  file.soup.triangles.reserve(mesh.corners.size() -
                              std::min(mesh.corners.size(), 2 * mesh.sizes.size()));
  for (std::size_t face = 0; face < mesh.sizes.size(); first += mesh.sizes[face++]) {
    const std::size_t size = mesh.sizes[face];
    if (size < 3) {
      ++dropped;
      continue;
    }
    if (size == 3) {
      emit(mesh.corners[first], mesh.corners[first + 1], mesh.corners[first + 2]);
      continue;
    }
    if (size > kMostCorners) {
      throw input_error(source.path, fmt::format("face {}", face),
                        fmt::format("a polygon of {}", counted(size, "corner")),
                        "triangulate it in the program that made it");
    }
    if (face % 1024 == 0) source.job.checkpoint();
    const std::span<const std::uint32_t> polygon(&mesh.corners[first], size);
    if (triangulate(mesh.points, polygon, emit) == Cut::crossing) ++crossing;
  }
  if (dropped > 0) {
    file.warnings.push_back("dropped " + counted(dropped, "face") +
                            " with fewer than three corners");
  }
  if (crossing > 0) {
    file.warnings.push_back(counted(crossing, "polygon") +
                            " with crossing sides or no area: the triangles may overlap");
  }
}

void check_counts(const Source& source, const Polygons& mesh) {
  if (mesh.points.empty()) {
    throw input_error(source.path, "end", "there are no points", kKnown);
  }
  if (mesh.sizes.empty()) {
    throw input_error(source.path, "end",
                      fmt::format("{} but no faces", counted(mesh.points.size(), "point")),
                      "export a surface, not points or lines");
  }
  if (mesh.points.size() >= 0xffffffffULL) {
    throw input_error(source.path, "", "more points than 32-bit indices can name",
                      "split the mesh");
  }
}

void check_size(const Source& source, const Box& box) {
  if (box.empty()) {
    throw input_error(source.path, "end", "no face has three corners",
                      "export a surface, not lines");
  }
  const glm::dvec3 size = box.size();
  // The squares of lengths must stay within float's range.
  if (!(std::max({size.x, size.y, size.z}) < 1e18)) {
    throw input_error(source.path, "bounds", "the mesh is larger than 1e18 units",
                      "look for a stray point, or scale it down");
  }
}

}  // namespace

const std::vector<std::string>& mesh_extensions() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> extensions;
    for (const auto& [extension, reader] : kReaders) extensions.emplace_back(extension);
    return extensions;
  }();
  return all;
}

MeshFile read_mesh(const std::string& path, const Job& job) {
  const Reader reader = reader_of(path);
  std::string bytes = read_bytes(path);
  const Source source{path, bytes, job};
  Polygons mesh = reader(source);
  bytes = {};
  job.checkpoint();
  check_counts(source, mesh);
  std::vector<std::uint32_t> place = find_used(mesh);
  const Box box = box_of(mesh, place);
  check_size(source, box);

  MeshFile file;
  file.format = std::move(mesh.format);
  file.warnings = std::move(mesh.warnings);
  file.points = mesh.points.size();
  file.faces = mesh.sizes.size();
  file.soup.origin = choose_origin(box);
  merge_points(mesh, file.soup, place);
  cut_polygons(source, mesh, place, file);
  job.report("read", 1.0);
  return file;
}

}  // namespace sdfgrid
