// sdfgrid convert: a mesh, a surface in a volume or a scene to a sparse distance grid.
#include "sdfgrid/grid/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>

#include "command.h"
#include "convert_made.h"
#include "scenes.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/convert_dense.h"
#include "sdfgrid/volume/write.h"

namespace sdfgrid::cli {
namespace {

const std::vector<std::pair<std::string, SignMethod>> kSigns = {{"auto", SignMethod::automatic},
                                                                {"normal", SignMethod::normal},
                                                                {"winding", SignMethod::winding},
                                                                {"unsigned", SignMethod::no_sign}};

// Of exact conversion, world units; far from the surface float's rounding comes on top.
double stated_error(const Made& made, const Band& band) {
  if (!made.dense) return convert_error(band) * made.grid.lattice().voxel;
  const double diagonal = glm::length(glm::dvec3(made.dense->dims));
  return (convert_error(band) + 6e-8 * diagonal) * made.dense->spacing.x;
}

// The voxel size asked for; a volume's own if nothing is said.
ConvertOptions convert_options(const ConvertRequest& options, const Surface& surface) {
  ConvertOptions convert = options.convert;
  convert.band = band_of(options);
  if (options.dim) {
    convert.dim = *options.dim;
  } else if (convert.voxel == 0) {
    convert.voxel = surface.spacing;
  }
  convert.transform = options.transform.options_for({options.method});
  return convert;
}

void report_seconds(const Surface& surface, const Conversion& conversion, Json seconds,
                    Context& context) {
  const double write_seconds = seconds["write"];
  seconds = {{"read", surface.read_seconds},
             {"isosurface", surface.isosurface_seconds},
             {"sign", conversion.seconds.sign},
             {"voxelize", conversion.seconds.voxelize},
             {"transform", conversion.seconds.assemble},
             {"write", write_seconds},
             {"total", seconds["total"]}};
  context.result()["seconds"] = seconds;
  context.print(
      "read {:.3f} s, isosurface {:.3f} s, sign {:.3f} s, voxelize {:.3f} s, assemble {:.3f} s, "
      "write {:.3f} s",
      surface.read_seconds, surface.isosurface_seconds, conversion.seconds.sign,
      conversion.seconds.voxelize, conversion.seconds.assemble, write_seconds);
}

// Every sample of the box around the surface.
Conversion convert_densely(const TriangleSoup& soup, const ConvertRequest& options,
                           const ConvertOptions& convert, std::optional<Volume>& dense,
                           const Job& job) {
  ConvertOptions with = convert;
  const std::optional<TransformMethod> transform = find_convert_method(options.method)->transform;
  if (transform) {
    with.transform->method = *transform;
  } else {
    with.transform.reset();
  }
  DenseConversion made = convert_dense(soup, with, job);
  dense = std::move(made.distances);
  return {{}, made.sign, made.sign_reason, made.warnings, made.seconds};
}

Exit run_surface(const ConvertRequest& options, Context& context) {
  Stopwatch watch;
  const Surface surface = load_surface(options.input, options.surface, context);
  watch.lap("read");
  const ConvertOptions convert = convert_options(options, surface);
  check_voxel(options, choose_lattice(surface.soup, convert).voxel);
  const ConvertMethod method = select_methods({options.method}, convert, false).front();
  std::optional<Volume> dense;
  const Conversion conversion =
      options.dense ? convert_densely(surface.soup, options, convert, dense, context.job())
                    : method.convert(surface.soup, convert, context.job());
  for (const std::string& warning : conversion.warnings) context.warn(warning);
  watch.lap("convert");
  Made made{conversion.grid,        std::move(dense),
            options.method,         std::string(sign_name(conversion.sign)),
            conversion.sign_reason, std::nullopt};
  // The error of a transform depends on the mesh: docs/methods.md, and `compare`.
  if (options.method == "exact") made.max_error = stated_error(made, convert.band);
  warn_of_nothing(made, surface.source == "mesh" ? "mesh" : "surface", context);
  save(made, options, context);
  watch.lap("write");
  describe(made, options, context);
  report_seconds(surface, conversion, watch.seconds(), context);
  return Exit::done;
}

// Resolution and method found by measuring.
Exit run_within(const ConvertRequest& options, Context& context) {
  Stopwatch watch;
  const Surface surface = load_surface(options.input, options.surface, context);
  watch.lap("read");
  ConvertOptions convert = options.convert;
  convert.band = band_of(options);
  convert.transform = options.transform.options_for(options.methods);
  convert.dim = choice_dims().front();  // the coarsest that is tried
  check_voxel(options, choose_lattice(surface.soup, convert).voxel);
  const glm::dvec3 size = bounds(surface.soup).size();
  ChooseOptions choose = choose_options(options.tolerance, std::max({size.x, size.y, size.z}));
  choose.methods = options.methods;
  const Choice choice = choose_conversion(surface.soup, convert, choose, context.job());
  report_choice(choice, choose, context);
  const Conversion& conversion = choice.conversion;
  for (const std::string& warning : conversion.warnings) context.warn(warning);
  watch.lap("choose");
  Made made{conversion.grid,        std::nullopt,
            choice.chosen.method,   std::string(sign_name(conversion.sign)),
            conversion.sign_reason, std::nullopt};
  if (made.method == "exact") made.max_error = stated_error(made, convert.band);
  warn_of_nothing(made, surface.source == "mesh" ? "mesh" : "surface", context);
  save(made, options, context);
  watch.lap("write");
  describe(made, options, context);
  report_seconds(surface, conversion, watch.seconds(), context);
  return choice.within ? Exit::done : Exit::missed;
}

// A grid in another format, with the values that it has.
Exit run_grid(const ConvertRequest& options, Context& context) {
  if (!options.tolerance.tolerance.empty()) {
    throw Error(ErrorKind::usage, "--tolerance is for meshes, volumes or scenes, not for grids");
  }
  Stopwatch watch;
  const Grid grid = read_distances(options.input, false);
  watch.lap("read");
  const auto known = [&](const char* key) {
    const std::string word = grid.metadata(key);
    return word.empty() ? "unknown" : word;
  };
  Made made{grid,
            std::nullopt,
            known("sdfgrid:method"),
            known("sdfgrid:sign"),
            "values are the grid's own",
            std::nullopt};
  save(made, options, context);
  watch.lap("write");
  describe(made, options, context);
  context.result()["seconds"] = watch.seconds();
  return Exit::done;
}

Exit run(const ConvertRequest& options, const CLI::App& app, Context& context) {
  check_output(options.output);
  const InputKind kind = kind_of(options.input, options.surface.iso.has_value());
  check_options_for(app, {kind});
  if (kind == InputKind::scene) return convert_scene(options, context);
  if (kind == InputKind::grid) return run_grid(options, context);
  return options.tolerance.tolerance.empty() ? run_surface(options, context)
                                             : run_within(options, context);
}

}  // namespace

Run add_convert(CLI::App& app) {
  auto options = std::make_shared<ConvertRequest>();
  app.add_option("IN", options->input,
                 "mesh (.obj, .ply, .stl, .off, .om), volume (see --iso), scene (.yaml, .json) or "
                 "grid (.vdb) to write in another format")
      ->required();
  std::vector<std::string> extensions = grid_extensions();
  extensions.insert(extensions.end(), volume_extensions().begin(), volume_extensions().end());
  add_output(app, options->output, extensions);
  add_surface_options(app, options->surface);
  add_scene_options(app, options->time);
  auto* voxel = app.add_option("--voxel", options->convert.voxel, "voxel size, world units")
                    ->check(CLI::PositiveNumber & finite_number());
  app.add_option(
         "--dim", options->dim,
         "voxels along the longest side; 256 for a mesh or scene, a volume's own if not given")
      ->check(whole_number(1, 100000))
      ->excludes(voxel);
  auto* tolerance = add_tolerance(app, options->tolerance)->excludes(voxel)->excludes("--dim");
  add_method(app, options->method)->excludes(tolerance);
  add_methods(app, options->methods, "--tolerance chooses from", false)->needs(tolerance);
  add_transform_choice(app, options->transform);
  app.add_flag("--dense", options->dense,
               "distances at every sample of the box around the band, not in the band only")
      ->excludes(tolerance);
  app.add_option("--width", options->width, "half-width of the band, voxels")
      ->check(CLI::Range(1.0, 1000.0) & finite_number())
      ->capture_default_str();
  app.add_option("--exwidth", options->exwidth, "the same outside only")
      ->check(CLI::Range(1.0, 1000.0) & finite_number());
  app.add_option("--inwidth", options->inwidth, "the same inside only")
      ->check(CLI::Range(1.0, 1000.0) & finite_number());
  add_choice(app, "--sign", options->convert.sign, kSigns, "how inside and outside are told apart");
  app.add_option("--max-memory", options->convert.max_memory,
                 "refuse to take more than this, as in 8GB (default: 80 % of what is free)")
      ->transform(CLI::AsSizeValue(false));
  return [options, &app](Context& context) { return run(*options, app, context); };
}

}  // namespace sdfgrid::cli
