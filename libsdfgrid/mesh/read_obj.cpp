// Wavefront OBJ: the records v and f. Everything else is passed over; what would be geometry and is
// not is counted in a warning.
#include <fmt/format.h>

#include <cmath>

#include "sdfgrid/mesh/read_scanner.h"

namespace sdfgrid::mesh_io {
namespace {

constexpr std::string_view kIgnored[] = {
    "vt",     "vn",     "vp",     "g",         "o",     "s",        "mg",       "usemtl",
    "mtllib", "usemap", "maplib", "lod",       "bevel", "c_interp", "d_interp", "shadow_obj",
    "deg",    "bmat",   "step",   "cstype",    "parm",  "trim",     "hole",     "scrv",
    "sp",     "end",    "con",    "trace_obj", "ctech", "stech",    "call",     "csh"};
constexpr std::string_view kOtherGeometry[] = {"p", "l", "curv", "curv2", "surf"};

template <std::size_t N>
bool is_one_of(std::string_view word, const std::string_view (&words)[N]) {
  for (const std::string_view w : words) {
    if (w == word) return true;
  }
  return false;
}

class ObjReader {
 public:
  explicit ObjReader(const Source& source)
      : scanner_(source, TextScanner::Comments::yes), size_(source.bytes.size()), pace_(source) {
    mesh_.format = "OBJ";
  }

  Polygons read() {
    while (!scanner_.at_end()) {
      pace_.at(size_ - scanner_.left());
      record(scanner_.word_in_line());
      scanner_.skip_line();
    }
    check_forward_indices();
    if (other_geometry_ > 0) {
      mesh_.warnings.push_back("ignored " +
                               counted(other_geometry_,
                                       "point, line, curve or free-form "
                                       "surface record") +
                               ": only faces make a surface");
    }
    if (unknown_ > 0) {
      mesh_.warnings.push_back(fmt::format("ignored {} of unknown kind, the first at line {}",
                                           counted(unknown_, "record"), first_unknown_));
    }
    return std::move(mesh_);
  }

 private:
  void record(std::string_view keyword) {
    if (keyword == "v") {
      vertex();
    } else if (keyword == "f" || keyword == "fo") {
      face();
    } else if (is_one_of(keyword, kOtherGeometry)) {
      ++other_geometry_;
    } else if (!keyword.empty() && !is_one_of(keyword, kIgnored)) {
      if (unknown_++ == 0) first_unknown_ = scanner_.line();
    }
  }

  void vertex() {
    glm::dvec3 p;
    for (int axis = 0; axis < 3; ++axis) {
      p[axis] = scanner_.finite(scanner_.word_in_line(), "a coordinate");
    }
    mesh_.points.push_back(p);
  }

  void face() {
    const std::size_t first = mesh_.corners.size();
    for (;;) {
      const std::string_view word = scanner_.word_in_line();
      if (word.empty()) break;
      mesh_.corners.push_back(corner(word));
    }
    const std::size_t corners = mesh_.corners.size() - first;
    if (corners < 3 && scanner_.at_end()) scanner_.fail_truncated("a face's corner");
    mesh_.sizes.push_back(static_cast<std::uint32_t>(corners));
  }

  // A corner is POINT, POINT/TEXTURE, POINT//NORMAL or POINT/TEXTURE/NORMAL, counted from 1, or
  // from the last point so far if negative.
  std::uint32_t corner(std::string_view word) {
    const std::string_view number = word.substr(0, word.find('/'));
    const std::optional<std::int64_t> value = to_integer(number);
    if (!value) {
      scanner_.fail(fmt::format("expected a point's index, found '{}'", number.substr(0, 32)),
                    "export the mesh again");
    }
    const auto known = static_cast<std::int64_t>(mesh_.points.size());
    const std::int64_t index = *value < 0 ? known + *value : *value - 1;
    if (index < 0 || index >= 0xffffffffLL) out_of_range(*value, scanner_);
    if (index >= known && index >= highest_) {
      highest_ = index;
      highest_scanner_.emplace(scanner_);
    }
    return static_cast<std::uint32_t>(index);
  }

  // Faces may come before their points, as they do in some files.
  void check_forward_indices() const {
    if (highest_scanner_ && highest_ >= static_cast<std::int64_t>(mesh_.points.size())) {
      out_of_range(highest_ + 1, *highest_scanner_);
    }
  }

  [[noreturn]] void out_of_range(std::int64_t value, const TextScanner& place) const {
    place.fail(fmt::format("index {} is out of range: there are {}", value,
                           counted(mesh_.points.size(), "point")),
               "export the mesh again");
  }

  Polygons mesh_;
  TextScanner scanner_;
  std::size_t size_;
  Pace pace_;
  std::int64_t highest_ = -1;                   // index of a point that no line has given yet
  std::optional<TextScanner> highest_scanner_;  // where it stood
  std::size_t other_geometry_ = 0, unknown_ = 0, first_unknown_ = 0;
};

}  // namespace

Polygons read_obj(const Source& source) { return ObjReader(source).read(); }

}  // namespace sdfgrid::mesh_io
