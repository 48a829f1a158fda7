// mesh/read_ply_header.h: what a PLY file says of itself before its data (not installed).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sdfgrid/mesh/read_formats.h"

namespace sdfgrid::mesh_io {

enum class PlyType : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };

[[nodiscard]] std::size_t size_of(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type;                       // of the value, or of a list's items
  std::optional<PlyType> count_type;  // of the number of items, if it is a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  // Position of the named property, or -1.
  [[nodiscard]] int find(std::string_view property) const;
};

enum class PlyEncoding { text, little_endian, big_endian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::text;
  std::vector<PlyElement> elements;
  std::size_t size = 0;   // bytes, so the data begin here
  std::size_t lines = 0;  // lines of it
};

// Throws Error{input} if the header is malformed or announces more than the file's size can hold.
[[nodiscard]] PlyHeader read_ply_header(const Source& source);

}  // namespace sdfgrid::mesh_io
