// sdfgrid convert SCENE: a scene's field to a grid, its materials to paint.
#include <algorithm>
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
  const SceneModel scene = load_scene(options.input, options.time, context);
  check_has_end(scene, options.input);
  watch.lap("read");
  auto [made, evaluated, within] = naming(options.input, [&] {
    const FieldConvertOptions convert = field_options(options);
    check_voxel(options, choose_lattice(scene.field, convert).voxel);
    return convert_field_of(scene, options, convert, context);
  });
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
