// apps/sdfgrid/chart_data.h: the points of a chart of speed against accuracy, and the tables made
// of them.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "command.h"
#include "sdfgrid/grid/survey.h"

namespace sdfgrid::cli {

// One method at one resolution. Errors are in world units, as in `Survey`.
struct ChartPoint {
  std::string method;
  bool peer = false;
  int dim = 0;
  double seconds = 0;      // processor time on one thread, else wall-clock; best of the repetitions
  double peak_memory = 0;  // bytes beyond what was taken before
  std::size_t bytes = 0;   // of the grid
  std::size_t active_voxels = 0;
  Survey survey;
  bool on_front = false;
};

// Marks the points that no other point beats in both time and largest error between the voxels.
void mark_front(std::vector<ChartPoint>& points);

// The order of convergence of one method in one part of the field: the slope of log rms error of
// its voxels over log voxel size, by least squares. Not a number with fewer than two resolutions
// that have voxels there.
[[nodiscard]] double order_of(const std::vector<ChartPoint>& points, const std::string& method,
                              std::size_t part);

// The methods in the order of the points, each once.
[[nodiscard]] std::vector<std::string> methods_of(const std::vector<ChartPoint>& points);

// One row a point.
[[nodiscard]] std::string csv_of(const std::vector<ChartPoint>& points);

// {"points": [...], "orders": {method: {smooth, edge, medial}}}
[[nodiscard]] Json json_of(const std::vector<ChartPoint>& points);

}  // namespace sdfgrid::cli
