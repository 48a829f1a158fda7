// apps/sdfgrid/methods.h: the options that name methods for meshes and say how they work, the same
// for every subcommand that takes any of convert_methods().
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sdfgrid/grid/methods.h"
#include "sdfgrid/transform/transform.h"

namespace sdfgrid::cli {

// Registers --method, one of convert_methods() but peers; `chosen` keeps what it has if none is
// given.
CLI::Option* add_method(CLI::App& app, std::string& chosen);

// Registers --methods, a list of them, with `purpose` in its help.
CLI::Option* add_methods(CLI::App& app, std::vector<std::string>& chosen,
                         const std::string& purpose, bool peers);

// How the transforms work, whichever is chosen.
struct TransformChoice {
  std::optional<double> bucket;
  std::string mask;  // a file; empty: none

  // Reads the mask; the methods are named as on the command line, none for all. Throws Error{usage}
  // if one of them lacks its mask, or none has a use for what was given, else as
  // read_chamfer_steps() does.
  [[nodiscard]] TransformOptions options_for(const std::vector<std::string>& methods) const;
};

// Registers --bucket and --mask.
void add_transform_choice(CLI::App& app, TransformChoice& choice);

}  // namespace sdfgrid::cli
