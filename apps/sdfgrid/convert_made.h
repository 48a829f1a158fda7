// apps/sdfgrid/convert_made.h: what convert was asked for and what it made, of whatever input: how
// that is saved and told.
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "inputs.h"
#include "methods.h"
#include "options.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/volume/volume.h"
#include "sdfgrid/voxelize/band.h"
#include "tolerance.h"

namespace sdfgrid::cli {

struct ConvertRequest {
  std::string input;
  Output output;
  ConvertOptions convert;
  std::string method = "exact";      // of convert_methods()
  std::vector<std::string> methods;  // for the tolerance; empty: all
  TransformChoice transform;
  double width = 3.0;
  double exwidth = 0;  // 0: as --width
  double inwidth = 0;
  bool dense = false;
  std::optional<int> dim;
  SurfaceOptions surface;
  ToleranceOptions tolerance;
  double time = 0;
};

[[nodiscard]] Band band_of(const ConvertRequest& options);

// What was made, and what is to be said of it.
struct Made {
  Grid grid;
  std::optional<Volume> dense;  // instead of the grid
  std::string method;
  std::string sign;
  std::string sign_reason;
  std::optional<double> max_error;                  // world units; none is stated of a scene
  std::optional<glm::dvec3> origin = std::nullopt;  // of sample (0, 0, 0), once written densely
};

// Throws Error{usage} if the output cannot hold voxels of that size; call it before any work.
void check_voxel(const ConvertRequest& options, double voxel);

// Warns of a result that would surprise whoever opens it; `source` is "mesh", "surface" or "scene".
void warn_of_nothing(const Made& made, const std::string& source, Context& context);

// Says that a volume holds no paint.
void warn_of_lost_paint(const std::string& path, Context& context);

// Whether the output is a grid; else it is a volume, all samples of a box, without paint.
[[nodiscard]] bool becomes_grid(const ConvertRequest& options);

// Makes a grid of what was made densely.
void make_sparse(Made& made, const ConvertRequest& options);

// Writes it as a grid, or densely, as the output's name says.
void save(Made& made, const ConvertRequest& options, Context& context);

// Prints what was made, and fills the result but for its seconds.
void describe(const Made& made, const ConvertRequest& options, Context& context);

// Converts a scene.
Exit convert_scene(const ConvertRequest& options, Context& context);

}  // namespace sdfgrid::cli
