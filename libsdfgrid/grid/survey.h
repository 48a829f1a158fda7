// grid/survey.h: how a grid's error depends on where it is measured. Distance fields are smooth in
// most places, have creases beside edges, and break along the medial axis; methods differ most in
// the last two.
#pragma once

#include <array>
#include <memory>
#include <string_view>

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/compare.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/mesh/soup.h"

namespace sdfgrid {

enum class FieldPart {
  smooth,  // neither of the others
  edge,    // the nearest point is within a voxel of an edge whose faces meet at 30 degrees or more
  medial,  // a neighbouring sample's nearest point is more than three voxels from this sample's
};
inline constexpr std::array<std::string_view, 3> kFieldParts = {"smooth", "edge", "medial"};

// A surface that many grids are measured against: turned the way in which the converter turns it,
// with the independent reference distance (mesh/reference.h) to it and to its edges.
class SurfaceTruth {
 public:
  // Throws Error{input} if the mesh has no triangles or coordinates that are not finite.
  SurfaceTruth(const TriangleSoup& mesh, const Job& job);

  struct Data;
  [[nodiscard]] const Data& data() const { return *data_; }

 private:
  std::shared_ptr<const Data> data_;
};

struct Survey {
  double voxel = 0;
  ErrorSummary between;  // trilinear values at random points of cells with eight active corners
  ErrorSummary voxels;   // stored values of active voxels
  std::array<ErrorSummary, 3> parts;  // the same, by FieldPart
};

// Measures as compare() does, and by parts. The same result at any number of threads. Throws
// Error{input} if the grid has no active voxels, Error{cancelled}.
[[nodiscard]] Survey survey(const Grid& grid, const SurfaceTruth& truth,
                            const CompareOptions& options, const Job& job);

}  // namespace sdfgrid
