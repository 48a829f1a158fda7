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

// Finds the conversion, prints what was tried, and fills `tolerance`, `error`, `within` and
// `trials` of the result. `methods` as in ChooseOptions.
[[nodiscard]] Choice choose_within(const TriangleSoup& soup, const ConvertOptions& convert,
                                   const std::vector<std::string>& methods,
                                   const ToleranceOptions& options, Context& context);

}  // namespace sdfgrid::cli
