// apps/sdfgrid/chart_plot.h: the chart of speed against accuracy as a picture, drawn by gnuplot.
#pragma once

#include <string>
#include <vector>

#include "chart_data.h"

namespace sdfgrid::cli {

struct ChartText {
  std::string title;    // "bunny00.off: speed against accuracy"
  std::string caption;  // the machine, and the command that made the chart; lines
  std::string time;     // what the time axis shows
  double size = 1;      // the input's longest side, world units: errors are drawn in percent of it
};

// Draws to `path`, an .svg or a .png, which appears whole or not at all. Throws Error{failed} if
// gnuplot cannot be run or fails.
void draw_chart(const std::vector<ChartPoint>& points, const ChartText& text,
                const std::string& path);

}  // namespace sdfgrid::cli
