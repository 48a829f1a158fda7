// grid/convert.h: from a mesh to a sparse distance grid, exact to rounding.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/mesh/soup.h"
#include "sdfgrid/transform/transform.h"
#include "sdfgrid/voxelize/band.h"
#include "sdfgrid/voxelize/mesh_sign.h"

namespace sdfgrid {

struct ConvertOptions {
  double voxel = 0;  // world units; if 0, `dim` decides
  int dim = 256;     // voxels along the longest side of the mesh's bounds
  Band band;
  SignMethod sign = SignMethod::automatic;
  // Distances by a transform from exact seeds beside the surface; nothing: exact everywhere. Of its
  // options method, bucket_width and steps count.
  std::optional<TransformOptions> transform{};
  // Bytes that the conversion may take; 0 means 80 % of what the machine has free.
  std::size_t max_memory = 0;
};

struct ConvertSeconds {
  double sign = 0;      // topology, orientation, winding tree
  double voxelize = 0;  // bricks; with a transform the seeds and it
  double assemble = 0;  // the tree and its interior
};

struct Conversion {
  Grid grid;
  SignMethod sign = SignMethod::no_sign;
  std::string sign_reason;
  std::vector<std::string> warnings;
  ConvertSeconds seconds;
};

// Largest error of a stored value against the exact distance, in voxels: at most 1e-5 up to 25
// voxels from the surface, beyond that 4e-7 of the distance (docs/methods.md says why).
[[nodiscard]] double convert_error(const Band& band);

// The lattice for a mesh: the voxel size asked for, samples at whole multiples of it (counted from
// near the mesh where it is far from zero). Throws Error{usage} if neither voxel nor dim makes
// sense.
[[nodiscard]] Lattice choose_lattice(const TriangleSoup& soup, const ConvertOptions& options);

// About how many bytes convert_mesh will take at its peak.
[[nodiscard]] double estimate_memory(const TriangleSoup& soup, const Lattice& lattice,
                                     const ConvertOptions& options);

// Exact distances (or what the transform makes of exact ones beside the surface) at every lattice
// point of the band, sign included; beyond the band plus and minus
// background. Throws Error{usage} for options out of range, Error{input} for an empty mesh,
// Error{failed} if the estimate exceeds the memory allowed, before any work starts.
[[nodiscard]] Conversion convert_mesh(const TriangleSoup& soup, const ConvertOptions& options,
                                      const Job& job);

}  // namespace sdfgrid
