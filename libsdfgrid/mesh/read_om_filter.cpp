#include "sdfgrid/mesh/read_om_filter.h"

#include <fmt/format.h>

#include <OpenMesh/Core/IO/OMFormat.hh>
#include <cmath>

#include "sdfgrid/core/error.h"
#include "sdfgrid/mesh/read_scanner.h"

namespace sdfgrid::mesh_io {
namespace {

using OpenMesh::IO::OMFormat::Chunk;

class OmFilter {
 public:
  explicit OmFilter(const Source& source)
      : source_(source), scanner_(source, 0, std::endian::little) {}

  std::string filter() {
    header();
    while (scanner_.left() > 0 && chunk()) {
    }
    if (!has_points_) fail("header", "there are no points");
    if (!has_faces_) fail("header", "there are no faces");
    return std::move(kept_);
  }

 private:
  void header() {
    if (!source_.bytes.starts_with("OM")) fail("byte 0", "the first letters are not 'OM'");
    scanner_.skip(2);
    kind_ = scanner_.next<char>();
    if (kind_ != 'T' && kind_ != 'Q' && kind_ != 'P') fail("byte 2", "unknown kind of mesh");
    version_ = scanner_.next<std::uint8_t>();
    if (version_ > OpenMesh::IO::OMFormat::mk_version(2, 2)) {
      fail("byte 3", "its version is not known to OpenMesh 9");
    }
    points_ = scanner_.next<std::uint32_t>();
    faces_ = scanner_.next<std::uint32_t>();
    edges_ = scanner_.next<std::uint32_t>();
    kept_.assign(source_.bytes.substr(0, scanner_.at()));
  }

  // Whether it was not the last one.
  bool chunk() {
    source_.job.checkpoint();
    const std::size_t begin = scanner_.at();
    Chunk::Header head;
    OpenMesh::IO::OMFormat::operator<<(head, scanner_.next<std::uint16_t>());
    if (head.entity_ == Chunk::Entity_Sentinel) return false;
    if (head.name_ != 0) scanner_.skip(scanner_.next<std::uint8_t>());
    if (head.type_ == Chunk::Type_Custom) {
      if (version_ > OpenMesh::IO::OMFormat::mk_version(2, 1)) {
        scanner_.skip(scanner_.next<std::uint8_t>());  // the property's type
      }
      scanner_.skip(scanner_.next<std::uint32_t>());
      return true;
    }
    if (data(head)) kept_.append(source_.bytes.substr(begin, scanner_.at() - begin));
    return true;
  }

  // Steps over a chunk's data; returns whether the surface needs them.
  bool data(const Chunk::Header& head) {
    if (head.entity_ == Chunk::Entity_Vertex && head.type_ == Chunk::Type_Pos) {
      positions(head);
      return true;
    }
    if (head.type_ == Chunk::Type_Topology && head.entity_ == Chunk::Entity_Face) {
      version_ < OpenMesh::IO::OMFormat::mk_version(2, 0) ? corners(head) : integers(head, faces_);
      has_faces_ = faces_ > 0;
      return true;
    }
    if (head.type_ == Chunk::Type_Topology && head.entity_ == Chunk::Entity_Halfedge) {
      integers(head, edges_ * 6);  // next, to and face of each half-edge
      return true;
    }
    if (head.type_ == Chunk::Type_Topology) {
      integers(head, count(head));
    } else if (head.type_ == Chunk::Type_Status) {
      scanner_.skip(count(head) * sizeof(unsigned int));
    } else {
      scanner_.skip(count(head) * OpenMesh::IO::OMFormat::dimensions(head) * scalar_size(head));
    }
    return false;
  }

  void positions(const Chunk::Header& head) {
    const bool is_double = head.bits_ == Chunk::Float_64;
    if (head.float_ == 0 || head.dim_ != Chunk::Dim_3D || head.bits_ > Chunk::Float_64) {
      fail(place(), "positions that are not three floats or doubles");
    }
    if (has_points_) fail(place(), "a second set of positions");
    if (points_ * (is_double ? 24 : 12) > scanner_.left()) fail_counts();
    for (std::uint64_t i = 0; i < 3 * points_; ++i) {
      const double value = is_double ? scanner_.next<double>() : scanner_.next<float>();
      if (!std::isfinite(value)) {
        scanner_.fail(is_double ? 8 : 4, "a coordinate is not finite",
                      "remove the point and the faces that use it");
      }
    }
    has_points_ = points_ > 0;
  }

  // Faces as older versions have them: corners, after their number if polygons are mixed.
  void corners(const Chunk::Header& head) {
    for (std::uint64_t i = 0; i < faces_; ++i) {
      const std::uint64_t size =
          kind_ == 'P' ? scanner_.next<std::uint16_t>() : (kind_ == 'Q' ? 4 : 3);
      integers(head, size);
    }
  }

  void integers(const Chunk::Header& head, std::uint64_t count) {
    const std::size_t bytes = std::size_t{1} << head.bits_;
    if (count * bytes > scanner_.left()) fail_counts();
    scanner_.skip(count * bytes);
  }

  [[nodiscard]] std::uint64_t count(const Chunk::Header& head) const {
    switch (head.entity_) {
      case Chunk::Entity_Vertex:
        return points_;
      case Chunk::Entity_Face:
        return faces_;
      case Chunk::Entity_Edge:
        return edges_;
      case Chunk::Entity_Halfedge:
        return edges_ * 2;
      case Chunk::Entity_Mesh:
        return 1;
      default:
        fail(place(), "unknown kind of data");
    }
  }

  // Bytes of a number outside topology. OpenMesh's scalar_size() has the two cases the wrong way
  // round.
  static std::size_t scalar_size(const Chunk::Header& head) {
    return std::size_t{head.float_ != 0 ? 4U : 1U} << head.bits_;
  }

  [[nodiscard]] std::string place() const { return fmt::format("byte {}", scanner_.at()); }
  [[noreturn]] void fail(const std::string& where, const std::string& problem) const {
    throw input_error(source_.path, where, problem, kSaveOmAgain);
  }
  [[noreturn]] void fail_counts() const {
    fail(place(), fmt::format("the header announces {}, {} and {}, but only {} follow",
                              counted(points_, "point"), counted(faces_, "face"),
                              counted(edges_, "edge"), counted(scanner_.left(), "byte")));
  }

  const Source& source_;
  ByteScanner scanner_;
  std::string kept_;
  char kind_ = 'P';
  std::uint8_t version_ = 0;
  std::uint64_t points_ = 0, faces_ = 0, edges_ = 0;
  bool has_points_ = false, has_faces_ = false;
};

}  // namespace

std::string filter_om(const Source& source) { return OmFilter(source).filter(); }

}  // namespace sdfgrid::mesh_io
