#include "sdfgrid/volume/write.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <fstream>

#include "sdfgrid/core/atomic_file.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/core/file_name.h"

namespace sdfgrid {
namespace {

static_assert(std::endian::native == std::endian::little, "samples are written as they are");

std::size_t sample_bytes(const Volume& volume) {
  return volume.size() * bytes_per_sample(volume.samples);
}

// numpy.lib.format, version 1: the samples begin at a multiple of 64 bytes.
std::string npy_header(const std::string& code, const char* fortran_order,
                       const std::string& shape) {
  std::string text = fmt::format("{{'descr': '{}', 'fortran_order': {}, 'shape': ({}), }}", code,
                                 fortran_order, shape);
  constexpr std::size_t kStart = 10;
  text.append(63 - (kStart + text.size()) % 64, ' ');
  text += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(text.size() & 0xff);
  header += static_cast<char>(text.size() >> 8);
  return header + text;
}

std::string npy_header(const Volume& volume) {
  constexpr std::array<const char*, 10> kCodes = {"|u1", "|i1", "<u2", "<i2", "<u4",
                                                  "<i4", "<u8", "<i8", "<f4", "<f8"};
  const glm::ivec3& dims = volume.dims;
  return npy_header(kCodes[volume.samples.index()], "True",
                    fmt::format("{}, {}, {}", dims.x, dims.y, dims.z));
}

std::string nrrd_header(const Volume& volume) {
  std::string type = type_name(volume.samples);
  if (type == "float32") type = "float";
  if (type == "float64") type = "double";
  std::string directions;
  for (int a = 0; a < 3; ++a) {
    const glm::dvec3 step = volume.spacing[a] * volume.axes[a];
    directions += fmt::format(" ({},{},{})", step.x, step.y, step.z);
  }
  return fmt::format(
      "NRRD0004\n"
      "type: {}\n"
      "dimension: 3\n"
      "space dimension: 3\n"
      "sizes: {} {} {}\n"
      "space directions:{}\n"
      "kinds: domain domain domain\n"
      "endian: little\n"
      "encoding: raw\n"
      "space origin: ({},{},{})\n\n",
      type, volume.dims.x, volume.dims.y, volume.dims.z, directions, volume.origin.x,
      volume.origin.y, volume.origin.z);
}

std::string vti_header(const Volume& volume) {
  constexpr std::array<const char*, 10> kTypes = {"UInt8",   "Int8",   "UInt16", "Int16",
                                                  "UInt32",  "Int32",  "UInt64", "Int64",
                                                  "Float32", "Float64"};
  const std::string extent =
      fmt::format("0 {} 0 {} 0 {}", volume.dims.x - 1, volume.dims.y - 1, volume.dims.z - 1);
  std::string direction;  // row by row
  for (int row = 0; row < 3; ++row) {
    for (int a = 0; a < 3; ++a) direction += fmt::format("{} ", volume.axes[a][row]);
  }
  direction.pop_back();
  const std::uint64_t bytes = sample_bytes(volume);
  std::string header = fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n"
      "<ImageData WholeExtent=\"{0}\" Origin=\"{1} {2} {3}\" Spacing=\"{4} {5} {6}\" "
      "Direction=\"{7}\">\n"
      "<Piece Extent=\"{0}\"><PointData Scalars=\"value\">\n"
      "<DataArray type=\"{8}\" Name=\"value\" format=\"appended\" offset=\"0\"/>\n"
      "</PointData></Piece></ImageData>\n"
      "<AppendedData encoding=\"raw\">_",
      extent, volume.origin.x, volume.origin.y, volume.origin.z, volume.spacing.x, volume.spacing.y,
      volume.spacing.z, direction, kTypes[volume.samples.index()]);
  const auto length = std::bit_cast<std::array<char, sizeof(bytes)>>(bytes);
  return header.append(length.data(), length.size());
}

struct Format {
  const char* extension;
  std::string (*header)(const Volume& volume);
  const char* end;
};

constexpr std::array<Format, 3> kFormats = {
    {{".npy", [](const Volume& v) { return npy_header(v); }, ""},
     {".nrrd", nrrd_header, ""},
     {".vti", vti_header, "\n</AppendedData></VTKFile>\n"}}};

const Format& format_of(const std::string& path) {
  const std::string extension = extension_of(path);
  for (const Format& format : kFormats) {
    if (extension == format.extension) return format;
  }
  throw Error(ErrorKind::usage, path + ": volumes are written as .npy, .nrrd or .vti");
}

void write_samples(std::ofstream& out, const Volume& volume, const Job& job) {
  constexpr std::size_t kChunk = std::size_t{1} << 24U;
  const std::size_t bytes = sample_bytes(volume);
  std::visit(
      [&](const auto& values) {
        const char* data = reinterpret_cast<const char*>(values.data());
        for (std::size_t at = 0; at < bytes && out.good(); at += kChunk) {
          job.checkpoint();
          job.report("write", static_cast<double>(at) / static_cast<double>(bytes));
          out.write(data + at, static_cast<std::streamsize>(std::min(kChunk, bytes - at)));
        }
      },
      volume.samples);
}

}  // namespace

const std::vector<std::string>& volume_extensions() {
  static const std::vector<std::string> all = {".npy", ".nrrd", ".vti"};
  return all;
}

void write_volume(const Volume& volume, const std::string& path, const Job& job) {
  const Format& format = format_of(path);
  const std::size_t count =
      std::visit([](const auto& values) { return values.size(); }, volume.samples);
  if (count != volume.size() || count == 0) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: {} samples do not make a volume of {} x {} x {}", path, count,
                            volume.dims.x, volume.dims.y, volume.dims.z));
  }
  write_atomically(path, [&](const std::string& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out << format.header(volume);
    write_samples(out, volume, job);
    out << format.end;
    out.close();
    if (!out) throw Error(ErrorKind::failed, path + ": cannot be written; is the disk full?");
  });
  job.report("write", 1.0);
}

void write_table(std::span<const double> values, std::size_t columns, const std::string& path) {
  if (columns == 0 || values.size() % columns != 0) {
    throw Error(ErrorKind::usage, path + ": the values do not fill the table's rows");
  }
  write_atomically(path, [&](const std::string& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out << npy_header("<f8", "False", fmt::format("{}, {}", values.size() / columns, columns));
    out.write(reinterpret_cast<const char*>(values.data()),
              static_cast<std::streamsize>(values.size_bytes()));
    out.close();
    if (!out) throw Error(ErrorKind::failed, path + ": cannot be written; is the disk full?");
  });
}

}  // namespace sdfgrid
