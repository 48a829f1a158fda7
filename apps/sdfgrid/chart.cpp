// sdfgrid chart: methods and resolutions measured on the user's own input, time against error.
#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>

#include "chart_data.h"
#include "chart_plot.h"
#include "command.h"
#include "inputs.h"
#include "options.h"
#include "sdfgrid/core/atomic_file.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/core/memory.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/methods.h"

namespace sdfgrid::cli {
namespace {

struct Options {
  std::string input;
  Output output;
  SurfaceOptions surface;
  std::vector<std::string> methods;  // empty: all
  std::vector<int> dims = {32, 64, 128, 256};
  double width = 10;
  int repeat = 2;
  CompareOptions compare{.samples = 20000};
};

std::vector<ConvertMethod> chosen_methods(const Options& options) {
  std::vector<ConvertMethod> chosen;
  for (const ConvertMethod& method : convert_methods()) {
    const auto& names = options.methods;
    if (names.empty() || std::find(names.begin(), names.end(), method.name) != names.end()) {
      chosen.push_back(method);
    }
  }
  return chosen;
}

// The path with another extension.
std::string beside(const std::string& path, const char* extension) {
  return std::filesystem::path(path).replace_extension(extension).string();
}

// All files that the chart consists of.
std::vector<Output> outputs(const Options& options) {
  std::vector<Output> all;
  for (const char* extension : {".svg", ".png", ".csv", ".json"}) {
    all.push_back({beside(options.output.path, extension), options.output.force, {extension}});
  }
  return all;
}

// Time as the chart has it: on one thread the processor's, which other programs do not lengthen.
class Timer {
 public:
  [[nodiscard]] double seconds() const {
    if (thread_count() == 1) {
      return static_cast<double>(std::clock() - processor_) / CLOCKS_PER_SEC;
    }
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count();
  }

 private:
  std::clock_t processor_ = std::clock();
  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
};

ChartPoint measure(const ConvertMethod& method, int dim, const TriangleSoup& soup,
                   const SurfaceTruth& truth, const Options& options, const Job& job) {
  ConvertOptions convert;
  convert.dim = dim;
  convert.band = {options.width, options.width};
  ChartPoint point;
  point.method = method.name;
  point.peer = method.peer;
  point.dim = dim;
  point.seconds = 1e300;
  Grid grid;
  for (int run = 0; run < options.repeat; ++run) {
    grid = Grid();
    const PeakMemory peak;
    const Timer timer;
    grid = method.convert(soup, convert, job).grid;
    point.seconds = std::min(point.seconds, timer.seconds());
    point.peak_memory = std::max(point.peak_memory, peak.bytes());
  }
  point.bytes = grid.bytes();
  point.active_voxels = grid.active_voxels();
  point.survey = survey(grid, truth, options.compare, job);
  return point;
}

std::string machine() {
  std::ifstream info("/proc/cpuinfo");
  std::string model = "unknown processor";
  for (std::string line; std::getline(info, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) {
      model = line.substr(colon + 2);
      break;
    }
  }
  return fmt::format("{}, {} thread{}", model, thread_count(), thread_count() == 1 ? "" : "s");
}

// The command as it was typed, folders left out.
std::string command_line() {
  std::ifstream in("/proc/self/cmdline", std::ios::binary);
  std::string line;
  for (std::string word; std::getline(in, word, '\0');) {
    const bool path = word.find('/') != std::string::npos;
    line +=
        (line.empty() ? "" : " ") + (path ? std::filesystem::path(word).filename().string() : word);
  }
  return line;
}

double longest_side(const TriangleSoup& soup) {
  const glm::dvec3 size = bounds(soup).size();
  return std::max({size.x, size.y, size.z});
}

void print_point(const ChartPoint& p, Context& context) {
  const ErrorSummary& e = p.survey.between;
  const double h = p.survey.voxel;
  context.print("{:<12}{:>6}{:>10.3f}{:>11.3g}{:>11.3g}{:>11.3g}{:>11.3g}{:>10.1f}{:>10.1f}",
                p.method, p.dim, p.seconds, e.max_error / h, e.p99_error / h, e.rms_error / h,
                p.survey.voxels.max_error / h, 1e-6 * static_cast<double>(p.bytes),
                1e-6 * p.peak_memory);
}

std::vector<ChartPoint> measure_all(const Options& options, const TriangleSoup& soup,
                                    Context& context) {
  const SurfaceTruth truth(soup, context.job());
  const std::vector<ConvertMethod> methods = chosen_methods(options);
  context.print("{:<12}{:>6}{:>10}{:>11}{:>11}{:>11}{:>11}{:>10}{:>10}", "method", "dim", "seconds",
                "max/voxel", "p99", "rms", "at voxels", "MB", "peak MB");
  std::vector<ChartPoint> points;
  const double count = static_cast<double>(methods.size() * options.dims.size());
  for (const int dim : options.dims) {
    for (const ConvertMethod& method : methods) {
      context.job().report("chart", static_cast<double>(points.size()) / count);
      points.push_back(measure(method, dim, soup, truth, options, context.job()));
      print_point(points.back(), context);
    }
  }
  mark_front(points);
  return points;
}

void write_text(const std::string& path, const std::string& text) {
  write_atomically(path, [&](const std::string& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out << text;
    out.close();
    if (!out) throw Error(ErrorKind::failed, path + ": cannot be written; is the disk full?");
  });
}

void report_front(const std::vector<ChartPoint>& points, Context& context) {
  std::string front;
  for (const ChartPoint& p : points) {
    if (p.on_front) front += fmt::format("{}{} {}", front.empty() ? "" : ", ", p.method, p.dim);
  }
  context.print("Pareto front (time, largest error between voxels): {}", front);
  for (const std::string& method : methods_of(points)) {
    context.print("order of {:<12} smooth {:.2f}, edge {:.2f}, medial {:.2f}", method,
                  order_of(points, method, 0), order_of(points, method, 1),
                  order_of(points, method, 2));
  }
}

Exit run(const Options& options, Context& context) {
  check_output(options.output);
  for (const Output& output : outputs(options)) check_output(output);
  Stopwatch watch;
  const Surface surface = load_surface(options.input, options.surface, context);
  watch.lap("read");
  const std::vector<ChartPoint> points = measure_all(options, surface.soup, context);
  watch.lap("measure");
  const std::string name = std::filesystem::path(options.input).filename().string();
  const ChartText text{fmt::format("{}, {} triangles, half-width {:g} voxels", name,
                                   surface.soup.triangles.size(), options.width),
                       machine() + "\n" + command_line(),
                       thread_count() == 1 ? "seconds of processor time" : "seconds",
                       longest_side(surface.soup)};
  Json& result = context.result();
  result["input"] = name;
  result["triangles"] = surface.soup.triangles.size();
  result["machine"] = machine();
  result["command"] = command_line();
  result.update(json_of(points));
  write_text(beside(options.output.path, ".csv"), csv_of(points));
  write_text(beside(options.output.path, ".json"), result.dump(1) + "\n");
  draw_chart(points, text, beside(options.output.path, ".svg"));
  draw_chart(points, text, beside(options.output.path, ".png"));
  watch.lap("draw");
  result["seconds"] = watch.seconds();
  report_front(points, context);
  return Exit::done;
}

void add_methods(CLI::App& app, std::vector<std::string>& chosen) {
  std::vector<std::string> names;
  for (const ConvertMethod& method : convert_methods()) names.push_back(method.name);
  app.add_option("--methods", chosen, "which to measure, all if not given: " + one_of(names))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("WORDS")
      ->each([names](const std::string& word) {
        if (std::find(names.begin(), names.end(), word) == names.end()) {
          refuse_choice("--methods", word, names);
        }
      });
}

}  // namespace

Run add_chart(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("IN", options->input, "mesh, or volume (see --iso), to measure on")->required();
  add_output(app, options->output, {".svg", ".png"});
  add_methods(app, options->methods);
  app.add_option("--dims", options->dims, "voxels along the longest side, as in 64,128,256")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(4, 1 << 14))
      ->capture_default_str();
  app.add_option("--width", options->width, "half-width of the band, voxels")
      ->check(CLI::Range(2.0, 1000.0))
      ->capture_default_str();
  app.add_option("--repeat", options->repeat, "runs of each, of which the fastest counts")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--samples", options->compare.samples, "places of each kind to measure at")
      ->check(CLI::Range(std::size_t{100}, std::size_t{1} << 30U))
      ->capture_default_str();
  add_surface_options(app, options->surface);
  return [options](Context& context) { return run(*options, context); };
}

}  // namespace sdfgrid::cli
