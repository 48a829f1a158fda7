// image/stack.h: volumes that come as pictures: a folder of slices, or a TIFF of many pages.
#pragma once

#include <string>

#include "sdfgrid/core/job.h"
#include "sdfgrid/volume/read.h"

namespace sdfgrid {

// Whether read_image_stack() would try it: a folder, or a file named .tif or .tiff.
[[nodiscard]] bool is_stack_name(const std::string& path);

// Reads a folder's pictures, in the order of the numbers in their names, or the pages of a TIFF.
// All must be grey, of one size and one type, which the samples keep (half becomes float); alpha
// is passed over. Sample (i, j, k) is column i of row j, from the top, of picture k; spacing is 1
// and origin 0, since pictures do not say.
//
// Throws Error{input} for what is missing, not a picture, coloured, truncated or of several sizes,
// naming the picture; Error{failed} if the memory does not suffice; Error{cancelled}.
[[nodiscard]] VolumeFile read_image_stack(const std::string& path, const Job& job);

}  // namespace sdfgrid
