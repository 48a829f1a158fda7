// grid/methods.h: all the ways from a mesh to a distance grid under one signature, ours and the
// peers that they are measured against.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/mesh/soup.h"

namespace sdfgrid {

struct ConvertMethod {
  std::string name;  // as on the command line
  std::string help;  // half a sentence
  bool peer = false;
  // Of the options, voxel or dim, band and sign count. Throws as convert_mesh() does.
  std::function<Conversion(const TriangleSoup& soup, const ConvertOptions& options, const Job& job)>
      convert;
};

// Exact first, then the transforms that meshes are converted by, then the peers:
// - `openvdb`: OpenVDB's meshToVolume;
// - `sweep`: OpenVDB's fast sweeping (dilateSdf) from our exact seeds of half-width 1.
[[nodiscard]] const std::vector<ConvertMethod>& convert_methods();

}  // namespace sdfgrid
