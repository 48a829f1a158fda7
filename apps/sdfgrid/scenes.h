// apps/sdfgrid/scenes.h: scene files as input of subcommands.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "command.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/scene/build.h"

namespace sdfgrid::cli {

// Registers --time.
void add_scene_options(CLI::App& app, double& time);

// Whether the path ends like a scene's.
[[nodiscard]] bool names_scene(const std::string& path);

// Reads a scene and makes its field; warnings go to the context. `reach_of` says, of the scene as
// it is, how far from its surface its grids and meshes are to hold distances (build_scene()).
using ReachOf = std::function<SceneReach(const Field& field)>;
[[nodiscard]] SceneModel load_scene(const std::string& path, double time, Context& context,
                                    const ReachOf& reach_of = nullptr);

// What `work` returns; if it refuses the scene, the message names the file.
template <class Work>
auto naming(const std::string& path, const Work& work) {
  try {
    return work();
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::input) throw;
    throw Error(ErrorKind::input, path + ": " + e.what());
  }
}

}  // namespace sdfgrid::cli
