// grid/choose.h: the coarsest grid, made the cheapest way, that is as accurate as asked.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/grid/convert_field.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/grid/survey.h"

namespace sdfgrid {

struct ChooseOptions {
  double tolerance = 0;              // world units, > 0
  std::vector<std::string> methods;  // of convert_methods(); empty: all but peers
  double budget_seconds = 0;         // for the whole search; 0: none
  double budget_bytes = 0;           // for a conversion, as estimate_memory() has it; 0: none
  CompareOptions compare{.samples = 50000};
};

// One conversion that was tried.
struct Trial {
  std::string method;
  int dim = 0;
  double voxel = 0;
  double seconds = 0;
  // The largest of the trilinear field at the samples, world units; not a number if it was not
  // measured, as the conversion took too long to be chosen whatever its error.
  double error = 0;
};

struct Choice {
  Conversion conversion;
  Trial chosen;
  bool within = false;        // whether it is within the tolerance
  std::string why_not;        // if not: what ended the search
  std::vector<Trial> trials;  // in the order in which they were tried
};

// The resolutions that are tried: voxels along the longest side, each step finer by a factor of
// about the square root of two, from 8 to 16384.
[[nodiscard]] const std::vector<int>& choice_dims();

// Tries resolutions from the coarsest on. At each the first method (exact, unless others are named)
// is measured at random places in the band's cells, interpolation included, against the independent
// reference; the first resolution at which it stays within the tolerance is taken, since the mesh's
// exact distances are what every other method approximates. There the other methods are tried, and
// one replaces it if it takes at most four fifths of its time and stays within too.
//
// If a budget ends the search, the most accurate grid found so far is returned and says why.
// `convert` gives band, sign and what methods need of its transform; its voxel and dim do not
// count. A method that cannot do the band is left out unless it is the first. Throws as
// convert_mesh() does, and Error{usage} for a tolerance that is not positive or an unknown method.
[[nodiscard]] Choice choose_conversion(const TriangleSoup& soup, const ConvertOptions& convert,
                                       const ChooseOptions& options, const Job& job);

// The same for a field, whose grid holds its own values: the first resolution at which what is read
// between the voxels is within the tolerance of the field itself. Methods are not to be chosen;
// budget_bytes is held against what the grid before took, doubled. Throws as convert_field() does,
// and Error{usage} for a tolerance that is not positive or if methods are named.
[[nodiscard]] Choice choose_conversion(const Field& field, const FieldConvertOptions& convert,
                                       const ChooseOptions& options, const Job& job);

}  // namespace sdfgrid
