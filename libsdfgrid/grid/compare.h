// grid/compare.h: how far a distance grid is from the truth: from the mesh that it was made of,
// measured by mesh/reference.h, which shares nothing with the converter, or from another grid.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/mesh/soup.h"

namespace sdfgrid {

struct CompareOptions {
  std::size_t samples = 100000;  // of each kind at most; voxels all if there are no more
  std::uint64_t seed = 1;
};

// Errors of some samples, world units. Nearest-rank percentile; the mean is of absolute values.
struct ErrorSummary {
  std::size_t samples = 0;
  double max_error = 0;
  double rms_error = 0;
  double p99_error = 0;
  double mean_error = 0;
  std::size_t sign_errors = 0;
  glm::dvec3 worst{0.0};  // where max_error was found, world units
};

struct Comparison {
  double voxel = 0;     // world units, of the (first) grid
  bool signs = true;    // false if one side has no signs: then absolute values were compared
  ErrorSummary voxels;  // stored values of active voxels
  ErrorSummary
      interpolated;  // trilinear values at random points of cells with eight active corners
  // Inactive voxels and tiles beside the band and around it. Their value is a bound, "at least so
  // far, and on this side", and its error is what the truth falls short of it.
  ErrorSummary inactive;
  std::size_t wrong_constants = 0;  // inactive samples with neither of the two backgrounds in them
  // Samples that an open mesh leaves undecided: its winding number is within 0.01 of 1/2 there.
  // They are compared by absolute value.
  std::size_t undecided_signs = 0;
  std::vector<std::string> warnings;  // what was turned, what could not be measured

  // Signs of all that is stored.
  [[nodiscard]] std::size_t sign_errors() const {
    return voxels.sign_errors + inactive.sign_errors;
  }
  // Whether all that is stored is within `error` (world units) of the truth, with the right sign.
  [[nodiscard]] bool within(double error) const {
    return sign_errors() == 0 && voxels.max_error <= error && inactive.max_error <= error;
  }
};

// Measures `grid` against `mesh`. Inside is where the mesh's winding number is above 1/2, after it
// was turned the way in which the converter turns inside-out meshes and nested shells (a warning
// says so).
//
// A sign is wrong where the truth is further from zero than rounding explains (1e-4 voxel) or,
// between the voxels, than trilinear interpolation of exact distances can go wrong (sqrt(3)/2
// voxel: the root mean square distance from a point to its cell's corners, weighted as they are, is
// at most that).
//
// The same result at any number of threads. Throws Error{input} if the grid has no active voxels or
// the mesh no triangles, Error{cancelled}.
[[nodiscard]] Comparison compare(const Grid& grid, const TriangleSoup& mesh,
                                 const CompareOptions& options, const Job& job);

// Measures at the voxels and in the cells of both grids; where one has no voxel the other's
// trilinear value, or its bound beyond the band, stands in.
[[nodiscard]] Comparison compare(const Grid& a, const Grid& b, const CompareOptions& options,
                                 const Job& job);

struct SurfaceComparison {
  ErrorSummary a_to_b;  // distances from random points of a's surface to b; no signs
  ErrorSummary b_to_a;

  // Sampled Hausdorff distance, world units: a lower bound of the exact one.
  [[nodiscard]] double hausdorff() const {
    return a_to_b.max_error > b_to_a.max_error ? a_to_b.max_error : b_to_a.max_error;
  }
};

// Measures meshes against each other at points spread evenly over their areas.
[[nodiscard]] SurfaceComparison compare(const TriangleSoup& a, const TriangleSoup& b,
                                        const CompareOptions& options, const Job& job);

}  // namespace sdfgrid
