// sdfgrid convert SCENE: a scene's field to a grid, its materials to paint.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "convert_made.h"
#include "scenes.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/convert_dense.h"
#include "sdfgrid/grid/convert_field.h"
#include "sdfgrid/grid/paint.h"
#include "sdfgrid/scene/paint_scene.h"

namespace sdfgrid::cli {
namespace {

// A scene's resolution found by measuring.
Choice choose_scene(const SceneModel& scene, const ConvertRequest& options,
                    const FieldConvertOptions& convert, Context& context) {
  const glm::dvec3 size = scene.field.bounds().size();
  ChooseOptions choose = choose_options(options.tolerance, std::max({size.x, size.y, size.z}));
  choose.methods = options.methods;
  Choice choice = choose_conversion(scene.field, convert, choose, context.job());
  report_choice(choice, choose, context);
  return choice;
}

FieldConvertOptions field_options(const ConvertRequest& options) {
  FieldConvertOptions convert;
  convert.voxel = options.convert.voxel;
  convert.dim = options.dim.value_or(convert.dim);
  convert.band = band_of(options);
  convert.max_memory = options.convert.max_memory;
  // The coarsest that is tried.
  if (!options.tolerance.tolerance.empty()) convert.dim = choice_dims().front();
  return convert;
}

// How far from the surface the grid says how far it is: within the band or, in all of the box, no
// further than to its middle and its corners.
SceneReach reach_of(const Field& field, const ConvertRequest& options,
                    const FieldConvertOptions& convert) {
  const double voxel = choose_lattice(field, convert).voxel;
  if (!options.dense) return {convert.band.inwidth * voxel, convert.band.exwidth * voxel};
  const glm::dvec3 size = field.bounds().size();
  return {0.5 * std::min({size.x, size.y, size.z}), std::sqrt(3.0) * convert.band.exwidth * voxel};
}

// Says of grids of the scene that their own bands do not fill the one that was made. `reached` is
// the voxel that their reach was asked for.
void warn_of_short_bands(const SceneModel& scene, const ConvertRequest& options, double reached,
                         double voxel, Context& context) {
  for (const ShortBand& band : scene.short_bands) {
    const double share = band.share * reached / voxel;
    if (share >= 1) continue;
    const double width = std::floor(10 * share * options.width) / 10;
    std::string remedy = fmt::format("a --voxel of {:.3g}", share * voxel);
    if (width >= 1) remedy += fmt::format(", a --width of {:g}", width);
    if (options.dense || options.exwidth > 0 || options.inwidth > 0) remedy.clear();
    context.warn(fmt::format(
        "{}: line {}: the band of {} is narrower than what is made: further from its surface than "
        "{:.3g} voxels the values are bounds, smaller than the distances; {}{}",
        options.input, band.line, band.file, share * options.width,
        remedy.empty() ? "" : "use " + remedy + ", or ",
        fmt::format("convert its mesh with --width {:g}",
                    std::ceil(band.width * voxel / reached))));
  }
}

struct Converted {
  Made made;
  std::optional<std::size_t> evaluated = std::nullopt;  // points; a search does not count them
  bool within = true;                                   // the tolerance
};

Converted convert_field_of(const SceneModel& scene, const ConvertRequest& options,
                           const FieldConvertOptions& convert, Context& context) {
  Converted c{{{},
               std::nullopt,
               "field",
               "field",
               "values are the scene's own: bounds on the distance, or estimates (docs/shapes.md)",
               std::nullopt}};
  if (!options.tolerance.tolerance.empty()) {
    const Choice choice = choose_scene(scene, options, convert, context);
    c.made.grid = choice.conversion.grid;
    c.within = choice.within;
  } else if (options.dense) {
    c.made.dense = convert_dense(scene.field, convert, context.job());
    c.evaluated = c.made.dense->size();
  } else {
    const FieldConversion conversion = convert_field(scene.field, convert, context.job());
    c.made.grid = conversion.grid;
    c.evaluated = conversion.evaluated;
  }
  return c;
}

// The scene's materials, where the output can hold them.
void paint(const SceneModel& scene, const ConvertRequest& options, Made& made, Context& context) {
  if (!becomes_grid(options)) {
    if (has_several_materials(scene)) warn_of_lost_paint(options.output.path, context);
    return;
  }
  make_sparse(made, options);
  const ScenePaint paint = paint_scene(scene, made.grid, context.job());
  for (const auto& [number, name] : paint.materials) {
    context.result()["materials"][std::to_string(number)] = name;
  }
  if (paint.too_many == 0) return;
  context.warn(
      fmt::format("{}: paint has {} materials: {} of the scene's are left out, what has "
                  "them is not painted",
                  options.output.path, kMostMaterial, paint.too_many));
}

}  // namespace

Exit convert_scene(const ConvertRequest& options, Context& context) {
  Stopwatch watch;
  const FieldConvertOptions convert = field_options(options);
  const SceneModel scene =
      load_scene(options.input, options.time, context,
                 [&](const Field& field) { return reach_of(field, options, convert); });
  check_has_end(scene, options.input);
  watch.lap("read");
  double reached = 0;
  auto [made, evaluated, within] = naming(options.input, [&] {
    reached = choose_lattice(scene.field, convert).voxel;
    check_voxel(options, reached);
    return convert_field_of(scene, options, convert, context);
  });
  warn_of_short_bands(scene, options, reached, made.dense ? reached : made.grid.lattice().voxel,
                      context);
  watch.lap("voxelize");
  paint(scene, options, made, context);
  watch.lap("paint");
  warn_of_nothing(made, "scene", context);
  save(made, options, context);
  watch.lap("write");
  describe(made, options, context);
  Json seconds = watch.seconds();
  seconds["transform"] = 0.0;
  if (evaluated) context.result()["evaluated"] = *evaluated;
  context.result()["seconds"] = seconds;
  context.print("{}read {:.3f} s, voxelize {:.3f} s, paint {:.3f} s, write {:.3f} s",
                evaluated ? fmt::format("{} points evaluated; ", *evaluated) : "",
                seconds["read"].get<double>(), seconds["voxelize"].get<double>(),
                seconds["paint"].get<double>(), seconds["write"].get<double>());
  return within ? Exit::done : Exit::missed;
}

}  // namespace sdfgrid::cli
