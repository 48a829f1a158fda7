// NIfTI-1 and -2 by libnifti; declared in read_formats.h. libnifti trusts headers, so what would
// make it allocate too much, or guess, is looked at first.
#include <fmt/format.h>
#include <nifti/nifti2_io.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/volume/read_formats.h"

namespace sdfgrid::volume_io {
namespace {

constexpr const char* kExportAgain = "export it again as NIfTI";

struct FreeImage {
  void operator()(nifti_image* image) const { nifti_image_free(image); }
};
using ImagePointer = std::unique_ptr<nifti_image, FreeImage>;

bool is_compressed(const std::string& path) { return path.ends_with("z") || path.ends_with("Z"); }

// What both versions' headers say that matters before libnifti interprets the rest.
struct Header {
  int version = 0;
  std::array<std::int64_t, 8> dim{};
  int datatype = 0;
  bool samples_follow = false;  // in the same file
};

template <class T>
Header header_of(const void* bytes, int version) {
  T raw;
  std::memcpy(&raw, bytes, sizeof(raw));
  Header header;
  header.version = version;
  std::copy(std::begin(raw.dim), std::end(raw.dim), header.dim.begin());
  header.datatype = raw.datatype;
  header.samples_follow = raw.magic[0] == 'n' && raw.magic[1] == '+';
  return header;
}

Header read_header(const std::string& path) {
  int version = -1;
  const std::unique_ptr<void, decltype(&std::free)> bytes(
      nifti_read_header(path.c_str(), &version, 0), &std::free);
  if (!bytes || (version != 1 && version != 2)) {
    throw input_error(path, "byte 0", "it does not begin with the header of a NIfTI file",
                      "check the file's format, and that the copy is complete");
  }
  const auto header_now = [&] {
    return version == 1 ? header_of<nifti_1_header>(bytes.get(), 1)
                        : header_of<nifti_2_header>(bytes.get(), 2);
  };
  Header header = header_now();
  if (header.dim[0] < 1 || header.dim[0] > 7) {  // how the format tells the other byte order
    swap_nifti_header(bytes.get(), version);
    header = header_now();
  }
  if (!header.samples_follow) {
    throw input_error(path, "header", "the samples are not in this file",
                      "pairs of .hdr and .img are not read: convert them to .nii");
  }
  return header;
}

Samples samples_of(const std::string& path, int datatype) {
  constexpr std::array<std::pair<int, const char*>, 10> kTypes = {{{DT_UINT8, "uint8"},
                                                                   {DT_INT8, "int8"},
                                                                   {DT_UINT16, "uint16"},
                                                                   {DT_INT16, "int16"},
                                                                   {DT_UINT32, "uint32"},
                                                                   {DT_INT32, "int32"},
                                                                   {DT_UINT64, "uint64"},
                                                                   {DT_INT64, "int64"},
                                                                   {DT_FLOAT32, "float32"},
                                                                   {DT_FLOAT64, "float64"}}};
  for (const auto& [code, name] : kTypes) {
    if (code == datatype) return samples_of_type(name);
  }
  throw input_error(path, "header", fmt::format("samples of type {}", datatype),
                    "convert colours and complex numbers to integers or floats");
}

void set_geometry(const std::string& path, const nifti_image& image, VolumeFile& file) {
  const bool sform = image.sform_code > 0;
  if (!sform && image.qform_code <= 0) {
    file.volume.spacing = {image.dx, image.dy, image.dz};
    file.warnings.emplace_back(
        "the header has no orientation: index axes are taken for the world's");
    return;
  }
  const auto& m = sform ? image.sto_xyz.m : image.qto_xyz.m;
  glm::dmat3 steps(1.0);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) steps[column][row] = m[row][column];
    file.volume.origin[row] = m[row][3];
  }
  set_axes(path, steps, file.volume);
}

// Throws if the header announces what libnifti would take for something else, or too much.
void set_shape(const std::string& path, const Header& header, Volume& volume) {
  const std::int64_t axes = header.dim[0];
  if (axes < 1 || axes > 7) {
    throw input_error(path, "header", fmt::format("{} axes", axes), kExportAgain);
  }
  std::array<std::uint64_t, 3> dims = {1, 1, 1};
  for (int a = 1; a <= axes; ++a) {
    if (a <= 3) {
      dims[a - 1] = static_cast<std::uint64_t>(std::max<std::int64_t>(header.dim[a], 0));
    } else if (header.dim[a] > 1) {
      throw input_error(path, "header", fmt::format("{} volumes or channels", header.dim[a]),
                        "take one volume out of the series");
    }
  }
  const std::uint64_t bytes = set_dims(path, dims, volume);
  check_claim(path, bytes, file_size(path), is_compressed(path) ? kDeflateRatio : 1);
}

// Throws if fewer samples follow than announced; compressed ones show when they are read.
void check_samples(const std::string& path, const nifti_image& image, const Volume& volume) {
  if (is_compressed(path)) return;
  const std::uint64_t size = file_size(path);
  const auto offset = static_cast<std::uint64_t>(std::max<std::int64_t>(image.iname_offset, 0));
  check_claim(path, volume.size() * bytes_per_sample(volume.samples),
              size > offset ? size - offset : 0, 1);
}

// What scl_slope and scl_inter make of the samples.
void scale(const nifti_image& image, Volume& volume, const Job& job) {
  const double slope = image.scl_slope;
  const double inter = image.scl_inter;
  if (slope == 0 || !std::isfinite(slope) || (slope == 1 && inter == 0)) return;
  std::vector<float> scaled(volume.size());
  std::visit(
      [&](const auto& values) {
        parallel_for(
            values.size(), std::size_t{1} << 18U, job, [&](std::size_t begin, std::size_t end) {
              for (std::size_t n = begin; n < end; ++n) {
                scaled[n] = static_cast<float>(slope * static_cast<double>(values[n]) + inter);
              }
            });
      },
      volume.samples);
  volume.samples = std::move(scaled);
}

}  // namespace

VolumeFile read_nifti(const std::string& path, const Job& job) {
  (void)file_size(path);
  nifti_set_debug_level(0);  // the library prints otherwise
  VolumeFile file;
  const Header header = read_header(path);
  file.format = fmt::format("NIfTI-{}", header.version);
  file.volume.samples = samples_of(path, header.datatype);
  set_shape(path, header, file.volume);
  const ImagePointer image(nifti_image_read(path.c_str(), 0));
  if (!image) throw input_error(path, "header", "libnifti cannot make sense of it", kExportAgain);
  check_samples(path, *image, file.volume);
  set_geometry(path, *image, file);
  allocate(path, file.volume, 1);
  job.checkpoint();
  job.report("read", 0.0);
  const std::uint64_t bytes = file.volume.size() * bytes_per_sample(file.volume.samples);
  if (nifti_image_load(image.get()) != 0 || image->data == nullptr ||
      static_cast<std::uint64_t>(image->nvox * image->nbyper) != bytes) {
    throw input_error(path, "samples", "they end early or are damaged", kCopyAgain);
  }
  job.checkpoint();
  std::visit([&](auto& values) { std::memcpy(values.data(), image->data, bytes); },
             file.volume.samples);
  scale(*image, file.volume, job);
  return file;
}

}  // namespace sdfgrid::volume_io
