#include "scenes.h"

#include "options.h"

namespace sdfgrid::cli {

void add_scene_options(CLI::App& app, double& time) {
  app.add_option("--time", time, "time of a scene: t in its formulas")
      ->check(finite_number())
      ->capture_default_str();
}

bool names_scene(const std::string& path) { return has_extension(path, scene_extensions()); }

SceneModel load_scene(const std::string& path, double time, Context& context,
                      const ReachOf& reach_of) {
  const SceneFile file = read_scene(path);
  for (const std::string& warning : file.warnings) context.warn(warning);
  SceneModel model = build_scene(file.scene, path, time, context.job());
  if (reach_of && model.has_grids && !model.endless) {
    const SceneReach reach = naming(path, [&] { return reach_of(model.field); });
    model = build_scene(file.scene, path, time, context.job(), reach);
  }
  for (const std::string& warning : model.warnings) context.warn(warning);
  return model;
}

}  // namespace sdfgrid::cli
