// volume/read_formats.h: one reader a format, and what they share. Internal to volume/read.h.
#pragma once

#include <cstdint>
#include <istream>
#include <string>

#include "sdfgrid/volume/read.h"

namespace sdfgrid::volume_io {

inline constexpr const char* kCopyAgain = "the file is truncated: copy or export it again";

// Bytes of a plain file. Throws Error{input} if there is none or it is empty.
[[nodiscard]] std::uint64_t file_size(const std::string& path);

// Sets volume.dims, once all three sizes are within 1 to 2^31 - 1 and the product of their bytes
// within 2^63. Returns these bytes; throws Error{input} otherwise.
std::uint64_t set_dims(const std::string& path, const std::array<std::uint64_t, 3>& dims,
                       Volume& volume);

// Throws Error{input} if a header announces more bytes than `available` ones can hold, when one
// byte of the file makes at most `ratio` of the volume.
void check_claim(const std::string& path, std::uint64_t claimed, std::uint64_t available,
                 double ratio);

// What zlib's deflate compresses to one byte at best.
inline constexpr double kDeflateRatio = 1032;

// Makes room for volume.size() samples, and `copies` times as much elsewhere. Throws Error{failed}
// if the machine has not that much.
void allocate(const std::string& path, Volume& volume, int copies);

// Fills the samples from a stream that stands at the first, and turns their bytes if the file's
// order is not the machine's.
void read_samples(const std::string& path, std::istream& in, bool big_endian, Volume& volume,
                  const Job& job);

// The lengths and directions of three index axes; throws Error{input} if one is zero or they lie in
// a plane.
void set_axes(const std::string& path, const glm::dmat3& steps, Volume& volume);

VolumeFile read_nifti(const std::string& path, const Job& job);
VolumeFile read_npy(const std::string& path, const Job& job);
VolumeFile read_nrrd(const std::string& path, const Job& job);
VolumeFile read_raw(const std::string& path, const RawLayout& layout, const Job& job);

}  // namespace sdfgrid::volume_io
