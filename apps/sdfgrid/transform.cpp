// sdfgrid transform: the distance transform of a mask, of labels or of a grey volume.
#include "sdfgrid/transform/transform.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "command.h"
#include "inputs.h"
#include "methods.h"
#include "options.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/dense.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/volume/write.h"

namespace sdfgrid::cli {
namespace {

struct Options {
  std::string input;
  Output output;
  VolumeOptions volume;
  std::optional<double> label;
  std::optional<double> iso;
  std::optional<SampleRange> range;  // of the samples, for antialiased
  TransformOptions transform;
  TransformChoice choice;

  // All of the above.
  [[nodiscard]] TransformOptions transform_options() const {
    TransformOptions all = choice.options_for({std::string(transform_name(transform.method))});
    const bool antialiased = transform.method == TransformMethod::antialiased;
    if (antialiased && iso) {
      throw Error(ErrorKind::usage, "--iso is not for antialiased, which takes --range LO,HI");
    }
    if (range && !antialiased) throw Error(ErrorKind::usage, "--range is for antialiased");
    all.method = transform.method;
    all.side = transform.side;
    all.window = transform.window;
    return all;
  }
};

SampleRange parse_range(const std::string& text) {
  SampleRange range;
  int used = 0;
  const bool two = std::sscanf(text.c_str(), "%lf,%lf%n", &range.lo, &range.hi, &used) == 2;
  if (!two || static_cast<std::size_t>(used) != text.size() ||
      !std::isfinite(range.hi - range.lo)) {
    throw CLI::ValidationError("--range", "'" + text + "' is not two numbers as in 0,255");
  }
  if (range.lo == range.hi) {
    throw CLI::ValidationError("--range", "'" + text + "': nothing lies between equal numbers");
  }
  return range;
}

// transform.h counts samples with the last axis fastest, volumes with the first: the same samples,
// if the axes are named the other way round.
glm::ivec3 reversed(const glm::ivec3& v) { return {v.z, v.y, v.x}; }
glm::dvec3 reversed(const glm::dvec3& v) { return {v.z, v.y, v.x}; }

// How far outside --iso each sample is.
std::vector<float> levels(const Volume& volume, double iso, const Job& job) {
  std::vector<float> values = as_floats(volume.samples, job);
  for (float& v : values) v = static_cast<float>(iso - double(v));
  return values;
}

// How much of each voxel is inside, as its grey tells.
std::vector<float> coverages(const Volume& volume, const SampleRange& range, const Job& job) {
  std::vector<float> values = as_floats(volume.samples, job);
  const double scale = 1 / (range.hi - range.lo);
  for (float& v : values) {
    v = static_cast<float>(std::clamp((static_cast<double>(v) - range.lo) * scale, 0.0, 1.0));
  }
  return values;
}

// The grey levels that are wholly outside and wholly inside: those asked for, or the least and the
// greatest.
SampleRange range_of(const Options& options, const Volume& volume, const Job& job) {
  const SampleRange range = options.range ? *options.range : sample_range(volume, job);
  return {range.lo, range.hi == range.lo ? range.lo + 1 : range.hi};
}

// Voxels wholly on one side or the other do not tell where between them the surface is. A mask has
// no coverages.
void warn_of_no_grey(const std::string& input, const std::vector<float>& coverages,
                     Context& context) {
  const auto grey = [](float v) { return v > 0 && v < 1; };
  if (std::any_of(coverages.begin(), coverages.end(), grey)) return;
  context.warn(input +
               ": no sample is grey, partly inside, so that antialiased has nothing to go "
               "by; --method meijster is for masks");
}

// Samples of the volume are replaced by their distances.
void transform_in_place(const Options& options, const TransformOptions& transform, Volume& volume,
                        Context& context) {
  const Job& job = context.job();
  std::vector<std::uint8_t> mask;
  std::vector<float> values;
  const bool grey = transform.method == TransformMethod::antialiased && !options.label;
  if (grey) {
    values = coverages(volume, range_of(options, volume, job), job);
  } else if (options.iso && transform.method != TransformMethod::meijster) {
    values = levels(volume, *options.iso, job);
  } else if (options.iso) {
    mask = mask_above(volume, *options.iso, job);
  } else if (options.label) {
    mask = mask_of_label(volume, *options.label, job);
  } else {
    mask = mask_of_nonzero(volume, job);
  }
  if (transform.method == TransformMethod::antialiased) {
    warn_of_no_grey(options.input, values, context);
  }
  volume.samples = std::vector<float>();
  DenseSeeds seeds;
  seeds.dims = reversed(volume.dims);
  seeds.spacing = reversed(volume.spacing);
  seeds.mask = mask;
  seeds.values = values;
  if (grey) seeds.kind = SeedKind::coverage;
  std::vector<float> distances(volume.size());
  distance_transform(seeds, transform, distances, job);
  volume.samples = std::move(distances);
}

void check_shape(const Options& options, const Volume& volume) {
  if (volume.orthogonal()) return;
  throw input_error(options.input, "header", "its axes are not at right angles",
                    "resample it; distances along oblique axes are not computed");
}

bool writes_grid(const Options& options) {
  return has_extension(options.output.path, grid_extensions());
}

// Samples without any surface are infinitely far, which an array can hold; a grid's background, the
// width of its band, cannot.
void check_finite(const Options& options, const Volume& volume, Context& context) {
  const auto& distances = std::get<std::vector<float>>(volume.samples);
  if (std::isfinite(distances.front())) return;
  const std::string problem =
      "no surface is found between the samples, so that every distance is infinite";
  if (writes_grid(options)) {
    throw input_error(
        options.input, "samples", problem,
        "say what is inside (--label V, --iso V, --range LO,HI), or write an array: " +
            one_of(volume_extensions()));
  }
  context.warn(options.input + ": " + problem);
}

void write(const Options& options, const Volume& volume, const Job& job) {
  const std::string& path = options.output.path;
  if (!writes_grid(options)) return write_volume(volume, path, job);
  job.report("write", 0.0);
  write_grid(to_grid(volume), path);
}

Exit run(const Options& options, Context& context) {
  check_output(options.output);
  const TransformOptions transform = options.transform_options();
  Stopwatch watch;
  VolumeFile file = load_volume(options.input, options.volume, context);
  check_shape(options, file.volume);
  watch.lap("read");
  transform_in_place(options, transform, file.volume, context);
  watch.lap("transform");
  check_finite(options, file.volume, context);
  context.job().checkpoint();
  write(options, file.volume, context.job());
  watch.lap("write");

  const glm::ivec3& dims = file.volume.dims;
  const std::string method(transform_name(options.transform.method));
  Json& result = context.result();
  result["method"] = method;
  result["dims"] = {dims.x, dims.y, dims.z};
  result["voxels"] = file.volume.size();
  result["spacing"] = {file.volume.spacing.x, file.volume.spacing.y, file.volume.spacing.z};
  result["seconds"] = watch.seconds();
  const double seconds = result["seconds"]["transform"];
  context.print("{}: {} x {} x {} distances by {}, {:.3f} s ({:.1f} Mvoxel/s)", options.output.path,
                dims.x, dims.y, dims.z, method, seconds,
                1e-6 * static_cast<double>(file.volume.size()) / seconds);
  return Exit::done;
}

void add_sides(CLI::App& app, TransformSide& side) {
  const auto flag = [&](const char* name, TransformSide value, const char* help) {
    return app.add_flag_callback(
        name, [&side, value] { side = value; }, help);
  };
  auto* both = flag("--signed", TransformSide::both,
                    "distances on both sides, negative inside (what happens if no side is named)");
  auto* inside = flag("--inside", TransformSide::inside,
                      "distances of the samples inside to the nearest one outside; 0 outside");
  auto* outside = flag("--outside", TransformSide::outside,
                       "distances of the samples outside to the nearest one inside; 0 inside");
  both->excludes(inside)->excludes(outside);
  inside->excludes(outside);
}

}  // namespace

Run add_transform(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("VOLUME", options->input,
                 ".nrrd, .nhdr, .nii, .nii.gz, .npy, .raw, .tif, .vdb, or a folder of slices")
      ->required();
  std::vector<std::string> extensions = volume_extensions();
  extensions.insert(extensions.end(), grid_extensions().begin(), grid_extensions().end());
  add_output(app, options->output, extensions);
  std::vector<std::pair<std::string, TransformMethod>> methods;
  for (const TransformMethodInfo& info : transform_methods()) {
    if (info.volumes) methods.emplace_back(info.name, info.method);
  }
  add_choice(app, "--method", options->transform.method, methods, "how distances are made");
  auto* label = app.add_option("--label", options->label,
                               "inside are the samples of this value only; all "
                               "that are not 0 if not given")
                    ->type_name("V");
  app.add_option_function<std::string>(
         "--range", [options](const std::string& text) { options->range = parse_range(text); },
         "for antialiased: samples wholly outside and wholly inside; the least and greatest if not "
         "given")
      ->type_name("LO,HI")
      ->excludes(label);
  app.add_option("--iso", options->iso, "inside are the samples at or above this value")
      ->type_name("V")
      ->excludes(label);
  add_sides(app, options->transform.side);
  app.add_option("--window", options->transform.window,
                 "stop at this many voxels (of the smallest spacing); 0 for no limit")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  add_transform_choice(app, options->choice);
  add_volume_options(app, options->volume);
  return [options](Context& context) { return run(*options, context); };
}

}  // namespace sdfgrid::cli
