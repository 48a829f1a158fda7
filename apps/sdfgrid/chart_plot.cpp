#include "chart_plot.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/vec2.hpp>

#include "options.h"
#include "sdfgrid/core/atomic_file.h"
#include "sdfgrid/core/error.h"

extern char** environ;

namespace sdfgrid::cli {
namespace {

// The colours of Okabe and Ito, which the colour-blind tell apart too, and three more.
constexpr std::array<const char*, 11> kColours = {"#000000", "#0072b2", "#d55e00", "#009e73",
                                                  "#cc79a7", "#56b4e9", "#e69f00", "#7f3c8d",
                                                  "#8c564b", "#999999", "#66a61e"};
constexpr const char* kGrey = "#b0b0b0";

// A string of gnuplot's in single quotes.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += c;  // doubled
    result += c == '\n' ? ' ' : c;
  }
  return result + "'";
}

double percent(double length, const ChartText& text) {
  constexpr double kFloor = 1e-12;  // an axis of logarithms has no zero
  return std::max(100 * length / text.size, kFloor);
}

// $m0, $m1, ...: seconds, largest, p99 and rms error between voxels, voxel size, rms error of the
// voxels by part; "nan" where there are none.
std::string data_blocks(const std::vector<ChartPoint>& points,
                        const std::vector<std::string>& methods, const ChartText& text) {
  std::string script;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    script += fmt::format("$m{} << EOD\n", m);
    for (const ChartPoint& p : points) {
      if (p.method != methods[m]) continue;
      const ErrorSummary& e = p.survey.between;
      script += fmt::format("{} {} {} {} {}", p.seconds, percent(e.max_error, text),
                            percent(e.p99_error, text), percent(e.rms_error, text),
                            percent(p.survey.voxel, text));
      for (const ErrorSummary& part : p.survey.parts) {
        script += part.samples == 0 ? " nan" : fmt::format(" {}", percent(part.rms_error, text));
      }
      script += '\n';
    }
    script += "EOD\n";
  }
  std::vector<const ChartPoint*> front;
  for (const ChartPoint& p : points) {
    if (p.on_front) front.push_back(&p);
  }
  std::sort(front.begin(), front.end(),
            [](const ChartPoint* a, const ChartPoint* b) { return a->seconds < b->seconds; });
  script += "$front << EOD\n";
  for (const ChartPoint* p : front) {
    script +=
        fmt::format("{} {} {}\n", p->seconds, percent(p->survey.between.max_error, text), p->dim);
  }
  return script + "EOD\n";
}

// Time against the error of the field between the voxels.
std::string speed_panel(const std::vector<std::string>& methods, const ChartText& text) {
  std::string script =
      "set lmargin at screen 0.075; set rmargin at screen 0.56\n"
      "set tmargin at screen 0.90; set bmargin at screen 0.20\n"
      "set xlabel " +
      quoted(text.time) +
      "\n"
      "set ylabel 'error of the interpolated field, % of the longest side' offset 0.5\n"
      "set title 'speed against accuracy: largest error (marks), 99 % and rms (ticks below)'\n"
      "set key inside top right vertical opaque noenhanced width 1\n"
      "plot $front using 1:2 with steps lc rgb '#d0d0d0' lw 7 title 'Pareto front', \\\n"
      "  $front using 1:2 with points pt 6 ps 2.6 lw 2 lc rgb '#606060' notitle, \\\n"
      "  $front using 1:2:3 with labels offset 1.6,0.7 font ',10' tc rgb '#404040' notitle";
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const char* colour = kColours[m % kColours.size()];
    script += fmt::format(
        ", \\\n  $m{0} using 1:2:4:2 with yerrorbars pt 0 lw 1 lc rgb '{1}' notitle"
        ", \\\n  $m{0} using 1:3 with points pt 2 ps 0.6 lc rgb '{1}' notitle"
        ", \\\n  $m{0} using 1:2 with linespoints pt 7 ps 1 lw 1.5 lc rgb '{1}' title {2}",
        m, colour, quoted(methods[m]));
  }
  return script + "\n";
}

// The largest voxel and rms error of a part, for the lines of slopes one and two.
glm::dvec2 corner_of(const std::vector<ChartPoint>& points, std::size_t part,
                     const ChartText& text) {
  glm::dvec2 corner(0.0);
  for (const ChartPoint& p : points) {
    if (p.survey.parts[part].samples == 0) continue;
    corner.x = std::max(corner.x, percent(p.survey.voxel, text));
    corner.y = std::max(corner.y, percent(p.survey.parts[part].rms_error, text));
  }
  return corner;
}

// Error of the voxels over their size, in one part of the field.
std::string order_panel(const std::vector<ChartPoint>& points,
                        const std::vector<std::string>& methods, std::size_t part,
                        const ChartText& text) {
  constexpr double kTop = 0.90, kHeight = 0.213, kStep = 0.2335;
  const double top = kTop - kStep * static_cast<double>(part);
  const bool last = part + 1 == kFieldParts.size();
  std::string script = fmt::format(
      "set lmargin at screen 0.66; set rmargin at screen 0.98\n"
      "set tmargin at screen {:.4f}; set bmargin at screen {:.4f}\n"
      "unset key\n"
      "set title {}\nset xlabel {}\nset format x {}\n"
      "set ylabel {} offset 0.5\n"
      "set label 1 {} at graph 0.98, graph 0.5 right font ',12' front\n",
      top, top - kHeight,
      part == 0 ? "'error at the voxels over their size (dashes: order 1, dots: 2)'"
                : "''",
      last ? "'voxel size, % of the longest side'" : "''", last ? "'%g'" : "''", "'rms error, %'",
      quoted(std::string(kFieldParts[part])));
  const glm::dvec2 corner = corner_of(points, part, text);
  if (!(corner.x > 0)) {
    return script + "set yrange [1e-3:1]\nplot NaN notitle\nset autoscale y\n";
  }
  script += fmt::format(
      "plot {1}*(x/{0}) lc rgb '{2}' dt 2 notitle, {1}*(x/{0})**2 lc rgb '{2}' dt 3 notitle",
      corner.x, corner.y, kGrey);
  for (std::size_t m = 0; m < methods.size(); ++m) {
    script += fmt::format(
        ", \\\n  $m{} using 5:{} with linespoints pt 7 ps 0.7 lw 1.5 lc rgb '{}' notitle", m,
        6 + part, kColours[m % kColours.size()]);
  }
  return script + "\n";
}

std::string script_of(const std::vector<ChartPoint>& points, const ChartText& text,
                      const std::string& terminal, const std::string& output) {
  const std::vector<std::string> methods = methods_of(points);
  double least = 1e300;
  double most = 0;
  for (const ChartPoint& p : points) {
    least = std::min(least, percent(p.survey.voxel, text));
    most = std::max(most, percent(p.survey.voxel, text));
  }
  std::string script = "set terminal " + terminal + "\nset output " + quoted(output) + "\n" +
                       data_blocks(points, methods, text);
  script +=
      "set multiplot\nset logscale xy\nset format y '10^{%L}'\nset grid lc rgb '#e0e0e0'\n"
      "set tics nomirror\nset border 3\n";
  script += fmt::format("set label 10 {} at screen 0.02, screen 0.965 font ',15' noenhanced\n",
                        quoted(text.title));
  std::size_t line = 0;
  for (std::size_t at = 0; at < text.caption.size();) {
    const std::size_t end = std::min(text.caption.find('\n', at), text.caption.size());
    script += fmt::format(
        "set label {} {} at screen 0.02, screen {:.3f} font ',10' tc rgb '#505050' noenhanced\n",
        11 + line, quoted(text.caption.substr(at, end - at)), 0.055 - 0.024 * double(line));
    ++line;
    at = end + 1;
  }
  script += speed_panel(methods, text);
  for (std::size_t n = 0; n <= line; ++n) script += fmt::format("unset label {}\n", 10 + n);
  script += fmt::format("set xrange [{}:{}]\n", 0.9 * least, 1.1 * most);
  for (std::size_t part = 0; part < kFieldParts.size(); ++part) {
    script += order_panel(points, methods, part, text);
  }
  return script + "unset multiplot\n";
}

void run_gnuplot(const std::string& script) {
  std::string path = (std::filesystem::temp_directory_path() / "sdfgrid-chart-XXXXXX").string();
  const int file = ::mkstemp(path.data());
  if (file < 0) throw Error(ErrorKind::failed, path + ": cannot be written");
  ::close(file);
  std::ofstream(path) << script;
  std::string program = "gnuplot";
  char* arguments[] = {program.data(), path.data(), nullptr};
  pid_t child = 0;
  int status = -1;
  const bool ran = ::posix_spawnp(&child, "gnuplot", nullptr, nullptr, arguments, environ) == 0 &&
                   ::waitpid(child, &status, 0) == child;
  std::filesystem::remove(path);
  if (!ran || status != 0) {
    throw Error(ErrorKind::failed,
                "gnuplot did not draw the chart; install gnuplot-nox (the tables are written)");
  }
}

}  // namespace

void draw_chart(const std::vector<ChartPoint>& points, const ChartText& text,
                const std::string& path) {
  const bool svg = extension_of(path) == ".svg";
  const std::string terminal =
      svg ? "svg size 1400,860 dynamic enhanced font 'Helvetica,12' background '#ffffff'"
          : "pngcairo size 1400,860 enhanced font 'Helvetica,12' background '#ffffff'";
  write_atomically(path, [&](const std::string& temporary) {
    run_gnuplot(script_of(points, text, terminal, temporary));
  });
}

}  // namespace sdfgrid::cli
