// tests/volume/volumes.h: small volumes with a pattern that shows every mistake in the order of
// axes or bytes, and the bytes of files made by hand.
#pragma once

#include <zlib.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "mesh/mesh_files.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/volume/read.h"
#include "sdfgrid/volume/volume.h"

namespace sdfgrid::testing {

// Sample (i, j, k) of the pattern: no two are alike, and all fit in 7 bits.
inline int pattern(int i, int j, int k) { return 1 + i + 5 * j + 20 * k; }

inline const glm::ivec3 kPatternDims{5, 4, 3};

template <class T>
Volume pattern_volume() {
  Volume volume;
  volume.dims = kPatternDims;
  std::vector<T> samples;
  for (int k = 0; k < volume.dims.z; ++k) {
    for (int j = 0; j < volume.dims.y; ++j) {
      for (int i = 0; i < volume.dims.x; ++i) samples.push_back(static_cast<T>(pattern(i, j, k)));
    }
  }
  volume.samples = std::move(samples);
  return volume;
}

inline double value_at(const Volume& volume, int i, int j, int k) {
  return std::visit(
      [&](const auto& values) {
        return static_cast<double>(values[volume.place({i, j, k})]);
      },
      volume.samples);
}

// Whether all samples are `slope` times the pattern and `offset`.
inline bool holds_pattern(const Volume& volume, double slope = 1, double offset = 0) {
  if (volume.dims != kPatternDims) return false;
  for (int k = 0; k < volume.dims.z; ++k) {
    for (int j = 0; j < volume.dims.y; ++j) {
      for (int i = 0; i < volume.dims.x; ++i) {
        if (value_at(volume, i, j, k) != slope * pattern(i, j, k) + offset) return false;
      }
    }
  }
  return true;
}

// The samples' bytes, x fastest.
template <class T>
std::string sample_bytes(const Volume& volume, std::endian order = std::endian::little) {
  std::string bytes;
  for (const T value : std::get<std::vector<T>>(volume.samples)) bytes += bytes_of(value, order);
  return bytes;
}

inline std::string gzip(const std::string& bytes) {
  z_stream stream{};
  constexpr int kGzip = 15 + 16;
  deflateInit2(&stream, 9, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&stream, bytes.size()) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

inline VolumeFile read(const std::string& path) { return read_volume(path, std::nullopt, Job()); }

// What the refusal says; empty if the file is read, or the error is of another kind.
inline std::string refusal(const std::string& path) {
  try {
    (void)read(path);
  } catch (const Error& error) {
    return error.kind() == ErrorKind::input ? error.what() : "";
  }
  return "";
}

}  // namespace sdfgrid::testing
