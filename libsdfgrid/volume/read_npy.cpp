// numpy's .npy files (numpy.lib.format, versions 1 to 3); declared in read_formats.h.
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstring>
#include <fstream>
#include <optional>
#include <string_view>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/volume/read_formats.h"

namespace sdfgrid::volume_io {
namespace {

constexpr const char* kSaveAgain = "save it again with numpy.save";

struct NpyHeader {
  std::string text;        // the dictionary
  std::uint64_t size = 0;  // bytes before the first sample
};

NpyHeader read_header(const std::string& path, std::ifstream& in, std::uint64_t file_bytes) {
  std::array<unsigned char, 12> start{};
  in.read(reinterpret_cast<char*>(start.data()), 8);
  if (in.gcount() < 8 || std::memcmp(start.data(), "\x93NUMPY", 6) != 0) {
    throw input_error(path, "byte 0", "it does not begin like a .npy file", kSaveAgain);
  }
  const bool wide = start[6] > 1;  // the length takes four bytes
  if (start[6] < 1 || start[6] > 3) {
    throw input_error(path, "byte 6", fmt::format("version {} of .npy is unknown", start[6]),
                      kSaveAgain);
  }
  in.read(reinterpret_cast<char*>(start.data()) + 8, wide ? 4 : 2);
  std::uint64_t length = start[8] | start[9] << 8U;
  if (wide)
    length |= static_cast<std::uint64_t>(start[10]) << 16U | std::uint64_t(start[11]) << 24U;
  NpyHeader header;
  header.size = (wide ? 12 : 10) + length;
  if (header.size > file_bytes) {
    throw input_error(path, "byte 8", fmt::format("a header of {} bytes is announced", length),
                      kCopyAgain);
  }
  header.text.resize(length);
  in.read(header.text.data(), static_cast<std::streamsize>(length));
  return header;
}

// What stands behind 'key': in the dictionary, up to the end of the header.
std::string_view value_of(const std::string& path, const std::string& text, const char* key) {
  const std::string quoted = fmt::format("'{}'", key);
  std::size_t at = text.find(quoted);
  if (at != std::string::npos) at = text.find(':', at + quoted.size());
  if (at != std::string::npos) at = text.find_first_not_of(' ', at + 1);
  if (at == std::string::npos) {
    throw input_error(path, "header", fmt::format("there is no {}", quoted), kSaveAgain);
  }
  return std::string_view(text).substr(at);
}

// Samples of the type that numpy spells as in '<f4', and whether the greatest byte comes first.
std::pair<Samples, bool> parse_type(const std::string& path, std::string_view text) {
  std::string_view word;
  if (text.size() > 2 && text[0] == '\'') {
    const std::size_t end = text.find('\'', 1);
    if (end != std::string_view::npos) word = text.substr(1, end - 1);
  }
  if (word.size() == 3 && std::string_view("<>|=").find(word[0]) != std::string_view::npos) {
    const std::string_view type = word.substr(1);
    constexpr std::array<std::pair<const char*, const char*>, 11> kTypes = {{{"b1", "uint8"},
                                                                             {"u1", "uint8"},
                                                                             {"i1", "int8"},
                                                                             {"u2", "uint16"},
                                                                             {"i2", "int16"},
                                                                             {"u4", "uint32"},
                                                                             {"i4", "int32"},
                                                                             {"u8", "uint64"},
                                                                             {"i8", "int64"},
                                                                             {"f4", "float32"},
                                                                             {"f8", "float64"}}};
    for (const auto& [code, name] : kTypes) {
      if (type == code) return {samples_of_type(name), word[0] == '>'};
    }
  }
  throw input_error(path, "header",
                    word.empty() ? "samples of several fields"
                                 : fmt::format("samples of numpy's type '{}'", word),
                    "save it as integers or as floats of 32 or 64 bits, as in "
                    "array.astype('float32')");
}

// The numbers of a tuple as in "(3, 4, 5), }".
std::vector<std::uint64_t> parse_shape(const std::string& path, std::string_view text) {
  std::vector<std::uint64_t> shape;
  const std::size_t end = text.find(')');
  const bool tuple = !text.empty() && text[0] == '(' && end != std::string_view::npos;
  for (std::size_t at = 1; tuple && at < end;) {
    if (text[at] == ' ' || text[at] == ',') {
      ++at;
      continue;
    }
    std::uint64_t size = 0;
    const auto [stop, error] = std::from_chars(text.data() + at, text.data() + end, size);
    if (error != std::errc()) {
      throw input_error(path, "header", "the shape is not made of numbers", kSaveAgain);
    }
    shape.push_back(size);
    at = static_cast<std::size_t>(stop - text.data());
  }
  if (shape.size() != 2 && shape.size() != 3) {
    throw input_error(path, "header",
                      tuple ? fmt::format("the array has {} axes", shape.size())
                            : std::string("the shape is not a tuple"),
                      "save an array of three axes, [i, j, k]");
  }
  return shape;
}

bool parse_fortran_order(const std::string& path, std::string_view text) {
  if (text.starts_with("True")) return true;
  if (text.starts_with("False")) return false;
  throw input_error(path, "header", "'fortran_order' is neither True nor False", kSaveAgain);
}

// From an array whose last index runs fastest to one whose first does.
void reverse_axes(Volume& volume, const Job& job) {
  std::visit(
      [&](auto& values) {
        auto turned = values;
        const auto dims = glm::uvec3(volume.dims);
        constexpr std::size_t kTile = 32;  // a row of cache lines each way
        const std::size_t tiles = (dims.x + kTile - 1) / kTile;
        parallel_for(dims.y * tiles, 4, job, [&](std::size_t begin, std::size_t end) {
          for (std::size_t n = begin; n < end; ++n) {
            const std::size_t j = n / tiles;
            const std::size_t first = n % tiles * kTile;
            const std::size_t last = std::min<std::size_t>(first + kTile, dims.x);
            for (std::size_t k = 0; k < dims.z; ++k) {
              for (std::size_t i = first; i < last; ++i) {
                turned[i + dims.x * (j + dims.y * k)] = values[(i * dims.y + j) * dims.z + k];
              }
            }
          }
        });
        values = std::move(turned);
      },
      volume.samples);
}

}  // namespace

VolumeFile read_npy(const std::string& path, const Job& job) {
  const std::uint64_t size = file_size(path);
  std::ifstream in(path, std::ios::binary);
  const NpyHeader header = read_header(path, in, size);
  VolumeFile file;
  file.format = "npy";
  Volume& volume = file.volume;
  bool big_endian = false;
  std::tie(volume.samples, big_endian) = parse_type(path, value_of(path, header.text, "descr"));
  const bool fortran = parse_fortran_order(path, value_of(path, header.text, "fortran_order"));
  std::vector<std::uint64_t> shape = parse_shape(path, value_of(path, header.text, "shape"));
  shape.resize(3, 1);
  const std::uint64_t bytes = set_dims(path, {shape[0], shape[1], shape[2]}, volume);
  check_claim(path, bytes, size - header.size, 1);
  allocate(path, volume, fortran ? 0 : 1);
  read_samples(path, in, big_endian, volume, job);
  if (!fortran) reverse_axes(volume, job);
  return file;
}

}  // namespace sdfgrid::volume_io
