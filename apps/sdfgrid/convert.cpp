// sdfgrid convert: a mesh, a surface in a volume or a scene to a sparse distance grid.
#include "sdfgrid/grid/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>

#include "command.h"
#include "inputs.h"
#include "methods.h"
#include "options.h"
#include "scenes.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/convert_dense.h"
#include "sdfgrid/grid/convert_field.h"
#include "sdfgrid/grid/dense.h"
#include "sdfgrid/grid/paint.h"
#include "sdfgrid/volume/write.h"
#include "tolerance.h"

namespace sdfgrid::cli {
namespace {

struct Options {
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

const std::vector<std::pair<std::string, SignMethod>> kSigns = {{"auto", SignMethod::automatic},
                                                                {"normal", SignMethod::normal},
                                                                {"winding", SignMethod::winding},
                                                                {"unsigned", SignMethod::no_sign}};

Band band_of(const Options& options) {
  return {options.exwidth > 0 ? options.exwidth : options.width,
          options.inwidth > 0 ? options.inwidth : options.width};
}

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

// How large what was made is.
struct Extent {
  glm::ivec3 dims;
  double voxel;
  std::size_t active_voxels, bricks, bytes;
};

Extent extent_of(const Grid& grid) {
  return {grid.dims(), grid.lattice().voxel, grid.active_voxels(), grid.bricks(), grid.bytes()};
}

Extent extent_of(const Volume& volume) {
  return {volume.dims, volume.spacing.x, volume.size(), 0, volume.size() * sizeof(float)};
}

void describe(const Made& made, const Options& options, Context& context) {
  const Extent extent = made.dense ? extent_of(*made.dense) : extent_of(made.grid);
  const glm::ivec3& dims = extent.dims;
  Json& result = context.result();
  result["method"] = made.method;
  result["sign"] = made.sign;
  result["sign_reason"] = made.sign_reason;
  result["voxel"] = extent.voxel;
  result["dims"] = {dims.x, dims.y, dims.z};
  result["active_voxels"] = extent.active_voxels;
  result["bricks"] = extent.bricks;
  result["bytes"] = extent.bytes;
  if (made.max_error) result["max_error"] = *made.max_error;
  if (made.origin) result["origin"] = {made.origin->x, made.origin->y, made.origin->z};
  context.print("{}: {} x {} x {} samples, voxel {:.6g}, {} active in {} bricks, {:.1f} MB",
                options.output.path, dims.x, dims.y, dims.z, extent.voxel, extent.active_voxels,
                extent.bricks, 1e-6 * static_cast<double>(extent.bytes));
  if (made.origin) {
    context.print("sample 0 at {:.9g} {:.9g} {:.9g}", made.origin->x, made.origin->y,
                  made.origin->z);
  }
  context.print("method {}{}; sign {}: {}", made.method,
                made.max_error
                    ? fmt::format(", error at most {:.1g} voxel", *made.max_error / extent.voxel)
                    : "",
                made.sign, made.sign_reason);
}

// What the grid says of itself to whoever opens it later (docs/architecture.md, "Metadata").
void stamp(Made& made, const std::string& source) {
  made.grid.set_metadata("sdfgrid:method", made.method);
  made.grid.set_metadata("sdfgrid:sign", made.sign);
  made.grid.set_metadata("sdfgrid:source", source.substr(source.find_last_of('/') + 1));
  if (made.max_error) made.grid.set_metadata("sdfgrid:max_error", *made.max_error);
  made.grid.set_metadata("sdfgrid:version", SDFGRID_VERSION);
}

// Of exact conversion, world units; far from the surface float's rounding comes on top.
double stated_error(const Made& made, const Band& band) {
  if (!made.dense) return convert_error(band) * made.grid.lattice().voxel;
  const double diagonal = glm::length(glm::dvec3(made.dense->dims));
  return (convert_error(band) + 6e-8 * diagonal) * made.dense->spacing.x;
}

// The voxel size asked for; a volume's own if nothing is said.
ConvertOptions convert_options(const Options& options, const Surface& surface) {
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

// Whether the output can hold voxels of that size; call it before any work.
void check_voxel(const Options& options, double voxel) {
  if (!has_extension(options.output.path, volume_extensions())) check_storable(voxel);
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

bool has_inside(const Made& made) {
  if (!made.dense) return made.grid.has_inside();
  const auto& samples = std::get<std::vector<float>>(made.dense->samples);
  return std::any_of(samples.begin(), samples.end(), [](float d) { return d < 0; });
}

// A result that would surprise whoever opens it; `source` is "mesh", "surface" or "scene".
void warn_of_nothing(const Made& made, const std::string& source, Context& context) {
  if (!made.dense && made.grid.active_voxels() == 0) {
    return context.warn("the grid is empty: no voxel is near the " + source +
                        "; use a smaller --voxel");
  }
  if (made.sign == "unsigned" || has_inside(made)) return;
  context.warn(
      "the grid has no inside: the " + source +
      " is thinner than its voxels; use a smaller --voxel, or for a sheet --sign unsigned");
}

// As all samples of a box: around the band, or the dense field's own.
void save_densely(Made& made, const std::string& path, Context& context) {
  const auto write = [&](const Volume& volume) {
    made.origin = volume.origin;
    write_volume(volume, path, context.job());
  };
  return made.dense ? write(*made.dense) : write(to_volume(made.grid));
}

// As a grid, or densely, as the output's name says.
void save(Made& made, const Options& options, Context& context) {
  const std::string& path = options.output.path;
  context.job().report("write", 0.0);
  context.job().checkpoint();
  if (has_extension(path, volume_extensions())) {
    if (!made.dense && has_paint(made.grid)) {
      context.warn(path + ": this format holds no paint, which is left out; .vdb and .nvdb do");
    }
    return save_densely(made, path, context);
  }
  if (made.dense) {
    made.grid = to_grid(*made.dense, band_of(options).exwidth * made.dense->spacing.x);
    made.dense.reset();
  }
  if (kind_of(options.input, false) != InputKind::grid || options.surface.iso) {
    stamp(made, options.input);
  }
  write_grid(made.grid, path);
}

// Every sample of the box around the surface.
Conversion convert_densely(const TriangleSoup& soup, const Options& options,
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

Exit run_surface(const Options& options, Context& context) {
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
Exit run_within(const Options& options, Context& context) {
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

// A scene's resolution found by measuring.
Choice choose_scene(const SceneModel& scene, const Options& options,
                    const FieldConvertOptions& convert, Context& context) {
  const glm::dvec3 size = scene.field.bounds().size();
  ChooseOptions choose = choose_options(options.tolerance, std::max({size.x, size.y, size.z}));
  choose.methods = options.methods;
  Choice choice = choose_conversion(scene.field, convert, choose, context.job());
  report_choice(choice, choose, context);
  return choice;
}

Exit run_scene(const Options& options, Context& context) {
  Stopwatch watch;
  const SceneModel scene = load_scene(options.input, options.time, context);
  check_has_end(scene, options.input);
  watch.lap("read");
  FieldConvertOptions convert;
  convert.voxel = options.convert.voxel;
  convert.dim = options.dim.value_or(convert.dim);
  convert.band = band_of(options);
  convert.max_memory = options.convert.max_memory;
  const bool search = !options.tolerance.tolerance.empty();
  if (search) convert.dim = choice_dims().front();  // the coarsest that is tried
  check_voxel(options, choose_lattice(scene.field, convert).voxel);
  Made made{{},
            std::nullopt,
            "field",
            "field",
            "values are the scene's own: bounds on the distance, or estimates (docs/shapes.md)",
            std::nullopt};
  std::optional<std::size_t> evaluated;  // points; a search does not count them
  bool within = true;
  if (search) {
    const Choice choice =
        naming(options.input, [&] { return choose_scene(scene, options, convert, context); });
    made.grid = choice.conversion.grid;
    within = choice.within;
  } else if (options.dense) {
    made.dense =
        naming(options.input, [&] { return convert_dense(scene.field, convert, context.job()); });
    evaluated = made.dense->size();
  } else {
    FieldConversion conversion =
        naming(options.input, [&] { return convert_field(scene.field, convert, context.job()); });
    made.grid = conversion.grid;
    evaluated = conversion.evaluated;
  }
  watch.lap("voxelize");
  warn_of_nothing(made, "scene", context);
  save(made, options, context);
  watch.lap("write");
  describe(made, options, context);
  Json seconds = watch.seconds();
  seconds["transform"] = 0.0;
  if (evaluated) context.result()["evaluated"] = *evaluated;
  context.result()["seconds"] = seconds;
  context.print("{}read {:.3f} s, voxelize {:.3f} s, write {:.3f} s",
                evaluated ? fmt::format("{} points evaluated; ", *evaluated) : "",
                seconds["read"].get<double>(), seconds["voxelize"].get<double>(),
                seconds["write"].get<double>());
  return within ? Exit::done : Exit::missed;
}

// A grid in another format, with the values that it has.
Exit run_grid(const Options& options, Context& context) {
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

Exit run(const Options& options, const CLI::App& app, Context& context) {
  check_output(options.output);
  const InputKind kind = kind_of(options.input, options.surface.iso.has_value());
  check_options_for(app, {kind});
  if (kind == InputKind::scene) return run_scene(options, context);
  if (kind == InputKind::grid) return run_grid(options, context);
  return options.tolerance.tolerance.empty() ? run_surface(options, context)
                                             : run_within(options, context);
}

}  // namespace

Run add_convert(CLI::App& app) {
  auto options = std::make_shared<Options>();
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
      ->check(CLI::Range(1, 100000))
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
