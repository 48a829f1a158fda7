// sdfgrid chart: methods and resolutions measured on the user's own input, time against error.
#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <set>

#include "chart_data.h"
#include "chart_plot.h"
#include "command.h"
#include "inputs.h"
#include "methods.h"
#include "options.h"
#include "scenes.h"
#include "sdfgrid/core/atomic_file.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/core/memory.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/convert_field.h"
#include "sdfgrid/grid/dense.h"
#include "sdfgrid/grid/methods.h"
#include "sdfgrid/volume/isosurface.h"

namespace sdfgrid::cli {
namespace {

struct Options {
  std::string input;
  Output output;
  SurfaceOptions surface;
  double time = 0;                   // of a scene
  std::vector<std::string> methods;  // empty: all
  TransformChoice transform;
  std::vector<int> dims = {32, 64, 128, 256};
  double width = 10;
  int repeat = 2;
  CompareOptions compare{.samples = 20000};
};

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

// What the chart is of.
struct Subject {
  TriangleSoup soup;
  std::string surface;         // "1234 triangles", or what they were made from
  std::optional<Field> field;  // of a scene
};

void set_surface(const Grid& grid, const std::string& from, Subject& subject, Context& context) {
  subject.soup = isosurface(to_volume(grid, 1), {.iso = 0, .inside_above = false}, context.job());
  subject.surface =
      fmt::format("{} triangles of its surface{}", subject.soup.triangles.size(), from);
}

// The surface of a scene as triangles: its zero in a grid twice as fine as any that is charted.
Subject scene_subject(const Options& options, Context& context) {
  constexpr int kLeast = 128;
  constexpr int kMost = 512;
  Subject subject;
  const SceneModel scene = load_scene(options.input, options.time, context);
  check_has_end(scene, options.input);
  subject.field = scene.field;
  FieldConvertOptions convert;
  convert.dim =
      std::clamp(2 * *std::max_element(options.dims.begin(), options.dims.end()), kLeast, kMost);
  const Grid grid = convert_field(*subject.field, convert, context.job()).grid;
  set_surface(grid, fmt::format(" at {} voxels", convert.dim), subject, context);
  return subject;
}

Subject load_subject(const Options& options, Context& context) {
  if (names_scene(options.input)) return scene_subject(options, context);
  Subject subject;
  if (kind_of(options.input, options.surface.iso.has_value()) == InputKind::grid) {
    set_surface(read_distances(options.input, true), "", subject, context);
    return subject;
  }
  subject.soup = load_surface(options.input, options.surface, context).soup;
  subject.surface = fmt::format("{} triangles", subject.soup.triangles.size());
  return subject;
}

// One way to a grid of so many voxels along the longest side.
struct Candidate {
  std::string name;
  bool peer = false;
  std::function<Grid(int dim, const Job& job)> convert;
};

// All methods for meshes, and a scene's own values.
std::vector<Candidate> candidates(const Options& options, const Subject& subject) {
  std::vector<Candidate> all;
  const Band band{options.width, options.width};
  if (subject.field) {
    all.push_back({"field", false, [&subject, band](int dim, const Job& job) {
                     FieldConvertOptions convert;
                     convert.dim = dim;
                     convert.band = band;
                     return convert_field(*subject.field, convert, job).grid;
                   }});
  }
  ConvertOptions convert;
  convert.band = band;
  convert.transform = options.transform.options_for(options.methods);
  for (const ConvertMethod& method : select_methods(options.methods, convert, true)) {
    all.push_back({method.name, method.peer, [&subject, method, convert](int dim, const Job& job) {
                     ConvertOptions with = convert;
                     with.dim = dim;
                     return method.convert(subject.soup, with, job).grid;
                   }});
  }
  return all;
}

ChartPoint measure(const Candidate& candidate, int dim, const SurfaceTruth& truth,
                   const Options& options, const Job& job) {
  ChartPoint point;
  point.method = candidate.name;
  point.peer = candidate.peer;
  point.dim = dim;
  point.seconds = 1e300;
  Grid grid;
  for (int run = 0; run < options.repeat; ++run) {
    grid = Grid();
    const PeakMemory peak;
    const Timer timer;
    grid = candidate.convert(dim, job);
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

// Measures what can be measured; what cannot is left out with a warning.
class Measurements {
 public:
  Measurements(const Options& options, const Subject& subject, Context& context)
      : options_(options), context_(context), truth_(subject.soup, context.job()) {}

  void add(const Candidate& candidate, int dim) {
    if (refused_.contains(candidate.name)) return;
    try {
      points_.push_back(measure(candidate, dim, truth_, options_, context_.job()));
      print_point(points_.back(), context_);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::cancelled) throw;
      // What was asked for is refused at any size, an input or a lack of memory at this one.
      const bool every_dim = error.kind() == ErrorKind::usage;
      if (every_dim) refused_.insert(candidate.name);
      context_.warn(fmt::format("{}{} is left out: {}", candidate.name,
                                every_dim ? "" : fmt::format(" at {} voxels", dim), error.what()));
      last_failure_ = error;
    }
  }

  [[nodiscard]] std::vector<ChartPoint> points() && {
    if (points_.empty()) {
      throw Error(last_failure_.kind(), fmt::format("{}: no method could be measured: {}",
                                                    options_.input, last_failure_.what()));
    }
    mark_front(points_);
    return std::move(points_);
  }

 private:
  const Options& options_;
  Context& context_;
  SurfaceTruth truth_;
  std::vector<ChartPoint> points_;
  std::set<std::string> refused_;
  Error last_failure_{ErrorKind::usage, "none was asked for"};
};

std::vector<ChartPoint> measure_all(const Options& options, const Subject& subject,
                                    Context& context) {
  Measurements measurements(options, subject, context);
  const std::vector<Candidate> all = candidates(options, subject);
  context.print("{:<12}{:>6}{:>10}{:>11}{:>11}{:>11}{:>11}{:>10}{:>10}", "method", "dim", "seconds",
                "max/voxel", "p99", "rms", "at voxels", "MB", "peak MB");
  double done = 0;
  for (const int dim : options.dims) {
    for (const Candidate& candidate : all) {
      context.job().report("chart", done++ / static_cast<double>(all.size() * options.dims.size()));
      measurements.add(candidate, dim);
    }
  }
  return std::move(measurements).points();
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
    const auto order = [&](std::size_t part) {
      const double value = order_of(points, method, part);
      return std::isnan(value) ? "unknown" : fmt::format("{:.2f}", value);
    };
    context.print("order of {:<12} smooth {}, edge {}, medial {}", method, order(0), order(1),
                  order(2));
  }
}

Exit run(const Options& options, const CLI::App& app, Context& context) {
  check_output(options.output);
  std::vector<InputKind> kinds = {kind_of(options.input, options.surface.iso.has_value())};
  // What is said of methods is for the mesh of a scene's or a grid's surface.
  if (kinds.front() != InputKind::volume) kinds.push_back(InputKind::mesh);
  check_options_for(app, kinds);
  for (const Output& output : outputs(options)) check_output(output);
  Stopwatch watch;
  const Subject subject = load_subject(options, context);
  watch.lap("read");
  const std::vector<ChartPoint> points = measure_all(options, subject, context);
  watch.lap("measure");
  const std::string name = std::filesystem::path(options.input).filename().string();
  const ChartText text{
      fmt::format("{}, {}, half-width {:g} voxels", name, subject.surface, options.width),
      machine() + "\n" + command_line(),
      thread_count() == 1 ? "seconds of processor time" : "seconds", longest_side(subject.soup)};
  Json& result = context.result();
  result["input"] = name;
  result["triangles"] = subject.soup.triangles.size();
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
  std::string written;
  for (const Output& output : outputs(options)) {
    written += (written.empty() ? "" : ", ") + output.path;
  }
  context.print("written: {}", written);
  return Exit::done;
}

}  // namespace

Run add_chart(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("IN", options->input, "mesh, scene, grid, or volume (see --iso), to measure on")
      ->required();
  add_output(app, options->output, {".svg", ".png"});
  app.get_option("--output")
      ->description(
          "file to write: .svg or .png; the other picture, the .csv and the .json are written "
          "beside it");
  add_methods(app, options->methods, "which to measure", true);
  add_transform_choice(app, options->transform);
  app.add_option("--dims", options->dims, "voxels along the longest side, as in 64,128,256")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(whole_number(4, 1 << 14))
      ->capture_default_str();
  app.add_option("--width", options->width, "half-width of the band, voxels")
      ->check(CLI::Range(2.0, 1000.0))
      ->capture_default_str();
  app.add_option("--repeat", options->repeat, "runs of each, of which the fastest counts")
      ->check(whole_number(1, 1000))
      ->capture_default_str();
  app.add_option("--samples", options->compare.samples, "places of each kind to measure at")
      ->check(whole_number(100, 1 << 30))
      ->capture_default_str();
  add_surface_options(app, options->surface);
  add_scene_options(app, options->time);
  return [options, &app](Context& context) { return run(*options, app, context); };
}

}  // namespace sdfgrid::cli
