// volume/write.h: volumes to files, whole or not at all.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/volume/volume.h"

namespace sdfgrid {

// The extensions that write_volume knows, lower case with the dot.
[[nodiscard]] const std::vector<std::string>& volume_extensions();

// Writes, by the path's extension,
// - .npy: numpy's array[i, j, k] of shape dims, without spacing or position;
// - .nrrd: attached header, raw, with spacing, origin and axes;
// - .vti: VTK image data for ParaView, raw, with the same.
//
// Samples are written in their own type, little endian. Throws Error{usage} for other extensions,
// Error{failed} where writing fails, Error{cancelled}.
void write_volume(const Volume& volume, const std::string& path, const Job& job);

// Writes a numpy array of two axes, `values` row by row, as a .npy file. Throws Error{usage} if
// they are no whole rows, Error{failed} where writing fails.
void write_table(std::span<const double> values, std::size_t columns, const std::string& path);

}  // namespace sdfgrid
