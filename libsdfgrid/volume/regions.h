// volume/regions.h: connected pieces of what is inside a volume's surface.
#pragma once

#include <cstddef>

#include "sdfgrid/core/job.h"
#include "sdfgrid/volume/isosurface.h"
#include "sdfgrid/volume/volume.h"

namespace sdfgrid {

// Leaves only the largest of the regions inside the surface that `options` describe: samples of
// all others get the outermost value that the volume has. Regions are connected through faces of
// samples; of two equally large ones the first in the order of the samples stays. Returns how many
// were taken away. Scans come with supports and noise that are no part of what was scanned.
std::size_t keep_largest_region(Volume& volume, const IsosurfaceOptions& options, const Job& job);

}  // namespace sdfgrid
