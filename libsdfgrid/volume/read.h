// volume/read.h: volumes from files.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/volume/volume.h"

namespace sdfgrid {

// What a raw file does not say of itself.
struct RawLayout {
  glm::ivec3 dims{0};          // x runs fastest in the file
  std::string type = "uint8";  // one of type_names()
  bool big_endian = false;
  std::size_t skip = 0;  // bytes before the first sample
};

struct VolumeFile {
  Volume volume;
  std::string format;                 // "NRRD gzip", "NIfTI-1", ...
  std::vector<std::string> warnings;  // what was guessed or passed over
};

// Whether a file of this name is read by read_volume().
[[nodiscard]] bool is_volume_name(const std::string& path);

// Reads, by the file's extension,
// - .nrrd, .nhdr: NRRD, data attached or detached, in any of its encodings and byte orders, by
// teem;
// - .nii, .nii.gz: NIfTI-1 and -2, by libnifti; a scaling other than 1 and 0 makes floats of the
//   samples;
// - .npy: numpy arrays of two or three axes, array[i, j, k];
// - .raw: as `raw` says, which must then be given.
//
// Positions are those of the file's own world (patient axes in NRRD and NIfTI), in its own units:
// spacing, origin and axes are kept, nothing is turned. Where a file says nothing of them, spacing
// is 1 and origin 0.
//
// Throws Error{input}, with file, place and remedy, for what is missing, malformed, truncated, not
// finite, not of three dimensions or announces more than its bytes can hold (before memory is taken
// for it); Error{usage} for a .raw file without a layout; Error{failed} if the memory does not
// suffice; Error{cancelled}.
[[nodiscard]] VolumeFile read_volume(const std::string& path, const std::optional<RawLayout>& raw,
                                     const Job& job);

}  // namespace sdfgrid
