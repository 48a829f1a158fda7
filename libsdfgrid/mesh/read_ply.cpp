// PLY, the polygon file format of Stanford: text, or binary of either byte order. Of its elements
// only `vertex` (x, y, z) and `face` (vertex_indices) are kept; the rest is stepped over.
#include <fmt/format.h>

#include <cmath>

#include "sdfgrid/core/error.h"
#include "sdfgrid/mesh/read_ply_header.h"
#include "sdfgrid/mesh/read_scanner.h"

namespace sdfgrid::mesh_io {
namespace {

constexpr const char* kExportAgain = "export the mesh again";

// The numbers of a text, one a word whatever their type.
class TextNumbers {
 public:
  TextNumbers(const Source& source, const PlyHeader& header)
      : source_(source), scanner_(source, TextScanner::Comments::no) {
    for (std::size_t i = 0; i < header.lines; ++i) scanner_.skip_line();
  }
  double next(PlyType) {
    const std::string_view word = scanner_.word();
    if (word.empty()) scanner_.fail_truncated("a number");
    const std::optional<double> value = to_number(word);
    if (!value) {
      scanner_.fail(fmt::format("expected a number, found '{}'", word.substr(0, 32)), kExportAgain);
    }
    return *value;
  }
  // How many numbers can follow at most.
  [[nodiscard]] std::size_t room(PlyType) const { return (scanner_.left() + 1) / 2; }
  [[nodiscard]] std::size_t at() const { return source_.bytes.size() - scanner_.left(); }
  [[noreturn]] void fail(PlyType, const std::string& problem, const std::string& remedy) const {
    scanner_.fail(problem, remedy);
  }

 private:
  const Source& source_;
  TextScanner scanner_;
};

// The numbers of a binary file. A double holds every type's values.
class BinaryNumbers {
 public:
  BinaryNumbers(const Source& source, const PlyHeader& header)
      : scanner_(
            source, header.size,
            header.encoding == PlyEncoding::big_endian ? std::endian::big : std::endian::little) {}
  double next(PlyType type) {
    switch (type) {
      case PlyType::i8:
        return scanner_.next<std::int8_t>();
      case PlyType::u8:
        return scanner_.next<std::uint8_t>();
      case PlyType::i16:
        return scanner_.next<std::int16_t>();
      case PlyType::u16:
        return scanner_.next<std::uint16_t>();
      case PlyType::i32:
        return scanner_.next<std::int32_t>();
      case PlyType::u32:
        return scanner_.next<std::uint32_t>();
      case PlyType::f32:
        return scanner_.next<float>();
      case PlyType::f64:
        return scanner_.next<double>();
    }
    return 0.0;
  }
  [[nodiscard]] std::size_t room(PlyType type) const { return scanner_.left() / size_of(type); }
  [[nodiscard]] std::size_t at() const { return scanner_.at(); }
  [[noreturn]] void fail(PlyType type, const std::string& problem,
                         const std::string& remedy) const {
    scanner_.fail(size_of(type), problem, remedy);
  }

 private:
  ByteScanner scanner_;
};

// Walks the elements. Numbers is TextNumbers or BinaryNumbers.
template <class Numbers>
class Rows {
 public:
  Rows(const Source& source, const PlyHeader& header, std::uint64_t points, Polygons& mesh)
      : numbers_(source, header), pace_(source), points_(points), mesh_(mesh) {}

  void read(const PlyElement& element) {
    if (element.properties.empty()) return;
    const bool vertex = element.name == "vertex";
    const bool face = element.name == "face";
    if (vertex) {
      for (int axis = 0; axis < 3; ++axis) axis_of_[axis] = element.find({&"xyz"[axis], 1});
      mesh_.points.reserve(element.count);
    }
    if (face) {
      indices_ = index_list(element);
      mesh_.sizes.reserve(element.count);
      mesh_.corners.reserve(3 * element.count);
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      pace_.at(numbers_.at());
      if (vertex) {
        point(element);
      } else if (face) {
        polygon(element);
      } else {
        for (const PlyProperty& property : element.properties) skip(property);
      }
    }
  }

  // Position of the list of a face's points, or -1.
  static int index_list(const PlyElement& face) {
    const int list = face.find("vertex_indices");
    return list >= 0 ? list : face.find("vertex_index");
  }

 private:
  void point(const PlyElement& element) {
    glm::dvec3& p = mesh_.points.emplace_back(0.0);
    for (int i = 0; i < static_cast<int>(element.properties.size()); ++i) {
      const PlyProperty& property = element.properties[i];
      if (i != axis_of_[0] && i != axis_of_[1] && i != axis_of_[2]) {
        skip(property);
        continue;
      }
      const double value = numbers_.next(property.type);
      if (!std::isfinite(value)) {
        numbers_.fail(property.type, "a coordinate is not finite",
                      "remove the point and the faces that use it");
      }
      for (int axis = 0; axis < 3; ++axis) {
        if (axis_of_[axis] == i) p[axis] = value;
      }
    }
  }

  void polygon(const PlyElement& element) {
    for (int i = 0; i < static_cast<int>(element.properties.size()); ++i) {
      const PlyProperty& property = element.properties[i];
      if (i != indices_) {
        skip(property);
        continue;
      }
      const std::size_t size = list_size(property);
      for (std::size_t k = 0; k < size; ++k) mesh_.corners.push_back(index(property.type));
      mesh_.sizes.push_back(static_cast<std::uint32_t>(size));
    }
  }

  std::uint32_t index(PlyType type) {
    const double value = numbers_.next(type);
    if (!(value >= 0.0 && value < static_cast<double>(points_)) || value != std::floor(value)) {
      numbers_.fail(type,
                    fmt::format("index {} is out of range: the header announces {}", value,
                                counted(points_, "point")),
                    kExportAgain);
    }
    return static_cast<std::uint32_t>(value);
  }

  std::size_t list_size(const PlyProperty& property) {
    const double size = numbers_.next(*property.count_type);
    if (!(size >= 0.0 && size <= static_cast<double>(numbers_.room(property.type))) ||
        size != std::floor(size)) {
      numbers_.fail(*property.count_type,
                    fmt::format("a list of {} items does not fit into the file", size),
                    "the file is truncated or damaged: copy or export it again");
    }
    return static_cast<std::size_t>(size);
  }

  void skip(const PlyProperty& property) {
    const std::size_t items = property.count_type ? list_size(property) : 1;
    for (std::size_t k = 0; k < items; ++k) (void)numbers_.next(property.type);
  }

  Numbers numbers_;
  Pace pace_;
  std::uint64_t points_;
  Polygons& mesh_;
  int axis_of_[3] = {-1, -1, -1};
  int indices_ = -1;
};

const PlyElement& required(const Source& source, const PlyHeader& header, std::string_view name) {
  for (const PlyElement& element : header.elements) {
    if (element.name == name) return element;
  }
  throw input_error(source.path, "header", fmt::format("there is no element '{}'", name),
                    "export a surface made of polygons, not points or strips");
}

void check_properties(const Source& source, const PlyElement& vertex, const PlyElement& face) {
  for (const char* axis : {"x", "y", "z"}) {
    const int i = vertex.find(axis);
    if (i < 0 || vertex.properties[i].count_type) {
      throw input_error(source.path, "header",
                        fmt::format("the element 'vertex' has no coordinate '{}'", axis),
                        kExportAgain);
    }
  }
  const int list = Rows<BinaryNumbers>::index_list(face);
  if (list < 0 || !face.properties[list].count_type) {
    throw input_error(source.path, "header", "the element 'face' has no list 'vertex_indices'",
                      kExportAgain);
  }
}

template <class Numbers>
void read_rows(const Source& source, const PlyHeader& header, Polygons& mesh) {
  Rows<Numbers> rows(source, header, required(source, header, "vertex").count, mesh);
  for (const PlyElement& element : header.elements) {
    rows.read(element);
    if (!mesh.points.empty() && !mesh.sizes.empty()) break;
  }
}

}  // namespace

Polygons read_ply(const Source& source) {
  const PlyHeader header = read_ply_header(source);
  check_properties(source, required(source, header, "vertex"), required(source, header, "face"));
  Polygons mesh;
  if (header.encoding == PlyEncoding::text) {
    mesh.format = "PLY text";
    read_rows<TextNumbers>(source, header, mesh);
  } else {
    mesh.format = header.encoding == PlyEncoding::big_endian ? "PLY binary big-endian"
                                                             : "PLY binary little-endian";
    read_rows<BinaryNumbers>(source, header, mesh);
  }
  return mesh;
}

}  // namespace sdfgrid::mesh_io
