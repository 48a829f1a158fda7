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

namespace sdfgrid::cli {
namespace {

// The colours of Okabe and Ito, which the colour-blind tell apart too, and some more.
constexpr std::array<const char*, 11> kColours = {"000000", "0072b2", "d55e00", "009e73",
                                                  "cc79a7", "56b4e9", "e69f00", "7f3c8d",
                                                  "8c564b", "66a61e", "e7298a"};
constexpr std::array<const char*, 3> kPeerColours = {"707070", "a8a8a8", "c8b890"};
constexpr const char* kGrey = "#b0b0b0";

// How one method is drawn everywhere: peers are grey and dashed, with open marks.
struct Style {
  std::string colour;  // as gnuplot's rrggbb
  int dash = 1;
  int mark = 7;
};

std::vector<Style> styles_of(const std::vector<ChartPoint>& points,
                             const std::vector<std::string>& methods) {
  std::vector<Style> styles;
  std::size_t ours = 0;
  std::size_t peers = 0;
  for (const std::string& method : methods) {
    const bool peer = std::any_of(points.begin(), points.end(), [&](const ChartPoint& p) {
      return p.peer && p.method == method;
    });
    if (peer) {
      styles.push_back({kPeerColours[peers++ % kPeerColours.size()], 2, 6});
    } else {
      styles.push_back({kColours[ours++ % kColours.size()], 1, 7});
    }
  }
  return styles;
}

// The range of an axis of logarithms, with room at both ends.
struct Range {
  double lo = 1e300;
  double hi = 0;

  void add(double v) {
    lo = std::min(lo, v);
    hi = std::max(hi, v);
  }
  [[nodiscard]] std::string text(double room) const {
    return fmt::format("[{:.6g}:{:.6g}]", lo / room, hi * room);
  }
  // Where a value lies, 0 to 1.
  [[nodiscard]] double place(double v) const { return std::log(v / lo) / std::log(hi / lo); }
};

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

// $labels: resolutions of the front's points, but those that would cover another.
std::string label_block(const std::vector<ChartPoint>& points,
                        const std::vector<const ChartPoint*>& front, const ChartText& text) {
  Range time;
  Range error;
  for (const ChartPoint& p : points) {
    time.add(p.seconds);
    error.add(percent(p.survey.between.max_error, text));
  }
  std::vector<glm::dvec2> placed;
  std::string block = "$labels << EOD\n";
  for (const ChartPoint* p : front) {
    const double e = percent(p->survey.between.max_error, text);
    const glm::dvec2 at(time.place(p->seconds), error.place(e));
    const bool covers = std::any_of(placed.begin(), placed.end(), [&](const glm::dvec2& other) {
      return std::abs(other.x - at.x) < 0.05 && std::abs(other.y - at.y) < 0.05;
    });
    if (covers) continue;
    placed.push_back(at);
    block += fmt::format("{} {} {}\n", p->seconds, e, p->dim);
  }
  return block + "EOD\n";
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
    script += fmt::format("{} {}\n", p->seconds, percent(p->survey.between.max_error, text));
  }
  return script + "EOD\n" + label_block(points, front, text);
}

// Time against the error of the field between the voxels.
std::string speed_panel(const std::vector<ChartPoint>& points,
                        const std::vector<std::string>& methods, const std::vector<Style>& styles,
                        const ChartText& text) {
  Range time;
  Range error;
  for (const ChartPoint& p : points) {
    time.add(p.seconds);
    error.add(percent(p.survey.between.max_error, text));
    error.add(percent(p.survey.between.rms_error, text));
  }
  std::string script =
      "set lmargin at screen 0.07; set rmargin at screen 0.585\n"
      "set tmargin at screen 0.885; set bmargin at screen 0.265\n"
      "set xlabel " +
      quoted(text.time) + "\nset xrange " + time.text(1.4) + "\nset yrange " + error.text(1.5) +
      "\nset ylabel 'error of the interpolated field, % of the longest side' offset 0.5\n"
      "set title 'speed against accuracy: largest error (dots), 99 % (crosses), rms (lower ends)'\n"
      "set key at screen 0.5, screen 0.148 center center horizontal noenhanced width 1.5 "
      "samplen 2.5 maxcols 7\n"
      "plot $front using 1:2 with steps lc rgb '#d0d0d0' lw 7 title 'Pareto front', \\\n"
      "  $front using 1:2 with points pt 6 ps 2.4 lw 1.5 lc rgb '#606060' notitle, \\\n"
      "  $labels using 1:2:3 with labels offset 1.7,0.8 font ',10' tc rgb '#404040' notitle";
  for (std::size_t m = 0; m < methods.size(); ++m) {
    script += fmt::format(
        ", \\\n  $m{0} using 1:2:4:2 with yerrorbars pt 0 lw 1 lc rgb '#b0{1}' notitle"
        ", \\\n  $m{0} using 1:3 with points pt 2 ps 0.5 lc rgb '#60{1}' notitle"
        ", \\\n  $m{0} using 1:2 with linespoints pt {3} ps 0.9 lw 1.5 dt {4} lc rgb '#{1}' "
        "title {2}",
        m, styles[m].colour, quoted(methods[m]), styles[m].mark, styles[m].dash);
  }
  return script + "\n";
}

// Below this, in voxels, an error is the rounding of numbers and has no order of convergence.
constexpr double kRounding = 1e-4;

// What the panel of a part shows: its errors but those that are rounding, which would squeeze the
// others.
struct PartRange {
  Range voxel;
  Range error;
  std::string below;  // the methods that are not shown
};

PartRange range_of(const std::vector<ChartPoint>& points, std::size_t part, const ChartText& text) {
  PartRange range;
  std::vector<std::string> below;
  for (const ChartPoint& p : points) {
    const ErrorSummary& summary = p.survey.parts[part];
    if (summary.samples == 0) continue;
    range.voxel.add(percent(p.survey.voxel, text));
    if (summary.rms_error > kRounding * p.survey.voxel) {
      range.error.add(percent(summary.rms_error, text));
    } else if (std::find(below.begin(), below.end(), p.method) == below.end()) {
      below.push_back(p.method);
    }
  }
  for (const std::string& method : below) range.below += (range.below.empty() ? "" : ", ") + method;
  if (!below.empty()) range.below += ": below, at rounding";
  return range;
}

// Marks at the voxel sizes themselves.
std::string voxel_ticks(const std::vector<ChartPoint>& points, const ChartText& text,
                        bool labelled) {
  std::vector<double> sizes;
  sizes.reserve(points.size());
  for (const ChartPoint& p : points) sizes.push_back(percent(p.survey.voxel, text));
  std::sort(sizes.begin(), sizes.end());
  std::string ticks;
  double last = 0;
  for (const double size : sizes) {
    if (size < 1.02 * last) continue;  // methods may round it otherwise
    last = size;
    ticks += fmt::format("{}'{}' {:.6g}", ticks.empty() ? "" : ", ",
                         labelled ? fmt::format("{:.2g}", size) : "", size);
  }
  return "(" + ticks + ")";
}

// Error over the voxels' size, in one part of the field.
std::string order_panel(const std::vector<ChartPoint>& points,
                        const std::vector<std::string>& methods, const std::vector<Style>& styles,
                        std::size_t part, const ChartText& text) {
  constexpr double kTop = 0.885, kHeight = 0.194, kStep = 0.213;
  const double top = kTop - kStep * static_cast<double>(part);
  const bool last = part + 1 == kFieldParts.size();
  const PartRange range = range_of(points, part, text);
  std::string script = fmt::format(
      "set lmargin at screen 0.665; set rmargin at screen 0.985\n"
      "set tmargin at screen {:.4f}; set bmargin at screen {:.4f}\n"
      "unset key\nset title {}\nset xlabel {}\nset xtics {}\nunset mxtics\n"
      "set ylabel 'rms error, %' offset 0.5\n"
      "set label 1 {} at graph 0.02, graph 0.9 left font ',12' front\n"
      "set label 2 {} at graph 0.98, graph 0.08 right font ',10' tc rgb '#505050' front\n",
      top, top - kHeight,
      part == 0 ? "'error at the voxels over their size (dashes: order 1, dots: 2)'" : "''",
      last ? "'voxel size, % of the longest side'" : "''", voxel_ticks(points, text, last),
      quoted(std::string(kFieldParts[part])), quoted(range.below));
  if (!(range.error.hi > 0)) {
    return script + "set yrange [1e-3:1]\nplot NaN notitle\n";
  }
  script += "set yrange " + range.error.text(1.6) + "\n";
  script += fmt::format(
      "plot {1}*(x/{0}) lc rgb '{2}' dt 2 notitle, {1}*(x/{0})**2 lc rgb '{2}' dt 3 notitle",
      range.voxel.hi, range.error.hi, kGrey);
  for (std::size_t m = 0; m < methods.size(); ++m) {
    script += fmt::format(
        ", \\\n  $m{} using 5:{} with linespoints pt {} ps 0.7 lw 1.5 dt {} lc rgb '#{}' notitle",
        m, 6 + part, styles[m].mark, styles[m].dash, styles[m].colour);
  }
  return script + "\n";
}

std::string script_of(const std::vector<ChartPoint>& points, const ChartText& text,
                      const std::string& terminal, const std::string& output) {
  const std::vector<std::string> methods = methods_of(points);
  const std::vector<Style> styles = styles_of(points, methods);
  Range voxels;
  for (const ChartPoint& p : points) voxels.add(percent(p.survey.voxel, text));
  std::string script = "set terminal " + terminal + "\nset output " + quoted(output) + "\n" +
                       data_blocks(points, methods, text);
  script +=
      "set multiplot\nset logscale xy\nset format '%g'\nset grid lc rgb '#e0e0e0'\n"
      "set tics nomirror\nset border 3\n";
  script += fmt::format("set label 10 {} at screen 0.02, screen 0.965 font ',15' noenhanced\n",
                        quoted(text.title));
  std::size_t line = 0;
  for (std::size_t at = 0; at < text.caption.size();) {
    const std::size_t end = std::min(text.caption.find('\n', at), text.caption.size());
    script += fmt::format(
        "set label {} {} at screen 0.02, screen {:.3f} font ',10' tc rgb '#505050' noenhanced\n",
        11 + line, quoted(text.caption.substr(at, end - at)), 0.050 - 0.024 * double(line));
    ++line;
    at = end + 1;
  }
  script += speed_panel(points, methods, styles, text);
  for (std::size_t n = 0; n <= line; ++n) script += fmt::format("unset label {}\n", 10 + n);
  script += "set xrange " + voxels.text(1.1) + "\n";
  for (std::size_t part = 0; part < kFieldParts.size(); ++part) {
    script += order_panel(points, methods, styles, part, text);
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
