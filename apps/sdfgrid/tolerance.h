// apps/sdfgrid/tolerance.h: convert --tolerance: the resolution and method found by measuring.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "command.h"
#include "sdfgrid/grid/choose.h"

namespace sdfgrid::cli {

struct ToleranceOptions {
  std::string tolerance;  // "0.01" or "0.1%"; empty: not asked for
  double budget_seconds = 0;
  double budget_megabytes = 0;
};

// Registers --tolerance, --budget-s and --budget-mb. Returns the first.
CLI::Option* add_tolerance(CLI::App& app, ToleranceOptions& options);

// The options of a search in a thing of that longest side. Throws CLI::ValidationError for a
// tolerance that is no length.
[[nodiscard]] ChooseOptions choose_options(const ToleranceOptions& options, double longest_side);

// Prints what was tried, and fills `tolerance`, `error`, `within` and `trials` of the result.
void report_choice(const Choice& choice, const ChooseOptions& options, Context& context);

}  // namespace sdfgrid::cli
