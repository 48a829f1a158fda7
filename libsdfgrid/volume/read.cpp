#include "sdfgrid/volume/read.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <type_traits>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/memory.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/volume/read_formats.h"

namespace sdfgrid {
namespace volume_io {

namespace fs = std::filesystem;

std::uint64_t file_size(const std::string& path) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (!fs::exists(status)) {
    throw input_error(path, "", "there is no such file", "check the path");
  }
  if (!fs::is_regular_file(status)) {
    throw input_error(path, "", "it is not a plain file", "name a volume's file");
  }
  if (!std::ifstream(path)) {
    throw input_error(path, "", "it cannot be opened", "check its permissions");
  }
  const std::uint64_t size = fs::file_size(path, error);
  if (error || size == 0) {
    throw input_error(path, "byte 0", "the file is empty", "export it again");
  }
  return size;
}

std::uint64_t set_dims(const std::string& path, const std::array<std::uint64_t, 3>& dims,
                       Volume& volume) {
  constexpr std::uint64_t kMost = 0x7fffffff;
  std::uint64_t bytes = bytes_per_sample(volume.samples);
  for (int a = 0; a < 3; ++a) {
    if (dims[a] < 1 || dims[a] > kMost) {
      throw input_error(path, "header", fmt::format("axis {} has {} samples", a, dims[a]),
                        "1 to 2^31 - 1 are possible: export it again");
    }
    if (bytes > (std::uint64_t{1} << 63U) / dims[a]) {
      throw input_error(path, "header",
                        fmt::format("{} x {} x {} samples", dims[0], dims[1], dims[2]),
                        "no machine holds that: export it again");
    }
    bytes *= dims[a];
    volume.dims[a] = static_cast<int>(dims[a]);
  }
  return bytes;
}

void check_claim(const std::string& path, std::uint64_t claimed, std::uint64_t available,
                 double ratio) {
  if (static_cast<double>(claimed) <= ratio * static_cast<double>(available)) return;
  throw input_error(path, "header",
                    fmt::format("it announces {} bytes of samples, and {} bytes{} follow", claimed,
                                available, ratio > 1 ? ", compressed," : ""),
                    "the file is truncated or its sizes are wrong: copy or export it again");
}

void allocate(const std::string& path, Volume& volume, int copies) {
  const double bytes = static_cast<double>(volume.size()) *
                       static_cast<double>(bytes_per_sample(volume.samples)) * (1.0 + copies);
  check_fits(bytes, path + ": reading it", "cut or scale the volume down");
  std::visit([&](auto& values) { values.resize(volume.size()); }, volume.samples);
}

namespace {

template <class T>
void turn_bytes(std::vector<T>& values, const Job& job) {
  parallel_for(values.size(), std::size_t{1} << 18U, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(values[n]);
      std::reverse(bytes.begin(), bytes.end());
      values[n] = std::bit_cast<T>(bytes);
    }
  });
}

}  // namespace

void read_samples(const std::string& path, std::istream& in, bool big_endian, Volume& volume,
                  const Job& job) {
  const bool turn = big_endian != (std::endian::native == std::endian::big);
  std::visit(
      [&](auto& values) {
        constexpr std::size_t kChunk = std::size_t{1} << 24U;
        const std::size_t bytes = values.size() * sizeof(values[0]);
        for (std::size_t at = 0; at < bytes; at += kChunk) {
          job.checkpoint();
          job.report("read", static_cast<double>(at) / static_cast<double>(bytes));
          const std::size_t want = std::min(kChunk, bytes - at);
          in.read(reinterpret_cast<char*>(values.data()) + at, static_cast<std::streamsize>(want));
          if (static_cast<std::size_t>(in.gcount()) < want) {
            throw input_error(path, fmt::format("sample byte {}", at + in.gcount()),
                              fmt::format("the samples end early, {} bytes were expected", bytes),
                              kCopyAgain);
          }
        }
        if (turn && sizeof(values[0]) > 1) turn_bytes(values, job);
      },
      volume.samples);
}

void set_axes(const std::string& path, const glm::dmat3& steps, Volume& volume) {
  for (int a = 0; a < 3; ++a) {
    volume.spacing[a] = glm::length(steps[a]);
    volume.axes[a] = steps[a] / volume.spacing[a];
  }
  // Catches zero and infinite lengths too.
  if (!(std::abs(glm::determinant(volume.axes)) > 1e-3)) {
    throw input_error(path, "header", "the axes of the samples span no volume",
                      "correct the spacing or orientation in the header");
  }
}

}  // namespace volume_io

namespace {

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool has_extension(const std::string& path, std::initializer_list<const char*> extensions) {
  const std::string name = lower(path);
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const char* extension) { return name.ends_with(extension); });
}

// The place of the first sample that is not finite, or size.
std::size_t first_not_finite(const Samples& samples, const Job& job) {
  return std::visit(
      [&](const auto& values) {
        std::atomic<std::size_t> first{values.size()};
        if constexpr (std::is_floating_point_v<std::decay_t<decltype(values[0])>>) {
          parallel_for(values.size(), std::size_t{1} << 18U, job,
                       [&](std::size_t begin, std::size_t end) {
                         for (std::size_t n = begin; n < end; ++n) {
                           if (std::isfinite(values[n])) continue;
                           std::size_t known = first;
                           while (n < known && !first.compare_exchange_weak(known, n)) {
                           }
                           return;
                         }
                       });
        }
        return first.load();
      },
      samples);
}

void check_finite(const std::string& path, const Volume& volume, const Job& job) {
  const std::size_t n = first_not_finite(volume.samples, job);
  if (n == volume.size()) return;
  const std::size_t row = n / volume.dims.x;
  throw input_error(path,
                    fmt::format("sample ({}, {}, {})", n % volume.dims.x, row % volume.dims.y,
                                row / volume.dims.y),
                    "it is not a finite number", "replace NaN and infinity by what they stand for");
}

void check_geometry(const std::string& path, const Volume& volume) {
  for (int a = 0; a < 3; ++a) {
    if (!(std::isfinite(volume.spacing[a]) && volume.spacing[a] > 0) ||
        !std::isfinite(volume.origin[a])) {
      throw input_error(path, "header",
                        fmt::format("axis {} has the spacing {} and the origin {}", a,
                                    volume.spacing[a], volume.origin[a]),
                        "correct them in the header");
    }
  }
}

}  // namespace

bool is_volume_name(const std::string& path) {
  return has_extension(path, {".nrrd", ".nhdr", ".nii", ".nii.gz", ".npy", ".raw"});
}

VolumeFile read_volume(const std::string& path, const std::optional<RawLayout>& raw,
                       const Job& job) {
  const auto read = [&]() -> VolumeFile {
    if (has_extension(path, {".nrrd", ".nhdr"})) return volume_io::read_nrrd(path, job);
    if (has_extension(path, {".nii", ".nii.gz"})) return volume_io::read_nifti(path, job);
    if (has_extension(path, {".npy"})) return volume_io::read_npy(path, job);
    if (!has_extension(path, {".raw"})) {
      throw input_error(path, "name", "it is not named as a volume",
                        "give .nrrd, .nhdr, .nii, .nii.gz, .npy or .raw");
    }
    if (!raw) {
      throw Error(ErrorKind::usage, path + ": a raw file says nothing of itself; state its shape");
    }
    return volume_io::read_raw(path, *raw, job);
  };
  VolumeFile file = read();
  check_geometry(path, file.volume);
  check_finite(path, file.volume, job);
  job.report("read", 1.0);
  return file;
}

}  // namespace sdfgrid
