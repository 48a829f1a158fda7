// Samples without a header; declared in read_formats.h.
#include <fmt/format.h>

#include <array>
#include <fstream>

#include "sdfgrid/core/error.h"
#include "sdfgrid/volume/read_formats.h"

namespace sdfgrid::volume_io {

VolumeFile read_raw(const std::string& path, const RawLayout& layout, const Job& job) {
  VolumeFile file;
  file.format = "raw";
  file.volume.samples = samples_of_type(layout.type);
  std::array<std::uint64_t, 3> dims{};
  for (int a = 0; a < 3; ++a) {
    if (layout.dims[a] < 1) throw Error(ErrorKind::usage, "a raw shape has three sizes above 0");
    dims[a] = static_cast<std::uint64_t>(layout.dims[a]);
  }
  const std::uint64_t bytes = set_dims(path, dims, file.volume);
  const std::uint64_t size = file_size(path);
  const std::uint64_t follow = size > layout.skip ? size - layout.skip : 0;
  if (bytes > follow) {
    throw input_error(path, fmt::format("byte {}", size),
                      fmt::format("{} bytes are too few for {} x {} x {} samples of type {}, which "
                                  "take {}",
                                  follow, dims[0], dims[1], dims[2], layout.type, bytes),
                      "correct the stated shape or type");
  }
  if (bytes < follow) {
    file.warnings.push_back(
        fmt::format("{} bytes behind the samples were passed over", follow - bytes));
  }
  allocate(path, file.volume, 0);
  std::ifstream in(path, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(layout.skip));
  read_samples(path, in, layout.big_endian, file.volume, job);
  return file;
}

}  // namespace sdfgrid::volume_io
