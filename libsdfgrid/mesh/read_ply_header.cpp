#include "sdfgrid/mesh/read_ply_header.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "sdfgrid/core/error.h"
#include "sdfgrid/mesh/read_scanner.h"

namespace sdfgrid::mesh_io {
namespace {

constexpr const char* kExportAgain = "export the mesh again";

constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypes = {{
    {"char", PlyType::i8},
    {"int8", PlyType::i8},
    {"uchar", PlyType::u8},
    {"uint8", PlyType::u8},
    {"short", PlyType::i16},
    {"int16", PlyType::i16},
    {"ushort", PlyType::u16},
    {"uint16", PlyType::u16},
    {"int", PlyType::i32},
    {"int32", PlyType::i32},
    {"uint", PlyType::u32},
    {"uint32", PlyType::u32},
    {"float", PlyType::f32},
    {"float32", PlyType::f32},
    {"double", PlyType::f64},
    {"float64", PlyType::f64},
}};

PlyType parse_type(const TextScanner& scanner, std::string_view word) {
  for (const auto& [name, type] : kTypes) {
    if (name == word) return type;
  }
  scanner.fail(fmt::format("unknown type '{}'", word.substr(0, 32)), kExportAgain);
}

PlyEncoding parse_encoding(TextScanner& scanner) {
  const std::string_view word = scanner.word_in_line();
  if (word == "ascii") return PlyEncoding::text;
  if (word == "binary_little_endian") return PlyEncoding::little_endian;
  if (word == "binary_big_endian") return PlyEncoding::big_endian;
  scanner.fail(fmt::format("unknown encoding '{}'", word.substr(0, 32)), kExportAgain);
}

PlyProperty parse_property(TextScanner& scanner) {
  PlyProperty property{};
  std::string_view word = scanner.word_in_line();
  if (word == "list") {
    property.count_type = parse_type(scanner, scanner.word_in_line());
    word = scanner.word_in_line();
  }
  property.type = parse_type(scanner, word);
  property.name = scanner.word_in_line();
  if (property.name.empty()) scanner.fail("a property has no name", kExportAgain);
  return property;
}

void parse_line(TextScanner& scanner, PlyHeader& header, bool& has_format) {
  const std::string_view keyword = scanner.word_in_line();
  if (keyword == "format") {
    header.encoding = parse_encoding(scanner);
    has_format = true;
  } else if (keyword == "element") {
    PlyElement& element = header.elements.emplace_back();
    element.name = scanner.word_in_line();
    element.count = scanner.count("the number of elements");
  } else if (keyword == "property") {
    if (header.elements.empty()) scanner.fail("a property before any element", kExportAgain);
    header.elements.back().properties.push_back(parse_property(scanner));
  } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
    scanner.fail(fmt::format("unknown keyword '{}'", keyword.substr(0, 32)), kExportAgain);
  }
}

// Fewest bytes that one of the element can take: in a text, a digit and a space a number.
std::uint64_t smallest_row(const PlyElement& element, PlyEncoding encoding) {
  std::uint64_t bytes = 0;
  for (const PlyProperty& property : element.properties) {
    const PlyType type = property.count_type.value_or(property.type);
    bytes += encoding == PlyEncoding::text ? 2 : size_of(type);
  }
  return bytes;
}

void check_counts(const Source& source, const PlyHeader& header) {
  const bool text = header.encoding == PlyEncoding::text;
  const std::uint64_t left = source.bytes.size() - header.size;
  std::uint64_t room = left + (text ? 1 : 0);  // a text's last line need not end
  for (const PlyElement& element : header.elements) {
    const std::uint64_t row = smallest_row(element, header.encoding);
    if (row == 0) continue;
    if (element.count > room / row) {
      throw input_error(source.path, "header",
                        fmt::format("{} elements '{}' are announced, but only {} follow",
                                    element.count, element.name, counted(left, "byte")),
                        "the file is truncated or its counts are wrong: copy or export it again");
    }
    room -= element.count * row;
  }
}

// Where the line "end_header" begins.
std::size_t find_end(const Source& source) {
  constexpr std::size_t kLongest = std::size_t{1} << 20;
  const std::string_view start = source.bytes.substr(0, kLongest);
  for (std::size_t at = start.find("end_header"); at != std::string_view::npos;
       at = start.find("end_header", at + 1)) {
    if (at > 0 && (start[at - 1] == '\n' || start[at - 1] == '\r')) return at;
  }
  throw input_error(source.path, "header", "there is no line 'end_header'",
                    "the file is truncated or not PLY");
}

}  // namespace

std::size_t size_of(PlyType type) {
  constexpr std::array<std::size_t, 8> kSizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

int PlyElement::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property) return static_cast<int>(i);
  }
  return -1;
}

PlyHeader read_ply_header(const Source& source) {
  if (!source.bytes.starts_with("ply") && !source.bytes.starts_with("PLY")) {
    throw input_error(source.path, "line 1", "the first word is not 'ply'",
                      "check the file's format");
  }
  const std::size_t end = find_end(source);
  const Source text{source.path, source.bytes.substr(0, end), source.job};
  TextScanner scanner(text, TextScanner::Comments::no);
  scanner.skip_line();
  PlyHeader header;
  bool has_format = false;
  while (!scanner.at_end()) {
    parse_line(scanner, header, has_format);
    scanner.skip_line();
  }
  if (!has_format) scanner.fail("there is no line 'format'", kExportAgain);
  header.lines = scanner.line();
  header.size = end + std::string_view("end_header").size();
  const std::string_view rest = source.bytes.substr(header.size);
  if (rest.starts_with("\r\n")) {
    header.size += 2;
  } else if (!rest.empty()) {
    header.size += 1;
  }
  check_counts(source, header);
  return header;
}

}  // namespace sdfgrid::mesh_io
